// Choosing what is shown, in all tables and charts at once; sorting; long tables in parts.

const CHOICES = DATA.choices, CARDS = matchMedia("(max-width: 1000px)"), NUMBER = /^[-+]?\d[\d,]*(\.\d+)?(e[-+]?\d+)?(?![\w.])/;
const mostRows = () => (CARDS.matches ? 10 : 25);
const chosen = CHOICES.heads.map(() => -1);
const choosers = [];

// Whether a line has all the values that are chosen; a visit has three modules, a pair two agents.
const matches = (line) => chosen.every((want, head) => want < 0 || CHOICES.lines[line][head].includes(want));

function option(words, value) {
  return html("option", { value }, words);
}

// What a cell is sorted by: a number where it begins with one, else its words; null where it says nothing.
function sortKey(row, column) {
  const words = row.cells[column].textContent.trim();
  if (words === "–" || words.startsWith("not ")) return null;
  const number = NUMBER.exec(words);
  return number ? Number(number[0].replaceAll(",", "")) : words;
}

class Table {
  constructor(table) {
    this.bodies = [...table.tBodies].map((body) => ({ body, rows: [...body.querySelectorAll("[data-line]")] }));
    this.rows = this.bodies.flatMap(({ rows }) => rows);
    this.heads = [...table.tHead.rows[0].cells];
    this.whole = false;
    this.column = -1;
    this.up = true;
    this.buttons = this.heads.map((head, i) => {
      const pressed = html("button", { type: "button", class: "sort", onclick: () => this.sort(i, this.column === i ? !this.up : true) }, breakable(head.textContent));
      head.replaceChildren(pressed);
      return pressed;
    });
    this.by = html("select", { onchange: () => this.sort(Number(this.by.value), this.up) },
      option("as declared", -1), ...this.heads.map((head, i) => option(head.textContent, i)));
    this.way = button("", () => this.sort(this.column, !this.up), { disabled: "" });
    this.told = html("span", { role: "status" });
    this.more = button("", () => { this.whole = !this.whole; this.show(); });
    this.frame = table.parentElement;
    this.table = table;
    this.frame.before(html("div", { class: "tools" }, this.told,
      html("span", { class: "sorter" }, html("label", {}, "Sort by ", this.by), this.way)));
    this.frame.after(this.more);
    new ResizeObserver(() => this.fit()).observe(this.frame);
    this.order();
  }

  sort(column, up) {
    this.column = column;
    this.up = up;
    const place = new Map(this.rows.map((row, i) => [row, i]));
    for (const { body, rows } of this.bodies) {
      const keys = new Map(column < 0 ? [] : rows.map((row) => [row, sortKey(row, column)]));
      const words = [...keys.values()].some((key) => typeof key === "string");
      const compare = (a, b) => {
        const [x, y] = [keys.get(a) ?? null, keys.get(b) ?? null];
        if (x === null || y === null) return (x === null) - (y === null) || place.get(a) - place.get(b);
        const less = words ? String(x).localeCompare(String(y), "en", { numeric: true }) : x - y;
        return (up ? less : -less) || place.get(a) - place.get(b);
      };
      body.append(...[...rows].sort(compare));
    }
    this.order();
    this.show();
  }

  // Tell by what the rows are sorted.
  order() {
    this.heads.forEach((head, i) => {
      if (i === this.column) head.setAttribute("aria-sort", this.up ? "ascending" : "descending");
      else head.removeAttribute("aria-sort");
    });
    this.by.value = this.column;
    this.way.disabled = this.column < 0;
    this.way.textContent = this.up ? "Ascending" : "Descending";
  }

  // A table too wide for the page is moved sideways, with keys, too; its heads stay in sight only where it fits.
  fit() {
    const fits = this.table.offsetWidth <= this.frame.clientWidth + 1;
    this.frame.classList.toggle("fits", fits);
    if (fits) this.frame.removeAttribute("tabindex");
    else this.frame.tabIndex = 0;
  }

  show() {
    const most = mostRows();
    let count = 0;
    for (const { body } of this.bodies) {
      let any = false;
      for (const row of body.querySelectorAll("[data-line]")) {
        row.hidden = !matches(Number(row.dataset.line));
        if (row.hidden) continue;
        count += 1;
        row.classList.toggle("beyond", !this.whole && count > most);
        any ||= !row.classList.contains("beyond");
      }
      body.hidden = ![...body.querySelectorAll("[data-line]")].some((row) => !row.hidden);
      body.classList.toggle("beyond", !any);
    }
    const all = this.rows.length;
    const cut = !this.whole && count > most;
    this.told.textContent = `${cut ? `${most} of ` : ""}${count} ${count === 1 ? "line" : "lines"}${count < all ? `, chosen of ${all}` : ""}`;
    this.more.hidden = count <= most;
    this.more.textContent = this.whole ? `Show ${most} lines` : `Show all ${count} lines`;
  }
}

function chooserBar(place) {
  const used = CHOICES.heads.map((_, head) => CHOICES.values[head].length > 1);
  const told = html("span", { class: "state" });
  const selects = CHOICES.heads.map((head, i) => html("select", { onchange: (event) => { chosen[i] = Number(event.target.value); apply(); } },
    option("all", -1), ...CHOICES.values[i].map(option)));
  const reset = button("Reset", () => { chosen.fill(-1); selects.forEach((each) => { each.value = -1; }); apply(); });
  const apply = () => {
    const words = CHOICES.heads.map((head, i) => (chosen[i] < 0 ? null : `${head} ${CHOICES.values[i][chosen[i]]}`)).filter(Boolean);
    told.textContent = words.length ? words.join(", ") : "everything";
    reset.disabled = !words.length;
    choosers.forEach((each) => each.show());
  };
  const details = html("details", {}, html("summary", {}, "Shown: ", told),
    html("div", { class: "fields" }, ...selects.map((each, i) => (used[i] ? html("label", {}, html("span", {}, CHOICES.heads[i]), each) : null)), reset));
  details.open = matchMedia("(min-width: 761px)").matches;
  if (!used.some(Boolean)) return apply();
  place.append(details);
  place.classList.add("choose");
  place.setAttribute("role", "search");
  place.setAttribute("aria-label", "Choose what tables and curves show");
  new ResizeObserver(() => document.documentElement.style.setProperty("--bar", `${place.offsetHeight}px`)).observe(place);
  apply();
}

CARDS.addEventListener("change", () => choosers.forEach((each) => each.show()));
document.querySelectorAll("table.numbers").forEach((table) => choosers.push(new Table(table)));
