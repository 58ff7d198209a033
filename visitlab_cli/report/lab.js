// The scene of a trial from above, drawn for any moment between two steps; x eastwards, y southwards, in cells.

const TURN = -45;
const between = (from, to, share) => from + (to - from) * share;
const points = (pairs) => pairs.map((pair) => pair.join(",")).join(" ");

// A sector of a circle around 0,0 that looks east.
function sector(radius, degrees) {
  const angle = (degrees * Math.PI) / 180, x = radius * Math.cos(angle), y = radius * Math.sin(angle);
  return `M0,0 L${x.toFixed(3)},${(-y).toFixed(3)} A${radius},${radius} 0 0 1 ${x.toFixed(3)},${y.toFixed(3)} Z`;
}

const rowsOfCells = (rows) => rows.map(([x, y, cells]) => `M${x},${y}h${cells}v1h${-cells}z`).join("");

class Lab {
  constructor(place) {
    const { size: [width, height], tiles, rooms, solid, open, walls, shut } = place, { flag } = STORY;
    this.place = place;
    const area = (kind) => svg("rect", { class: kind });
    [this.goal, this.reached] = [area("goal"), area("reached")];
    this.flag = svg("g", { class: "flag" }, svg("polygon", { class: "cloth", points: points(flag.cloth) }), svg("polyline", { class: "pole", points: points(flag.pole) }));
    this.names = rooms.map(([x, y, , , , , name]) => svg("text", { class: "room", x: x + 0.45, y: y + 1.05 }, name));
    this.trails = { robot: svg("polyline", { class: "trail robot" }), human: svg("polyline", { class: "trail human" }) };
    this.desired = svg("path", { class: "desired" });
    this.sight = svg("g", {}, svg("path", { class: "sees" }), svg("path", { class: "faces" }));
    const nose = () => svg("path", { class: "nose", d: "M0.3,-0.45 L0.98,0 L0.3,0.45 Z" });
    this.human = svg("g", { class: "human" }, nose(), svg("circle", { r: 0.62 }));
    this.robot = svg("g", { class: "robot" }, nose(), svg("rect", { x: -0.58, y: -0.58, width: 1.16, height: 1.16, rx: 0.25 }));
    const bubble = () => svg("g", { class: "bubble" }, svg("path", { d: "M-2,-2.5 H2 Q2.3,-2.5 2.3,-2.2 V-1.4 Q2.3,-1.1 2,-1.1 H0.4 L0,-0.65 L-0.1,-1.1 H-2 Q-2.3,-1.1 -2.3,-1.4 V-2.2 Q-2.3,-2.5 -2,-2.5 Z" }),
      svg("text", { "text-anchor": "middle", x: 0, y: -1.42 }));
    this.bubbles = { human: bubble(), robot: bubble() };
    this.node = svg("svg", { class: "lab", viewBox: `-0.3 -0.3 ${width + 0.6} ${height + 0.6}`, role: "img", "aria-label": "The lab from above" },
      svg("rect", { class: "floor", width, height }), this.goal, this.reached,
      ...tiles.map((ends) => svg("polyline", { class: "tile", points: points(ends) })),
      ...(rooms.some((room) => room[5]) ? [] : [svg("rect", { class: "wall", width, height })]),
      ...rooms.filter((room) => room[5]).map(([x, y, width, height]) => svg("rect", { class: "wall", x, y, width, height })), ...this.names,
      ...solid.map(([x, y, width, height]) => svg("rect", { class: "solid", x, y, width, height })),
      ...open.map((ends) => svg("polyline", { class: "open", points: points(ends) })),
      ...walls.map((ends) => svg("polyline", { class: "parts", points: points(ends) })),
      ...shut.map((ends) => svg("polyline", { class: "shut", points: points(ends) })),
      this.flag, svg("svg", { class: "within", width, height }, this.sight), this.trails.human, this.trails.robot, this.desired, this.human, this.robot, this.bubbles.human, this.bubbles.robot);
  }

  // Draw the trial at `time`: step floor(time), on its way to the next.
  draw(trial, time) {
    const { scene } = trial, step = Math.floor(time), next = Math.min(step + 1, scene.robot.length - 1), share = time - step;
    const put = (node, x, y, turned = 0, scale = 1) => node.setAttribute("transform",
      `translate(${x.toFixed(3)},${y.toFixed(3)}) rotate(${turned.toFixed(1)})${scale === 1 ? "" : ` scale(${scale.toFixed(3)})`}`);
    const moving = (shapes) => {
      const [x, y, heading, size] = shapes[step], [toX, toY, toHeading, toSize] = shapes[next];
      const turn = ((toHeading - heading + 12) % 8) - 4;
      return [between(x, toX, share), between(y, toY, share), (heading + turn * share) * TURN, between(size, toSize, share)];
    };
    const cover = (node, shape) => {
      node.classList.toggle("shown", shape !== null);
      if (shape) ["x", "y", "width", "height"].forEach((name, i) => node.setAttribute(name, shape[i]));
    };
    const [robot, human, sight] = [moving(scene.robot), moving(scene.human), moving(scene.sight)];
    put(this.robot, ...robot);
    put(this.human, ...human);
    if (scene.cells) { // between walls what is seen is told cell by cell
      const [sees, faces] = scene.seen[scene.cells[step]];
      this.sight.children[0].setAttribute("d", rowsOfCells([...sees, ...faces]));
      this.sight.children[1].setAttribute("d", rowsOfCells(faces));
    } else {
      put(this.sight, ...sight.slice(0, 3));
      this.sight.children[0].setAttribute("d", sector(sight[3], STORY.sees));
      this.sight.children[1].setAttribute("d", sector(sight[3], STORY.faces));
    }
    const [x, y, heading, length] = scene.desired[step];
    put(this.desired, x - scene.sight[step][0] + sight[0], y - scene.sight[step][1] + sight[1], heading * TURN);
    this.desired.setAttribute("d", `M0,0 H${length - 0.1} M${length - 0.55},-0.4 L${length},0 L${length - 0.55},0.4`);
    const goal = scene.goal[step];
    cover(this.goal, goal);
    cover(this.reached, scene.reached[step]);
    put(this.flag, goal[0] + goal[2] - STORY.flag.foot[0], goal[1] + STORY.flag.foot[1]);
    this.names.forEach((name, i) => name.classList.toggle("is-goal", i === trial.columns.goal_room[step]));
    for (const [who, now] of [["robot", robot], ["human", human]]) {
      const been = scene[who].slice(Math.max(0, step - STORY.trail), step + 1);
      this.trails[who].setAttribute("points", points([...been.map((shape) => shape.slice(0, 2)), now.slice(0, 2)]));
    }
    for (const [who, now] of [["human", human], ["robot", robot]]) {
      const said = scene[`${who} says`][step] ?? "", bubble = this.bubbles[who];
      bubble.classList.toggle("shown", said !== "");
      bubble.lastChild.textContent = said;
      put(bubble, Math.min(this.place.size[0] - 2.4, Math.max(2.4, now[0])), Math.max(2.6, now[1]));
    }
  }
}
