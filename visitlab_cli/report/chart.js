// A chart of learning curves: bands, lines, a reading at the pointer or the arrow keys, names that switch curves.

const MOST_DRAWN = 8, MOST_BANDS = 4, MOST_TOLD = 10, DASHES = 4, SHADES = 3, MARKERS_A_CURVE = 7, MARGIN = { left: 40, right: 12, top: 10, bottom: 36 };
const short = (value) =>
  value >= 1e6 ? `${+(value / 1e6).toFixed(2)}M` : value >= 1e4 ? `${+(value / 1e3).toFixed(1)}k` : value.toLocaleString("en");

// The markers of colours.py, each about 9 across.
const PLUS = "M-1.6,-4.5h3.2v2.9h2.9v3.2h-2.9v2.9h-3.2v-2.9h-2.9v-3.2h2.9z";
const MARKERS = { o: "M-4,0a4,4 0 1,0 8,0a4,4 0 1,0 -8,0", s: "M-3.6,-3.6h7.2v7.2h-7.2z", "^": "M0,-4.6L4.4,3.6H-4.4z", D: "M0,-4.9L4.9,0L0,4.9L-4.9,0z",
  v: "M0,4.6L4.4,-3.6H-4.4z", P: PLUS, X: PLUS, h: "M0,-4.6L4,-2.3V2.3L0,4.6L-4,2.3V-2.3z" };

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
    this.figure = figure;
    this.of = data.curves.map(() => true);
    this.on = this.first();
    this.end = Math.max(...data.curves.map((curve) => curve.end));
    this.at = null;
    this.plot = html("div", {
      class: "plot", tabindex: 0, role: "group",
      "aria-label": `${data.title}: ${data.y} over ${data.x}; arrow keys read the curves`,
      onpointermove: (event) => this.point(event), onpointerdown: (event) => this.point(event),
      onpointerleave: () => this.read(null), onblur: () => this.read(null), onkeydown: (event) => this.key(event),
    });
    this.tip = html("div", { class: "tip", hidden: "" });
    this.said = html("p", { class: "unseen", "aria-live": "polite" });
    this.names = data.curves.map((curve, i) =>
      html("button", { type: "button", class: "name", "aria-pressed": "true", onclick: (event) => this.toggle(i, event) }, breakable(curve.name)));
    this.all = button("All", () => this.turn([...this.of]), { hidden: "" });
    this.few = html("small", {});
    const seeds = [...new Set(data.curves.map((curve) => curve.n))].join(", ");
    figure.append(
      html("figcaption", { id: `chart-${number}` }, html("h3", {}, breakable(data.title)), html("small", {}, `${data.y}, n = ${seeds}, a point is ${data.batch === "1" ? "a trial" : `${data.batch} trials`}`), this.few),
      html("div", { class: "names", role: "group", "aria-label": `Curves of ${data.title}` }, ...this.names, this.all),
      this.plot, this.said);
    new ResizeObserver(() => requestAnimationFrame(() => { if (this.plot.clientWidth !== this.width) this.draw(); })).observe(figure);
  }

  // The first of those curves that are chosen.
  first() {
    let left = MOST_DRAWN;
    return this.of.map((of) => of && left-- > 0);
  }

  // Show the curves of the lines that are chosen on the page.
  show() {
    this.of = this.data.curves.map((curve) => matches(curve.line));
    this.figure.hidden = !this.of.some(Boolean);
    this.names.forEach((name, i) => { name.hidden = !this.of[i]; });
    if (!this.figure.hidden) this.turn(this.first());
  }

  // An agent's colour, and a dash and shade that none of its other curves has that are drawn.
  style() {
    const before = {};
    this.looks = this.data.curves.map(({ hue, marker }, i) => {
      const which = `${hue} ${marker}`;
      const place = before[which] ?? 0;
      before[which] = place + (this.on[i] ? 1 : 0);
      return `colour-${hue} shade-${place % SHADES} dash-${place % DASHES}`;
    });
  }

  marker(i, x, y) {
    const { marker } = this.data.curves[i];
    return svg("path", { class: `spot ${this.looks[i].replace(/ dash-\d/, "")}`, d: MARKERS[marker], transform: `translate(${x.toFixed(1)},${y.toFixed(1)})${marker === "X" ? " rotate(45)" : ""}` });
  }

  sample(i) {
    return svg("svg", { width: 26, height: 12, "aria-hidden": "true" },
      svg("line", { x1: 0, x2: 26, y1: 6, y2: 6, class: `curve ${this.looks[i]}` }), this.marker(i, 13, 6));
  }

  // From where to where y goes: all curves, their bands where these are drawn, zero and the exact values.
  measure(banded) {
    const { curves, optimum, random } = this.data;
    const values = curves.filter((_, i) => this.of[i]).flatMap(({ mean, half }) => (banded && half ? mean.flatMap((at, k) => [at - half[k], at + half[k]]) : mean));
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
    const banded = this.on.filter(Boolean).length <= MOST_BANDS;
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
      ...this.phases(),
      ...this.bound(this.data.optimum, "best possible"), ...this.bound(this.data.random, "random"),
      ...this.data.curves.map((curve, i) => (this.on[i] && banded && curve.half ? this.band(curve, i) : null)).filter(Boolean),
      ...this.data.curves.map((curve, i) => (this.on[i] ? this.line(curve, i) : null)).filter(Boolean),
      this.cursor);
    this.plot.replaceChildren(this.picture, this.tip);
    this.read(this.at);
  }

  // A band for each phase, every second one shaded, with its name where there is room.
  phases() {
    const top = MARGIN.top, bottom = this.height - MARGIN.bottom;
    return this.data.phases.flatMap(([end, name], i) => {
      const from = this.x(i ? this.data.phases[i - 1][0] : 0), to = this.x(end);
      return [i % 2 ? svg("rect", { class: "phase", x: from, width: to - from, y: top, height: bottom - top }) : null,
        i ? svg("line", { class: "bound", x1: from, x2: from, y1: top, y2: bottom }) : null,
        to - from > 7 * name.length ? svg("text", { class: "unit", x: (from + to) / 2, y: top + 10, "text-anchor": "middle" }, name) : null,
      ].filter(Boolean);
    });
  }

  bound(value, words) {
    if (value === null) return [];
    const y = this.y(value), right = this.width - MARGIN.right;
    return [svg("line", { class: "bound", x1: MARGIN.left, x2: right, y1: y, y2: y }),
      svg("text", { class: "unit", x: right, y: y - 5, "text-anchor": "end" }, `${words} ${value.toFixed(2)}`)];
  }

  line(curve, i) {
    const points = curve.mean.map((mean, k) => [this.x(this.place(curve, k)), this.y(mean)]);
    const every = Math.max(1, Math.ceil(points.length / MARKERS_A_CURVE));
    const marked = points.filter((_, k) => k % every === Math.min(i % every, points.length - 1));
    return svg("g", {}, svg("polyline", { class: `curve ${this.looks[i]}`, points: points.map((at) => at.map((part) => part.toFixed(1)).join()).join(" ") }),
      ...marked.map(([x, y]) => this.marker(i, x, y)));
  }

  band(curve, i) {
    const edge = (sign) => curve.mean.map((mean, k) =>
      `${this.x(this.place(curve, k)).toFixed(1)},${this.y(mean + sign * curve.half[k]).toFixed(1)}`);
    return svg("polygon", { class: `band ${this.looks[i]}`, points: [...edge(1), ...edge(-1).reverse()].join(" ") });
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
      ...found.map(({ i, mean }) => this.marker(i, x, this.y(mean))));
    this.tip.replaceChildren(html("b", {}, `${short(Math.round(found.length ? this.place(found[0].curve, found[0].k) : at))} ${this.data.x}`),
      ...found.slice(0, MOST_TOLD).map(({ curve, i, k, mean }) => html("span", {}, this.sample(i), breakable(`${curve.name} `),
        html("b", {}, mean.toFixed(2) + (curve.half ? ` ± ${curve.half[k].toFixed(2)}` : "")))),
      found.length > MOST_TOLD ? html("b", {}, `and ${found.length - MOST_TOLD} lower`) : "");
    const wide = this.tip.offsetWidth;
    this.tip.style.left = `${Math.max(0, x + wide + 14 < this.width ? x + 12 : x - wide - 12)}px`;
  }

  toggle(i, event) {
    const alone = this.on.every((on, k) => on === (k === i));
    this.turn(event.shiftKey ? this.of.map((of, k) => of && (alone || k === i)) : this.on.map((on, k) => (k === i ? !on : on)));
  }

  turn(on) {
    this.on = on;
    this.style();
    const chosen = this.of.filter(Boolean).length, drawn = on.filter(Boolean).length;
    this.names.forEach((name, i) => {
      name.setAttribute("aria-pressed", String(on[i]));
      name.querySelector("svg")?.remove();
      if (on[i]) name.prepend(this.sample(i));
    });
    this.few.textContent = drawn < chosen ? `${drawn} of ${chosen} curves drawn` : "";
    this.all.hidden = drawn === chosen;
    this.draw();
  }
}

document.querySelectorAll("[data-chart]").forEach((figure, i) => choosers.push(new Chart(figure, DATA.charts[i], i)));
chooserBar(document.getElementById("choose"));
