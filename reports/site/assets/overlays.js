// @ts-check
/** What can be switched on over a picture: forces, the friction that rolling demands, instant centres, open joints. */

import { svg } from "./chart.js";
import { ends, instantCentre, poseAt, told } from "./motion.js";

/** @typedef {import("./motion.js").Take} Take @typedef {import("./motion.js").Point} Point */
/** @typedef {{take: Take, frame: number, overlay: SVGGElement, width: number, gaps: number[]}} Scene what is drawn on */
/** @typedef {{there: (take: Take) => boolean, draw: (scene: Scene) => string}} Overlay */

const LENS = 0.09; // radius of a magnified joint, of the picture's width
const ARROW = 0.3; // length of the longest arrow, of the picture's width

/** @type {Record<string, Overlay>} */
export const OVERLAYS = {
  reactions: { there: ({ forces }) => forces.length > 0, draw: drawForces },
  friction: { there: ({ forces }) => forces.some(({ friction }) => friction !== undefined), draw: drawFriction },
  centre: { there: ({ centre }) => centre !== null, draw: drawCentre },
  gaps: { there: ({ joints, loose, motions }) => joints.length + loose.length > 0 && motions.length > 0, draw: drawGaps },
};

/** A vector of numbers in pairs, at an instant. @param {ArrayLike<number|null>} flat @param {number} frame @returns {Point} */
const at = (flat, frame) => [flat[2 * frame] ?? NaN, flat[2 * frame + 1] ?? NaN];

/** Lengths of vectors. @param {(number|null)[]} flat */
function norms(flat) {
  const found = [];
  for (let index = 0; index < flat.length; index += 2) found.push(Math.hypot(flat[index] ?? 0, flat[index + 1] ?? 0));
  return found;
}

/** The largest of numbers, of those that are there. @param {(number|null)[]} values */
const most = (values) => values.reduce((/** @type {number} */ a, b) => (b !== null && b > a ? b : a), 0);

/** @param {Scene} scene @param {Point} from @param {Point} by @param {string} kind */
function arrow({ overlay, width }, [x, y], [dx, dy], kind) {
  const length = Math.hypot(dx, dy);
  if (!(length >= 1e-6 * width)) return;
  const head = Math.min(0.02 * width, 0.6 * length);
  const [ux, uy] = [dx / length, dy / length];
  const [tx, ty] = [x + dx, y + dy];
  const [bx, by] = [tx - head * ux, ty - head * uy];
  overlay.append(
    svg("line", { class: `arrow ${kind}`, x1: x, y1: y, x2: bx, y2: by }),
    svg("path", {
      class: `head ${kind}`,
      d: `M${tx} ${ty}L${bx - 0.45 * head * uy} ${by + 0.45 * head * ux}L${bx + 0.45 * head * uy} ${by - 0.45 * head * ux}Z`,
    }),
  );
}

/** @param {Scene} scene */
function drawForces(scene) {
  const { take, frame, width } = scene;
  const largest = Math.max(1e-12, ...take.forces.map(({ force }) => most(norms(force))));
  const scale = (ARROW * width) / largest;
  for (const each of take.forces) {
    const [x, y] = at(each.force, frame);
    arrow(scene, at(each.at, frame), [scale * x, scale * y], "");
  }
  return `The longest arrow of this motion is ${told(largest)} N.`;
}

/** The contact force in its two parts, and the coefficient that they ask for. @param {Scene} scene */
function drawFriction(scene) {
  const { take, frame, width } = scene;
  const remarks = [];
  for (const { at: places, force, normal, friction } of take.forces) {
    if (!friction || !normal) continue;
    const scale = (ARROW * width) / Math.max(1e-12, most(norms(force)));
    const [[fx, fy], [nx, ny]] = [at(force, frame), at(normal, frame)];
    arrow(scene, at(places, frame), [scale * nx, scale * ny], "normal");
    arrow(scene, at(places, frame), [scale * (fx - nx), scale * (fy - ny)], "");
    const now = friction[frame];
    const largest = `the most in this motion is ${told(most(friction))}`;
    remarks.push(
      now === null ? `The contact would have to pull here: no friction is enough; elsewhere ${largest}.`
      : `To roll here the contact needs a coefficient of friction of ${told(now)}; ${largest}.`,
    );
  }
  return remarks.join(" ");
}

/** @param {Scene} scene */
function drawCentre({ take, frame, overlay, width }) {
  if (take.centre === null) return "";
  const bodies = take.bodies.length;
  const pose = poseAt(take.truth.pose, bodies, frame, take.centre);
  const centre = instantCentre(pose, poseAt(take.truth.twist, 1, frame, 0));
  if (!centre) return "At this instant the body does not turn: its instant centre is infinitely far away.";
  const size = 0.012 * width;
  const [x, y] = centre;
  overlay.append(
    svg("line", { class: "polar", x1: pose[0], y1: pose[1], x2: x, y2: y }),
    svg("line", { class: "centre", x1: x - size, y1: y - size, x2: x + size, y2: y + size }),
    svg("line", { class: "centre", x1: x - size, y1: y + size, x2: x + size, y2: y - size }),
  );
  return `The ${take.bodies[take.centre]} turns about (${x.toFixed(2)}, ${y.toFixed(2)}) m.`;
}

/** Every joint as a circle with what is open in it, much larger than it is. @param {Scene} scene */
function drawGaps(scene) {
  const { take, frame, gaps, width } = scene;
  const bodies = take.bodies.length;
  const radius = LENS * width;
  const remarks = [];
  const largest = Math.max(...gaps, 0);
  if (take.joints.length && largest <= 0) remarks.push("No joint is open.");
  if (largest > 0) {
    const factor = round(radius / largest);
    for (const joint of take.joints) {
      const [centre] = ends(joint, take.truth.pose, bodies, frame);
      lens(scene, centre, take.motions.map(({ pose }) => {
        const [[ax, ay], [bx, by]] = ends(joint, pose, bodies, frame);
        return [(bx - ax) * factor, (by - ay) * factor];
      }));
    }
    remarks.push(`Gaps are drawn ${larger(factor)}; the largest of this motion is ${told(largest)} m.`);
  }
  for (const unit of new Set(take.loose.map((each) => each.unit))) remarks.push(drawLoose(scene, unit, radius));
  return remarks.filter(Boolean).join(" ");
}

/** Slips of skates [m/s] or openings of rolling contacts [m]. @param {Scene} scene @param {string} unit @param {number} radius */
function drawLoose(scene, unit, radius) {
  const own = scene.take.loose.filter((each) => each.unit === unit);
  const largest = Math.max(...own.flatMap(({ motions }) => motions.map((flat) => most(norms(flat)))));
  const what = unit === "m" ? "Openings of the contact" : "Sideways velocities of the blade";
  if (!(largest > 0)) return "";
  const factor = round(radius / largest);
  for (const { at: places, motions } of own) {
    lens(scene, at(places, scene.frame), motions.map((flat) => {
      const [x, y] = at(flat, scene.frame);
      return [factor * x, factor * y];
    }));
  }
  const scale = unit === "m" ? larger(factor) : `with ${told(1 / factor)} m/s as a metre of the picture`;
  return `${what} are drawn ${scale}; the largest of this motion is ${told(largest)} ${unit}.`;
}

/** @param {Scene} scene @param {Point} centre @param {Point[]} vectors one a motion */
function lens({ take, overlay, width }, [x, y], vectors) {
  const group = svg("g", {});
  group.append(svg("circle", { class: "lens", cx: x, cy: y, r: LENS * width }));
  vectors.forEach(([dx, dy], index) => {
    if (!Number.isFinite(dx + dy)) return;
    const own = svg("g", { class: `method-${take.motions[index].mark ?? index + 1}` });
    const dot = 0.006 * width;
    own.append(
      svg("line", { class: "gap", x1: x, y1: y, x2: x + dx, y2: y + dy }),
      svg("circle", { class: "dot", cx: x, cy: y, r: dot }),
      svg("circle", { class: "dot", cx: x + dx, cy: y + dy, r: dot }),
    );
    group.append(own);
  });
  overlay.append(group);
}

/** The largest of 1, 2, 5, 10, ... that is not above a number. @param {number} value */
function round(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return power * (value >= 5 * power ? 5 : value >= 2 * power ? 2 : 1);
}

/** @param {number} factor */
function larger(factor) {
  if (factor < 1) return `${told(factor)} times as large as they are`;
  return factor < 1e6 ? `${factor.toLocaleString("en")} times as large as they are` : `${factor.toExponential(0)} times as large as they are`;
}
