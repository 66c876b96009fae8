// @ts-check
/** Moving pictures: what the page already shows at rest is moved, dragged, and given arrows, centres and magnified gaps. */

import { errorChart, svg } from "./chart.js";
import { ends, errors, instantCentre, largestGap, poseAt, told } from "./motion.js";

/** @typedef {import("./motion.js").Take} Take */

const SECONDS = 6; // how long a motion takes to play, however fast it was
const LENS = 0.09; // radius of a magnified joint, of the picture's width
const calm = matchMedia("(prefers-reduced-motion: reduce)");

/** @param {string} name @returns {Take} */
function read(name) {
  const text = document.getElementById(`take-${name}`)?.textContent;
  if (!text) throw new Error(`no take is called ${name}`);
  return JSON.parse(text);
}

export class Player {
  /** @param {HTMLElement} figure @param {Take} take */
  constructor(figure, take) {
    this.figure = figure;
    this.controls = /** @type {HTMLElement} */ (figure.querySelector(".controls"));
    this.time = /** @type {HTMLInputElement} */ (figure.querySelector(".time input"));
    this.clock = /** @type {HTMLElement} */ (figure.querySelector(".clock"));
    this.button = /** @type {HTMLButtonElement} */ (figure.querySelector(".play"));
    this.remark = /** @type {HTMLElement} */ (figure.querySelector(".remark"));
    this.chart = /** @type {HTMLElement} */ (figure.querySelector(".errors"));
    this.boxes = /** @type {HTMLInputElement[]} */ ([...figure.querySelectorAll(".overlays input")]);
    this.frame = 0;
    this.playing = false;
    /** @type {(time: number) => void} */
    this.mark = () => {};
    const on = (figure.dataset.on ?? "").split(" ");
    for (const box of this.boxes) {
      box.checked = on.includes(box.value);
      box.addEventListener("change", () => this.show());
    }
    this.time.addEventListener("input", () => {
      this.stop();
      this.frame = Number(this.time.value);
      this.show();
    });
    this.button.addEventListener("click", () => (this.playing ? this.stop() : this.play()));
    this.controls.hidden = false;
    this.chart.hidden = false;
    this.take = take;
    // At rest most motions have nothing to show: no gap is open yet, and forces are those of the start.
    if (on.some((word) => word !== "paths" && word)) this.frame = Math.round(0.4 * (take.t.length - 1));
    this.load(take);
  }

  /** Take over a drawing whose groups stand in the order of the motions, the truth last. @param {Take} take */
  load(take) {
    this.take = take;
    this.bodies = take.bodies.length;
    this.frames = take.t.length;
    this.stage = /** @type {SVGSVGElement} */ (this.figure.querySelector("svg.stage"));
    this.overlay = /** @type {SVGGElement} */ (this.stage.querySelector(".overlay"));
    this.groups = [...this.stage.querySelectorAll(".motion")].map((group) => [...group.querySelectorAll(".body")]);
    this.time.max = String(this.frames - 1);
    this.frame = Math.min(this.frame, this.frames - 1);
    for (const box of this.boxes) {
      const there =
        box.value === "reactions" ? take.forces.length > 0
        : box.value === "centre" ? take.centre !== null
        : box.value === "gaps" ? take.joints.length > 0
        : take.traces.length > 0;
      box.disabled = !there;
    }
    this.largestForce = Math.max(1e-12, ...take.forces.flatMap((f) => norms(f.force)));
    this.measure();
    this.show();
  }

  /** The errors of the motions, drawn and told. */
  measure() {
    const { take, bodies, frames } = this;
    const lines = take.motions.map((motion, index) => ({
      name: motion.name,
      mark: index + 1,
      values: errors(take.truth.pose, motion.pose, bodies, frames).angle,
    }));
    this.mark = errorChart(this.chart, take.t, lines, "rad");
    const legend = this.figure.querySelectorAll(".legend .figure");
    lines.forEach((line, index) => {
      const worst = line.values.reduce((a, b) => Math.max(a, b), 0);
      if (legend[index]) legend[index].textContent = `up to ${told(worst)} rad`;
    });
    this.gaps = take.motions.map((motion) => largestGap(take.joints, motion.pose, bodies, frames));
  }

  play() {
    this.playing = true;
    this.button.textContent = "Pause";
    this.button.setAttribute("aria-pressed", "true");
    if (this.frame >= this.frames - 1) this.frame = 0;
    const begin = performance.now() - (this.frame / (this.frames - 1)) * SECONDS * 1000;
    const step = (/** @type {number} */ now) => {
      if (!this.playing) return;
      // The first frame may have begun before the button was pressed.
      const passed = Math.max(0, (now - begin) / 1000 / SECONDS);
      this.frame = Math.min(this.frames - 1, Math.floor(passed * (this.frames - 1)));
      this.show();
      if (this.frame >= this.frames - 1) this.stop();
      else requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  }

  stop() {
    this.playing = false;
    this.button.textContent = "Play";
    this.button.setAttribute("aria-pressed", "false");
  }

  /** @param {string} overlay */
  on(overlay) {
    return this.boxes.some((box) => box.value === overlay && box.checked && !box.disabled);
  }

  /** Draw the present instant. */
  show() {
    const { take, frame, bodies } = this;
    const motions = [...take.motions.map((motion) => motion.pose), take.truth.pose];
    this.groups.forEach((group, index) => {
      group.forEach((element, body) => {
        const [x, y, angle] = poseAt(motions[index], bodies, frame, body);
        const there = Number.isFinite(x + y + angle);
        element.setAttribute("visibility", there ? "visible" : "hidden");
        if (there) element.setAttribute("transform", `translate(${x} ${y}) rotate(${(angle * 180) / Math.PI})`);
      });
    });
    this.stage.classList.toggle("paths", this.on("paths"));
    this.time.value = String(frame);
    this.clock.textContent = `${take.t[frame].toFixed(3)} s`;
    this.time.setAttribute("aria-valuetext", this.clock.textContent);
    this.mark(take.t[frame]);
    this.overlay.replaceChildren();
    const remarks = [];
    if (this.on("reactions")) remarks.push(this.showForces());
    if (this.on("centre")) remarks.push(this.showCentre());
    if (this.on("gaps")) remarks.push(this.showGaps());
    this.remark.textContent = remarks.filter(Boolean).join(" ");
  }

  get width() {
    return this.stage.viewBox.baseVal.width;
  }

  showForces() {
    const { take, frame } = this;
    const scale = (0.3 * this.width) / this.largestForce;
    for (const force of take.forces) {
      const [x, y] = [force.at[2 * frame], force.at[2 * frame + 1]];
      const [fx, fy] = [force.force[2 * frame] ?? NaN, force.force[2 * frame + 1] ?? NaN];
      if (Number.isFinite(fx + fy)) this.arrow(x, y, scale * fx, scale * fy);
    }
    return `The longest arrow of this motion is ${told(this.largestForce)} N.`;
  }

  /** @param {number} x @param {number} y @param {number} dx @param {number} dy */
  arrow(x, y, dx, dy) {
    const length = Math.hypot(dx, dy);
    if (length < 1e-6 * this.width) return;
    const head = Math.min(0.02 * this.width, 0.6 * length);
    const [ux, uy] = [dx / length, dy / length];
    const [tx, ty] = [x + dx, y + dy];
    const [bx, by] = [tx - head * ux, ty - head * uy];
    this.overlay.append(
      svg("line", { class: "arrow", x1: x, y1: y, x2: bx, y2: by }),
      svg("path", {
        class: "head",
        d: `M${tx} ${ty}L${bx - 0.45 * head * uy} ${by + 0.45 * head * ux}L${bx + 0.45 * head * uy} ${by - 0.45 * head * ux}Z`,
      }),
    );
  }

  showCentre() {
    const { take, frame, bodies } = this;
    if (take.centre === null) return "";
    const pose = poseAt(take.truth.pose, bodies, frame, take.centre);
    const centre = instantCentre(pose, poseAt(take.truth.twist, bodies, frame, take.centre));
    if (!centre) return "At this instant the body does not turn: its instant centre is infinitely far away.";
    const size = 0.012 * this.width;
    const [x, y] = centre;
    this.overlay.append(
      svg("line", { class: "polar", x1: pose[0], y1: pose[1], x2: x, y2: y }),
      svg("line", { class: "centre", x1: x - size, y1: y - size, x2: x + size, y2: y + size }),
      svg("line", { class: "centre", x1: x - size, y1: y + size, x2: x + size, y2: y - size }),
    );
    return `The ${take.bodies[take.centre]} turns about (${x.toFixed(2)}, ${y.toFixed(2)}) m.`;
  }

  showGaps() {
    const { take, frame, bodies } = this;
    const radius = LENS * this.width;
    const largest = Math.max(...this.gaps, 0);
    if (largest <= 0) return "No joint is open.";
    const factor = round(radius / largest);
    for (const joint of take.joints) {
      const [[x, y]] = ends(joint, take.truth.pose, bodies, frame);
      const lens = svg("g", {});
      lens.append(svg("circle", { class: "lens", cx: x, cy: y, r: radius }));
      take.motions.forEach((motion, index) => {
        const [[ax, ay], [bx, by]] = ends(joint, motion.pose, bodies, frame);
        const [dx, dy] = [(bx - ax) * factor, (by - ay) * factor];
        if (!Number.isFinite(dx + dy)) return;
        const group = svg("g", { class: `method-${index + 1}` });
        const dot = 0.006 * this.width;
        group.append(
          svg("line", { class: "gap", x1: x, y1: y, x2: x + dx, y2: y + dy }),
          svg("circle", { class: "dot", cx: x, cy: y, r: dot }),
          svg("circle", { class: "dot", cx: x + dx, cy: y + dy, r: dot }),
        );
        lens.append(group);
      });
      this.overlay.append(lens);
    }
    const told_factor = factor >= 1 ? `${factor.toLocaleString("en")} times as large as they are` : "smaller than they are";
    return `Gaps are drawn ${told_factor}; the largest of this motion is ${told(largest)} m.`;
  }
}

/** The largest of 1, 2, 5, 10, ... that is not above a number. @param {number} value */
function round(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return power * (value >= 5 * power ? 5 : value >= 2 * power ? 2 : 1);
}

/** Lengths of the forces. @param {(number|null)[]} flat */
function norms(flat) {
  const found = [];
  for (let index = 0; index < flat.length; index += 2) found.push(Math.hypot(flat[index] ?? 0, flat[index + 1] ?? 0));
  return found;
}

/** Put another motion into a figure: its drawing, its legend, its data. @param {Player} player @param {string} name */
function change(player, name) {
  const figure = player.figure;
  const picture = figure.parentElement?.querySelector(`template[data-picture="${name}"]`);
  const take = read(name);
  if (picture instanceof HTMLTemplateElement) {
    figure.querySelector(".frame")?.replaceChildren(picture.content.cloneNode(true));
  }
  const legend = figure.querySelector(".legend");
  const entries = take.motions.map((motion, index) => {
    const entry = document.createElement("li");
    entry.className = `method-${index + 1}`;
    const [mark, figureText] = [document.createElement("span"), document.createElement("span")];
    mark.className = "mark";
    mark.setAttribute("aria-hidden", "true");
    figureText.className = "figure";
    entry.append(mark, motion.name, figureText);
    return entry;
  });
  const lost = take.lost.map(({ name: method, why }) => {
    const entry = document.createElement("li");
    entry.className = "lost";
    entry.textContent = `${method}: ${why}`;
    return entry;
  });
  const truth = legend?.querySelector(".truth");
  if (legend && truth) legend.replaceChildren(truth, ...entries, ...lost);
  player.stop();
  player.frame = 0;
  player.load(take);
  if (!calm.matches) player.play();
}

document.documentElement.classList.add("js");
/** @type {Map<string, Player>} */
export const players = new Map();
for (const figure of document.querySelectorAll('figure.moving[data-take]:not([data-take=""])')) {
  if (figure instanceof HTMLElement) players.set(figure.id, new Player(figure, read(figure.dataset.take ?? "")));
}
const front = players.get("front");
if (front && !calm.matches) front.play();
for (const button of document.querySelectorAll("button[data-figure]")) {
  if (!(button instanceof HTMLButtonElement)) continue;
  button.hidden = false;
  button.addEventListener("click", () => {
    const player = players.get(button.dataset.figure ?? "");
    if (player) change(player, button.dataset.take ?? "");
    for (const other of document.querySelectorAll("button[data-figure]")) {
      other.classList.toggle("chosen", other === button);
      other.setAttribute("aria-pressed", String(other === button));
    }
  });
}
