// A chart of learning curves: bands, lines, a reading at the pointer or the arrow keys, names that switch curves.

const COLOURS = 8, MOST_TOLD = 10, MARGIN = { left: 40, right: 12, top: 10, bottom: 36 };
const short = (value) =>
  value >= 1e6 ? `${+(value / 1e6).toFixed(2)}M` : value >= 1e4 ? `${+(value / 1e3).toFixed(1)}k` : value.toLocaleString("en");

function ticks(low, high, wanted) {
  const rough = (high - low) / wanted, power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 5, 10].find((factor) => factor * power >= rough);
  const found = [];
  for (let n = Math.ceil(low / step - 1e-9); n * step <= high + step * 1e-9; n++) found.push(+(n * step).toPrecision(12));
  return found;
}

class Chart {
  constructor(figure, data, number) {
    this.data = data;
    this.on = data.curves.map(() => true);
    this.end = Math.max(...data.curves.map((curve) => curve.end));
    this.at = null;
    this.hues = data.curves.map(({ hue }) => `colour-${hue % COLOURS}${hue >= COLOURS ? " dashed" : ""}`);
    this.plot = html("div", {
      class: "plot", tabindex: 0, role: "group",
      "aria-label": `${data.title}: ${data.y} over ${data.x}; arrow keys read the curves`,
      onpointermove: (event) => this.point(event), onpointerdown: (event) => this.point(event),
      onpointerleave: () => this.read(null), onblur: () => this.read(null), onkeydown: (event) => this.key(event),
    });
    this.tip = html("div", { class: "tip", hidden: "" });
    this.said = html("p", { class: "unseen", "aria-live": "polite" });
    this.names = data.curves.map((curve, i) =>
      html("button", { type: "button", class: `name ${this.hues[i]}`, "aria-pressed": "true", onclick: (event) => this.toggle(i, event) },
        svg("svg", { width: 18, height: 8, "aria-hidden": "true" }, svg("line", { x1: 1, x2: 17, y1: 4, y2: 4, class: "curve" })),
        breakable(curve.name)));
    this.all = button("All", () => this.show(this.on.map(() => true)), { hidden: "" });
    const seeds = [...new Set(data.curves.map((curve) => curve.n))].join(", ");
    figure.append(
      html("figcaption", { id: `chart-${number}` }, html("h3", {}, breakable(data.title)), html("small", {}, `${data.y}, n = ${seeds}, a point is ${data.batch === "1" ? "a trial" : `${data.batch} trials`}`)),
      html("div", { class: "names", role: "group", "aria-label": `Curves of ${data.title}` }, ...this.names, this.all),
      this.plot, this.said);
    this.draw();
    new ResizeObserver(() => requestAnimationFrame(() => { if (this.plot.clientWidth !== this.width) this.draw(); })).observe(figure);
  }

  // From where to where y goes: all curves, their bands where these are drawn, zero and the exact values.
  measure(banded) {
    const { curves, optimum, random } = this.data;
    const values = curves.flatMap(({ mean, half }) => (banded && half ? mean.flatMap((at, k) => [at - half[k], at + half[k]]) : mean));
    const all = [...values, ...[optimum, random].filter((value) => value !== null), 0];
    this.low = all.reduce((a, b) => Math.min(a, b));
    this.high = all.reduce((a, b) => Math.max(a, b)) * (optimum === null ? 1.04 : 1.1) || 1;
  }

  x(value) { return MARGIN.left + (value / this.end) * (this.width - MARGIN.left - MARGIN.right); }
  y(value) {
    return this.height - MARGIN.bottom - ((value - this.low) / (this.high - this.low)) * (this.height - MARGIN.top - MARGIN.bottom);
  }
  place(curve, i) { return ((i + 0.5) / curve.mean.length) * curve.end; }

  draw() {
    this.width = this.plot.clientWidth;
    this.height = Math.round(Math.min(300, Math.max(220, this.width * 0.55)));
    const right = this.width - MARGIN.right, bottom = this.height - MARGIN.bottom;
    const banded = this.on.filter(Boolean).length <= COLOURS;
    this.measure(banded);
    this.cursor = svg("g", { class: "cursor" });
    this.picture = svg("svg", { viewBox: `0 0 ${this.width} ${this.height}`, width: this.width, height: this.height, "aria-hidden": "true" },
      ...ticks(this.low, this.high, 5).flatMap((value) => [
        svg("line", { class: "grid", x1: MARGIN.left, x2: right, y1: this.y(value), y2: this.y(value) }),
        svg("text", { x: MARGIN.left - 7, y: this.y(value) + 4, "text-anchor": "end" }, String(value)),
      ]),
      ...ticks(0, this.end, this.width / 90).map((value) =>
        svg("text", { x: this.x(value), y: bottom + 16, "text-anchor": value === 0 ? "start" : value > this.end * 0.95 ? "end" : "middle" }, short(value))),
      svg("text", { class: "unit", x: right, y: bottom + 31, "text-anchor": "end" }, this.data.x),
      ...this.bound(this.data.optimum, "best possible"), ...this.bound(this.data.random, "random"),
      ...this.data.curves.map((curve, i) => (this.on[i] && banded && curve.half ? this.band(curve, i) : null)).filter(Boolean),
      ...this.data.curves.map((curve, i) => (this.on[i] ? this.line(curve, i) : null)).filter(Boolean),
      this.cursor);
    this.plot.replaceChildren(this.picture, this.tip);
    this.read(this.at);
  }

  bound(value, words) {
    if (value === null) return [];
    const y = this.y(value), right = this.width - MARGIN.right;
    return [svg("line", { class: "bound", x1: MARGIN.left, x2: right, y1: y, y2: y }),
      svg("text", { class: "unit", x: right, y: y - 5, "text-anchor": "end" }, `${words} ${value.toFixed(2)}`)];
  }

  line(curve, i) {
    const points = curve.mean.map((mean, k) => `${this.x(this.place(curve, k)).toFixed(1)},${this.y(mean).toFixed(1)}`);
    return points.length > 1 ? svg("polyline", { class: `curve ${this.hues[i]}`, points: points.join(" ") })
      : svg("circle", { class: `spot ${this.hues[i]}`, cx: points[0].split(",")[0], cy: points[0].split(",")[1], r: 3 });
  }

  band(curve, i) {
    const edge = (sign) => curve.mean.map((mean, k) =>
      `${this.x(this.place(curve, k)).toFixed(1)},${this.y(mean + sign * curve.half[k]).toFixed(1)}`);
    return svg("polygon", { class: `band ${this.hues[i]}`, points: [...edge(1), ...edge(-1).reverse()].join(" ") });
  }

  point(event) {
    const left = this.picture.getBoundingClientRect().left;
    const share = (event.clientX - left - MARGIN.left) / (this.width - MARGIN.left - MARGIN.right);
    this.read(Math.min(1, Math.max(0, share)) * this.end);
  }

  key(event) {
    const batch = this.end / Math.max(...this.data.curves.map((curve) => curve.mean.length));
    const at = this.at ?? this.end / 2;
    const to = { ArrowLeft: at - batch, ArrowRight: at + batch, PageDown: at - 10 * batch, PageUp: at + 10 * batch,
      Home: 0, End: this.end, Escape: null }[event.key];
    if (to === undefined) return;
    event.preventDefault();
    this.read(to === null ? null : Math.min(this.end, Math.max(0, to)));
    this.said.textContent = this.tip.hidden ? "" : [...this.tip.children].map((line) => line.textContent).join("; ");
  }

  // Show what the visible curves are at x.
  read(at) {
    this.at = at;
    this.tip.hidden = at === null;
    this.cursor.replaceChildren();
    if (at === null) return;
    const found = this.data.curves.map((curve, i) => {
      const k = Math.min(curve.mean.length - 1, Math.floor((at / curve.end) * curve.mean.length));
      return { curve, i, k, mean: curve.mean[k] };
    }).filter(({ curve, i }) => this.on[i] && at <= curve.end).sort((a, b) => b.mean - a.mean);
    const x = this.x(found.length ? this.place(found[0].curve, found[0].k) : at);
    this.cursor.append(svg("line", { x1: x, x2: x, y1: MARGIN.top, y2: this.height - MARGIN.bottom }),
      ...found.map(({ i, mean }) => svg("circle", { class: `spot ${this.hues[i]}`, cx: x, cy: this.y(mean), r: 4 })));
    this.tip.replaceChildren(html("b", {}, `${short(Math.round(found.length ? this.place(found[0].curve, found[0].k) : at))} ${this.data.x}`),
      ...found.slice(0, MOST_TOLD).map(({ curve, i, k, mean }) => html("span", { class: this.hues[i] }, html("i"), breakable(`${curve.name} `),
        html("b", {}, mean.toFixed(2) + (curve.half ? ` ± ${curve.half[k].toFixed(2)}` : "")))),
      found.length > MOST_TOLD ? html("b", {}, `and ${found.length - MOST_TOLD} lower`) : "");
    const wide = this.tip.offsetWidth;
    this.tip.style.left = `${Math.max(0, x + wide + 14 < this.width ? x + 12 : x - wide - 12)}px`;
  }

  toggle(i, event) {
    const alone = this.on.every((on, k) => on === (k === i));
    this.show(event.shiftKey ? this.on.map((_, k) => alone || k === i) : this.on.map((on, k) => (k === i ? !on : on)));
  }

  show(on) {
    this.on = on;
    this.names.forEach((name, i) => name.setAttribute("aria-pressed", String(on[i])));
    this.all.hidden = on.every(Boolean);
    this.draw();
  }
}

document.querySelectorAll("[data-chart]").forEach((figure, i) => new Chart(figure, DATA.charts[i], i));
