// @ts-check
/** Overlays of a picture: forces, the friction that rolling requires, instant centres. */

import { svg } from "./chart.js";
import { instantCentre, poseAt, formatNumber } from "./motion.js";

/** @typedef {import("./motion.js").Take} Take @typedef {import("./motion.js").Point} Point */
/** @typedef {{take: Take, frame: number, overlay: SVGGElement, width: number}} Scene the target of a drawing */
/** @typedef {{there: (take: Take) => boolean, draw: (scene: Scene) => string}} Overlay */

const ARROW = 0.3; // length of the longest arrow as a fraction of the picture's width

/** @type {Record<string, Overlay>} */
export const OVERLAYS = {
  reactions: { there: ({ forces }) => forces.length > 0, draw: drawForces },
  friction: { there: ({ forces }) => forces.some(({ friction }) => friction !== undefined), draw: drawFriction },
  centre: { there: ({ centre }) => centre !== null, draw: drawCentre },
};

/** Return the vector at an instant from a flat list of pairs. @param {ArrayLike<number|null>} flat @param {number} frame @returns {Point} */
const at = (flat, frame) => [flat[2 * frame] ?? NaN, flat[2 * frame + 1] ?? NaN];

/** Return the lengths of vectors. @param {ArrayLike<number|null>} flat */
function norms(flat) {
  const found = [];
  for (let index = 0; index < flat.length; index += 2) found.push(Math.hypot(flat[index] ?? 0, flat[index + 1] ?? 0));
  return found;
}

/** Return the largest number that is not null. @param {(number|null)[]} values */
const most = (values) => [...values].reduce((/** @type {number} */ a, b) => (b !== null && b > a ? b : a), 0);

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
    const place = at(each.at, frame);
    arrow(scene, place, [scale * x, scale * y], "");
    if (each.contact) scene.overlay.append(svg("circle", { class: "contact", cx: place[0], cy: place[1], r: 0.008 * width }));
  }
  const partly = take.forces.some((each) => each.partly) ? " The motion does not determine all of these forces: drawn is the part that it does." : "";
  return `The longest arrow of this motion is ${formatNumber(largest)} N.${partly}`;
}

/** Draw the two components of the contact force, and the friction coefficient that they require. @param {Scene} scene */
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
    const largest = `the most in this motion is ${formatNumber(most(friction))}`;
    remarks.push(
      now === null ? `The contact would have to pull at this instant, and no friction coefficient is sufficient; otherwise ${largest}.`
      : `Rolling requires a friction coefficient of ${formatNumber(now)} at this instant; ${largest}.`,
    );
  }
  return remarks.join(" ");
}

/** Draw the instant centre of the exact motion, and that of each engine from its pose and velocity. @param {Scene} scene */
function drawCentre({ take, frame, overlay, width }) {
  const body = take.centre ?? 0;
  const bodies = take.bodies.length;
  const size = 0.012 * width;
  let remark = "";
  for (const [index, { pose, twist }] of [...take.motions, take.exact].entries()) {
    const now = poseAt(pose, bodies, frame, body);
    const centre = instantCentre(now, poseAt(twist, bodies, frame, body));
    const own = take.motions[index];
    if (!own) remark = centre ? `In the exact motion the ${take.bodies[body]} turns about (${centre[0].toFixed(2)}, ${centre[1].toFixed(2)}) m.` : "At this instant the body does not turn: its instant centre is infinitely far away.";
    if (!centre || !Number.isFinite(centre[0] + centre[1])) continue;
    const [x, y] = centre;
    const group = svg("g", { class: own ? `method-${own.mark}` : "truth" });
    group.append(
      svg("line", { class: "polar", x1: now[0], y1: now[1], x2: x, y2: y }),
      svg("line", { class: "centre", x1: x - size, y1: y - size, x2: x + size, y2: y + size }),
      svg("line", { class: "centre", x1: x - size, y1: y + size, x2: x + size, y2: y - size }),
    );
    overlay.append(group);
  }
  return remark;
}
