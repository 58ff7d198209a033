// The lab from above, drawn for any moment between two steps of a trial; x eastwards, y southwards, in cells.

const TRAIL = 14, TURN = -45, SIGHT_SHOWN = 5;
const between = (from, to, share) => from + (to - from) * share;
const place = (value) => value + 0.5;

// A sector of a circle around 0,0 that looks east.
function sector(radius, degrees) {
  const angle = (degrees * Math.PI) / 180, x = radius * Math.cos(angle), y = radius * Math.sin(angle);
  return `M0,0 L${x.toFixed(3)},${(-y).toFixed(3)} A${radius},${radius} 0 0 1 ${x.toFixed(3)},${y.toFixed(3)} Z`;
}

class Lab {
  constructor() {
    const { size, room } = STORY, lines = [];
    for (let at = 0; at <= size; at++) {
      const kind = at % room ? "tile" : "wall";
      lines.push(svg("line", { class: kind, x1: at, x2: at, y1: 0, y2: size }), svg("line", { class: kind, x1: 0, x2: size, y1: at, y2: at }));
    }
    lines.sort((a, b) => a.getAttribute("class").localeCompare(b.getAttribute("class")));
    this.goal = svg("rect", { class: "goal", width: room, height: room });
    this.reached = svg("rect", { class: "reached", width: room, height: room });
    this.flag = svg("g", { class: "flag" }, svg("path", { class: "cloth", d: "M0,-1.9 L1.5,-1.4 L0,-0.9 Z" }), svg("path", { class: "pole", d: "M0,-1.95 V0 M-0.35,0 H0.35" }));
    this.names = STORY.rooms.map((name, i) =>
      svg("text", { class: "room", x: (i % (size / room)) * room + 0.45, y: Math.floor(i / (size / room)) * room + 1.05 }, name));
    this.trails = { robot: svg("polyline", { class: "trail robot" }), human: svg("polyline", { class: "trail human" }) };
    this.desired = svg("path", { class: "desired", d: "M1.1,0 H2.5 M2.05,-0.4 L2.6,0 L2.05,0.4" });
    this.sight = svg("g", {}, svg("path", { class: "sees", d: sector(SIGHT_SHOWN, 90) }), svg("path", { class: "faces", d: sector(SIGHT_SHOWN, 45) }));
    const nose = () => svg("path", { class: "nose", d: "M0.3,-0.45 L0.98,0 L0.3,0.45 Z" });
    this.human = svg("g", { class: "human" }, nose(), svg("circle", { r: 0.62 }));
    this.robot = svg("g", { class: "robot" }, nose(), svg("rect", { x: -0.58, y: -0.58, width: 1.16, height: 1.16, rx: 0.25 }));
    this.words = svg("text", { "text-anchor": "middle", x: 0, y: -1.42 });
    this.bubble = svg("g", { class: "bubble" }, svg("path", { d: "M-2,-2.5 H2 Q2.3,-2.5 2.3,-2.2 V-1.4 Q2.3,-1.1 2,-1.1 H0.4 L0,-0.65 L-0.1,-1.1 H-2 Q-2.3,-1.1 -2.3,-1.4 V-2.2 Q-2.3,-2.5 -2,-2.5 Z" }), this.words);
    this.node = svg("svg", { class: "lab", viewBox: `-0.3 -0.3 ${size + 0.6} ${size + 0.6}`, role: "img", "aria-label": "The lab from above" },
      svg("rect", { class: "floor", width: size, height: size }), this.goal, this.reached, ...lines, ...this.names,
      this.flag, svg("svg", { class: "within", width: size, height: size }, this.sight), this.trails.human, this.trails.robot, this.desired, this.human, this.robot, this.bubble);
  }

  // Draw the trial at `time`: step floor(time), on its way to the next.
  draw(trial, time) {
    const c = trial.columns, step = Math.floor(time), next = Math.min(step + 1, c.reward.length - 1), share = time - step;
    const { size, room } = STORY;
    const corner = (goal) => [(goal % (size / room)) * room, Math.floor(goal / (size / room)) * room];
    const put = (node, x, y, turned = 0) => node.setAttribute("transform", `translate(${x.toFixed(3)},${y.toFixed(3)}) rotate(${turned.toFixed(1)})`);
    const at = (who) => [between(place(c[`${who}_col`][step]), place(c[`${who}_col`][next]), share),
      between(place(c[`${who}_row`][step]), place(c[`${who}_row`][next]), share)];
    const heading = (who) => {
      const from = c[`${who}_heading`][step], turn = ((c[`${who}_heading`][next] - from + 12) % 8) - 4;
      return (from + turn * share) * TURN;
    };
    const [robot, human] = [at("robot"), at("human")];
    put(this.robot, ...robot, heading("robot"));
    put(this.human, ...human, heading("human"));
    put(this.sight, ...human, heading("human"));
    put(this.desired, ...human, c.desired_direction[step] * TURN);
    const goal = corner(c.goal_room[step]);
    put(this.goal, ...goal);
    put(this.flag, goal[0] + room - 2.2, goal[1] + 2.6);
    this.names.forEach((name, i) => name.classList.toggle("is-goal", i === c.goal_room[step]));
    const rewarded = step > 0 && c.reward[step] > 0;
    this.reached.classList.toggle("shown", rewarded);
    if (rewarded) put(this.reached, ...corner(c.goal_room[step - 1]));
    for (const [who, now] of [["robot", robot], ["human", human]]) {
      const points = [];
      for (let k = Math.max(0, step - TRAIL); k <= step; k++) points.push(`${place(c[`${who}_col`][k])},${place(c[`${who}_row`][k])}`);
      this.trails[who].setAttribute("points", [...points, now.join(",")].join(" "));
    }
    const said = trial.said[step] ?? "";
    this.bubble.classList.toggle("shown", said !== "");
    this.words.textContent = said;
    put(this.bubble, Math.min(size - 2.4, Math.max(2.4, robot[0])), Math.max(2.6, robot[1]));
  }
}
