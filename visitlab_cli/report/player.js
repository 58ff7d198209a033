// The player of the best trial: controls, a timeline of interaction levels and goals, the facts and words of a step.

const SPEEDS = { "slow": 1.5, "normal": 3, "fast": 8 };

class Player {
  constructor(root, trials) {
    this.trials = trials;
    this.time = 0;
    this.speed = SPEEDS.normal;
    this.lab = new Lab(trials[0].place);
    this.play = button("Play", () => this.run(!this.running), { class: "main", "aria-keyshortcuts": "Space" });
    this.slider = html("input", { type: "range", min: 0, step: 1, "aria-label": "Step", oninput: () => { this.run(false); this.go(+this.slider.value); } });
    this.line = svg("svg", { class: "timeline", preserveAspectRatio: "none", "aria-hidden": "true", onpointerdown: (event) => this.seek(event) });
    this.caption = html("p", { class: "caption", "aria-live": "polite" });
    this.facts = html("dl", { class: "step-facts" });
    this.moments = html("ol", { class: "moments", "aria-label": "Moments of this trial" });
    this.about = html("p", { class: "about" });
    const speed = html("select", { "aria-label": "Speed", onchange: () => { this.speed = SPEEDS[speed.value]; } },
      ...Object.keys(SPEEDS).map((name) => html("option", { value: name }, name)));
    speed.value = "normal";
    const choice = html("select", { id: "visit", onchange: () => this.choose(+choice.value) },
      ...trials.map((trial, i) => html("option", { value: i }, `${trial.group} (${trial.goals} goals)`)));
    const step = (by, words, sign) => button(sign, () => { this.run(false); this.go(this.step + by); }, { "aria-label": words, title: words });
    const stage = html("div", { class: "stage", tabindex: 0, role: "group", "aria-label": "The trial; space plays, arrow keys step", onkeydown: (event) => this.key(event) },
      this.lab.node, html("div", { class: "rail" }, this.line, this.slider),
      html("div", { class: "controls" }, step(-1, "Step back", "‹"), this.play, step(1, "Step on", "›"), speed));
    root.append(
      trials.length > 1 ? html("label", { class: "choice", for: "visit" }, "Visit ", choice) : html("span"),
      html("div", { class: "watch" }, stage, html("div", { class: "telling" }, this.about, this.caption, this.facts, html("h3", {}, "Moments"), this.moments)),
      this.legend());
    this.choose(0);
  }

  legend() {
    const seen = (words, kind, colour) => {
      const mark = html("i", { class: kind });
      if (colour) mark.style.background = colour;
      return html("li", {}, mark, words);
    };
    return html("ul", { class: "legend", "aria-label": "Colours" },
      seen("robot", "square", STORY.colours.robot), seen("human", "round", STORY.colours.human),
      seen(`what it sees and, greener, faces (drawn up to ${this.trials[0].scene.sight[0][3]} cells; sight goes on, but never through a wall)`, "sight"),
      seen("goal room", "square", STORY.colours.goal), seen("where the human should go", "square", STORY.colours.desired),
      ...(this.trials.some((trial) => trial.place.closed.length) ? [seen("shut door", "square", STORY.colours.shut)] : []),
      ...STORY.levels.map(([name, colour]) => seen(name, "level", colour)));
  }

  choose(number) {
    this.run(false);
    this.trial = this.trials[number];
    const lab = new Lab(this.trial.place);
    this.lab.node.replaceWith(lab.node);
    this.lab = lab;
    const { columns, steps, moments } = this.trial, shown = columns.reward.length - 1;
    this.last = shown;
    this.slider.max = shown;
    const cut = shown < steps ? `; its first ${shown.toLocaleString("en")} of ${steps.toLocaleString("en")} steps` : "";
    const { closed } = this.trial.place, doors = closed.length ? `; doors shut: ${closed.join(", ")}` : "";
    this.about.replaceChildren(
      breakable(`${this.trial.cell}, trial ${this.trial.trial}: ${this.trial.goals} goals in ${steps.toLocaleString("en")} steps${cut}${doors}.`));
    this.line.setAttribute("viewBox", `0 0 ${shown + 1} 10`);
    this.line.replaceChildren(
      ...columns.interaction_level.map((level, i) => svg("rect", { x: i, y: 0, width: 1.05, height: 7, fill: STORY.levels[level][1] })),
      ...columns.reward.flatMap((reward, i) => (i && reward > 0 ? [svg("rect", { class: "mark", x: i, y: 7.5, width: 1, height: 2.5 })] : [])));
    this.jumps = moments.map(([at, kind]) => button(`${at} ${kind}`, () => { this.run(false); this.go(at); }, { class: "moment" }));
    this.moments.replaceChildren(...this.jumps.map((jump) => html("li", {}, jump)));
    this.go(0);
  }

  go(time) {
    this.time = Math.min(this.last, Math.max(0, time));
    this.lab.draw(this.trial, CALM.matches ? Math.floor(this.time) : this.time);
    const step = Math.floor(this.time);
    if (step === this.step && this.told === this.trial) return;
    [this.step, this.told] = [step, this.trial];
    const c = this.trial.columns, level = STORY.levels[c.interaction_level[step]];
    this.slider.value = step;
    this.slider.setAttribute("aria-valuetext", `step ${step}: ${this.trial.captions[step]}`);
    this.caption.textContent = `${this.trial.captions[step]}.`;
    const goals = c.reward.slice(1, step + 1).reduce((sum, reward) => sum + reward, 0);
    const mark = html("i", { class: "level" });
    mark.style.background = level[1];
    const fact = (name, ...value) => html("div", {}, html("dt", {}, name), html("dd", {}, ...value));
    this.facts.replaceChildren(fact("Step", `${step} of ${this.last}`), fact("Goals", String(goals)),
      fact("Goal room", this.trial.place.rooms[c.goal_room[step]][4]), fact("Level", mark, level[0]), fact("Distance", STORY.distances[c.distance[step]]));
    let current = -1;
    this.trial.moments.forEach(([at], i) => { if (at <= step) current = i; });
    this.jumps.forEach((jump, i) => {
      if (i === current) jump.setAttribute("aria-current", "step");
      else jump.removeAttribute("aria-current");
    });
    const jump = this.jumps[current];
    if (jump) this.moments.scrollTop = jump.offsetTop - this.moments.offsetTop - 40;
  }

  run(on) {
    this.running = on;
    this.play.textContent = on ? "Pause" : "Play";
    this.caption.setAttribute("aria-live", on ? "off" : "polite");
    if (!on) return;
    if (this.time >= this.last) this.go(0);
    let before = performance.now();
    const mine = (this.turn = {});
    const frame = (now) => {
      if (!this.running || this.turn !== mine) return;
      this.go(this.time + ((now - before) / 1000) * this.speed);
      before = now;
      if (this.time >= this.last) this.run(false);
      else requestAnimationFrame(frame);
    };
    requestAnimationFrame(frame);
  }

  key(event) {
    if (event.target !== event.currentTarget) return;
    const to = { ArrowLeft: this.step - 1, ArrowRight: this.step + 1, PageUp: this.step - 10, PageDown: this.step + 10, Home: 0, End: this.last }[event.key];
    if (event.key === " ") this.run(!this.running);
    else if (to === undefined) return;
    else { this.run(false); this.go(to); }
    event.preventDefault();
  }

  seek(event) {
    const box = this.line.getBoundingClientRect();
    this.run(false);
    this.go(Math.floor(((event.clientX - box.left) / box.width) * (this.last + 1)));
  }
}

if (DATA.trials.length) {
  for (const [name, colour] of Object.entries(STORY.colours)) document.documentElement.style.setProperty(`--${name}`, colour);
  new Player(document.getElementById("player"), DATA.trials);
}
