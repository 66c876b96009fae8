// @ts-check
/** The magnified gap of one joint in each engine, and the iterations of one step of pymunk. */

import { svg } from "./chart.js";
import { rows } from "./exact.js";
import { gapsOf, grouped, pathThrough, formatNumber } from "./motion.js";

/** @typedef {import("./motion.js").Take} Take */
/** @typedef {{pose: Float64Array, twist: Float64Array, impulses: Float64Array, left: number}} Sweep */

const SIZE = 200; // size of the picture; its centre is the ideal joint
const TRAIL = 12; // number of earlier frames that are drawn

export class Lens {
  /** @param {HTMLElement} place */
  constructor(place) {
    this.place = place;
    this.picture = /** @type {Element} */ (place.querySelector("svg"));
    this.words = /** @type {HTMLElement} */ (place.querySelector(".words"));
    this.choice = /** @type {HTMLSelectElement} */ (place.querySelector("select"));
    /** @type {Take|null} */
    this.take = null;
    /** @type {ReturnType<typeof gapsOf>} */
    this.joints = [];
    this.factor = 1;
    this.scaled = 0; // `drawn` when the scale was chosen; reading it in each frame would force a layout
    this.enlarged = 1; // factor of the differences in the main picture
    this.frame = 0;
    this.choice.addEventListener("change", () => this.scale());
  }

  /** @param {Take} take */
  load(take) {
    this.take = take;
    this.joints = gapsOf(take);
    this.place.hidden = !this.joints.length || !take.motions.length;
    if (this.place.hidden) return;
    const worst = take.gaps.indexOf(Math.max(...take.gaps));
    this.choice.replaceChildren(...this.joints.map(({ name }, index) => new Option(`${index === worst ? "worst: " : ""}${name}`, String(index), false, index === worst)));
  }

  /** Choose the magnification at which the largest gap fills the picture. */
  scale() {
    const most = this.take?.gaps[Number(this.choice.value)] ?? 0;
    this.factor = most > 0 ? (0.42 * SIZE) / most : 0;
    this.scaled = this.drawn;
    this.show(this.frame);
  }

  /** @param {number} frame */
  show(frame) {
    this.frame = frame;
    const { take, factor } = this;
    const joint = this.joints[Number(this.choice.value)];
    if (!take || !joint || this.place.hidden) return;
    const middle = SIZE / 2;
    const parts = [svg("circle", { class: "hole", cx: middle, cy: middle, r: 9 })];
    const remarks = take.motions.map((motion) => {
      const { label, mark } = motion;
      const [x, y] = joint.at(motion, frame);
      const away = Math.hypot(x, y);
      if (!Number.isFinite(away)) return `${label}: lost`;
      const group = svg("g", { class: `method-${mark}` });
      const trail = Array.from({ length: Math.min(TRAIL, frame) + 1 }, (_, back) => joint.at(motion, frame - back)).filter(([a, b]) => Number.isFinite(a + b));
      group.append(svg("path", { class: "line", d: pathThrough(trail.map(([a, b]) => [middle + factor * a, middle - factor * b]), 1) }));
      group.append(svg("path", { class: mark === 2 && joint.unit === "m" ? "spring" : "gap", d: zigzag(middle, middle, middle + factor * x, middle - factor * y, mark === 2 && joint.unit === "m") }));
      group.append(svg("circle", { class: "dot", cx: middle + factor * x, cy: middle - factor * y, r: 5 }));
      parts.push(group);
      return `${label} ${formatNumber(away).replace("e-", "e\u2011")} ${joint.unit}`;
    });
    const bar = 10 ** Math.floor(Math.log10((0.5 * SIZE) / (factor || 1)));
    if (factor) {
      parts.push(svg("line", { class: "bar", x1: 10, x2: 10 + bar * factor, y1: SIZE - 12, y2: SIZE - 12 }));
      parts.push(svg("text", { x: 10, y: SIZE - 18 }, `${formatNumber(bar)} ${joint.unit}`));
    }
    this.picture.replaceChildren(...parts);
    const enlarged = this.scaled ? factor / this.scaled / this.enlarged : 0;
    const times = joint.unit === "m" && factor && enlarged ? `, ${grouped(Number(enlarged.toPrecision(1)))} times as large as above` : "";
    this.words.textContent = `${joint.unit === "m" ? "Open" : "Slips"} by: ${remarks.join(", ")}${times}.`;
  }

  /** Return the length of a metre of the main picture in units of the magnified picture. */
  get drawn() {
    const stage = /** @type {SVGGraphicsElement|null} */ (this.place.closest("figure")?.querySelector("svg.stage .world"));
    const own = this.picture.clientWidth / SIZE;
    return stage && own ? Math.abs(stage.getScreenCTM()?.a ?? 0) / own : 0;
  }

  /** Fill the table of one iteration with the impulse that it adds to each joint and the remaining opening velocity.
   * Returns the caption.
   * @param {{found: Sweep[], whole: number, which: number[], step: number}} step @param {number} number from 0 @param {Element} table */
  sweep({ found, whole, which, step }, number, table) {
    const { take } = this;
    if (!take) return "";
    const held = take.joints.map((joint, index) => ({ joint, own: which[index] })).filter(({ own }) => own >= 0);
    const worst = Math.max(...held.map(({ joint }) => remaining(joint, found[0], step)));
    table.replaceChildren(...held.map(({ joint, own }) => {
      const now = remaining(joint, found[number], step);
      const [before, after] = [number - 1, number].map((at) => found[at]?.impulses.slice(2 * own, 2 * own + 2) ?? [0, 0]);
      const row = document.createElement("tr");
      for (const text of [joint.name, number ? formatNumber(Math.hypot(after[0] - before[0], after[1] - before[1])) : "–", formatNumber(now)]) row.insertCell().textContent = text;
      const bar = document.createElement("span");
      bar.className = "share";
      bar.style.width = `${now > 0 ? Math.max(0, 100 + (100 * Math.log10(now / worst)) / 8).toFixed(1) : 0}%`;
      row.insertCell().append(bar);
      return row;
    }));
    return `One step of pymunk, ${formatNumber(1000 * step)} ms long, after iteration ${number + 1} of ${whole}:`;
  }
}

/** Return the velocity at which a joint opens beyond the solver's target [m/s]. @param {import("./motion.js").Joint} joint
 * @param {Sweep} sweep @param {number} step */
function remaining(joint, { pose, twist, left }, step) {
  const equations = rows({ joints: [joint], drives: [] }, pose, twist, null);
  return Math.hypot(...equations.map(({ columns, gap }) => ((1 - left) / step) * gap + columns.reduce((sum, value, k) => sum + value * twist[k], 0)));
}

/** Return a straight line between two points, or a zigzag line for a spring. @param {number} x1 @param {number} y1 @param {number} x2 @param {number} y2 @param {boolean} spring */
function zigzag(x1, y1, x2, y2, spring) {
  const points = spring ? 12 : 1;
  const length = Math.hypot(x2 - x1, y2 - y1) || 1;
  const [nx, ny] = [(4 * (y1 - y2)) / length, (4 * (x2 - x1)) / length];
  return pathThrough(Array.from({ length: points + 1 }, (_, point) => {
    const side = point % points === 0 ? 0 : point % 2 ? 1 : -1;
    return [x1 + ((x2 - x1) * point) / points + side * nx, y1 + ((y2 - y1) * point) / points + side * ny];
  }), 1);
}
