// @ts-check
/** Quantities of a motion: positions of points, gaps of joints, errors against the exact motion. */

/**
 * @typedef {{name: string, first: number, second: number, firstPoint: number[], secondPoint: number[],
 *   line: number|null}} Joint a pin, or a slot of the first body along `line` [rad]
 * @typedef {{pose: ArrayLike<number>, twist: ArrayLike<number>}} States
 * @typedef {States & {name: "munk"|"mujoco", label: string, mark: number, errors: ArrayLike<number>, error: number}} Motion
 * @typedef {{name: string, at: ArrayLike<number|null>, force: ArrayLike<number|null>, partly?: boolean,
 *   contact?: boolean, normal?: (number|null)[],
 *   friction?: (number|null)[]}} Force
 * @typedef {{name: string, body: number, point: number[], angle: number}} Blade
 * @typedef {{t: ArrayLike<number>, bodies: string[], joints: Joint[], blades: Blade[], size: number,
 *   measure: "angle"|"position", exact: States, motions: Motion[], gaps: number[], playback: import("./playback.js").Playback,
 *   forces: Force[], centre: number|null, traces: {body: number, point: number[]}[], window: number[],
 *   mechanism: object|null}} Take mechanism: the equations of a linkage, which the reader can drag anywhere
 * @typedef {[number, number]} Point
 */

/** @type {Record<string, string>} */
export const NAMES = { munk: "pymunk", mujoco: "MuJoCo" };
/** @type {Record<string, number>} */
export const MARKS = { munk: 1, mujoco: 2 };
export const UNITS = { angle: "rad", position: "m" };

/** Place a drawing at a pose. @param {Element} element @param {number} x @param {number} y @param {number} angle [rad] */
export const put = (element, x, y, angle) => element.setAttribute("transform", `translate(${x} ${y}) rotate(${(angle * 180) / Math.PI})`);

/** Return the position of a pointer in the coordinates of a part of a drawing. @param {Element|null} part @param {PointerEvent} event @returns {Point} */
export function pointerIn(part, { clientX, clientY }) {
  const { x, y } = new DOMPoint(clientX, clientY).matrixTransform(/** @type {SVGGraphicsElement} */ (part).getScreenCTM()?.inverse());
  return [x, y];
}

/** The directions of the arrow keys. @type {Record<string, Point>} */
export const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

/** Call `begin` for a pointer that is pressed on an element, `move` while it is held, and `end` when it is released. `begin`
 * may return false: then the pointer is not held. @param {GlobalEventHandlers & Element & HTMLOrSVGElement} element
 * @param {{begin?: (event: PointerEvent) => boolean|void, move: (event: PointerEvent) => void, end?: () => void}} calls */
export function onDrag(element, { begin = () => {}, move, end = () => {} }) {
  let held = false;
  const release = () => {
    if (held) end();
    held = false;
  };
  element.addEventListener("pointerdown", (event) => {
    if (begin(event) === false) return;
    held = true;
    element.setPointerCapture(event.pointerId);
    event.preventDefault();
    element.focus({ preventScroll: true });
  });
  element.addEventListener("pointermove", (event) => {
    if (held) move(event);
  });
  for (const name of /** @type {const} */ (["pointerup", "pointercancel"])) element.addEventListener(name, release);
}

/** Return the pose [x, y, angle] at an instant, or NaN.
 * @param {ArrayLike<number|null>} pose @param {number} bodies @param {number} frame @param {number} body
 * @returns {[number, number, number]} */
export function poseAt(pose, bodies, frame, body) {
  const start = 3 * (frame * bodies + body);
  const read = (/** @type {number} */ index) => pose[index] ?? NaN;
  return [read(start), read(start + 1), read(start + 2)];
}

/** Return the position of a point of a body at its pose. @param {number[]} pose @param {number[]} point @returns {Point} */
export function placed([x, y, angle], [a, b]) {
  const cosine = Math.cos(angle);
  const sine = Math.sin(angle);
  return [x + cosine * a - sine * b, y + sine * a + cosine * b];
}

/** Return the path of a line through points for an SVG; "" without points. @param {number[][]} points @param {number} digits after the point */
export const pathThrough = (points, digits) => points.length ? `M${points.map((point) => point.map((value) => value.toFixed(digits)).join(" ")).join("L")}` : "";

/** Return the distance of a body's point from a place. @param {number[]} pose @param {number[]} point @param {number[]} place */
export function distance(pose, point, [x, y]) {
  const [px, py] = placed(pose, point);
  return Math.hypot(px - x, py - y);
}

/** Return the two points of a pin at an instant, or the nearest point of a slot's line and the point on the second body.
 * @param {Joint} joint @param {ArrayLike<number|null>} pose @param {number} bodies @param {number} frame
 * @returns {[Point, Point]} */
export function ends(joint, pose, bodies, frame) {
  const one = (/** @type {number} */ body, /** @type {number[]} */ point) =>
    body < 0 ? /** @type {Point} */ ([point[0], point[1]]) : placed(poseAt(pose, bodies, frame, body), point);
  const [first, second] = [one(joint.first, joint.firstPoint), one(joint.second, joint.secondPoint)];
  if (joint.line === null) return [first, second];
  const angle = joint.line + (joint.first < 0 ? 0 : poseAt(pose, bodies, frame, joint.first)[2]);
  const along = (second[0] - first[0]) * Math.cos(angle) + (second[1] - first[1]) * Math.sin(angle);
  return [[first[0] + along * Math.cos(angle), first[1] + along * Math.sin(angle)], second];
}

/** Return the largest error of an angle [rad] and of a position [m] at every instant; NaN after a method has failed.
 * @param {ArrayLike<number|null>} truth @param {ArrayLike<number|null>} pose @param {number} bodies
 * @param {number} frames @returns {{angle: Float64Array, position: Float64Array}} */
export function errors(truth, pose, bodies, frames) {
  const angle = new Float64Array(frames);
  const position = new Float64Array(frames);
  for (let frame = 0; frame < frames; frame++) {
    for (let body = 0; body < bodies; body++) {
      const exact = poseAt(truth, bodies, frame, body);
      const own = poseAt(pose, bodies, frame, body);
      const turned = Math.abs(own[2] - exact[2]);
      const moved = Math.hypot(own[0] - exact[0], own[1] - exact[1]);
      // Math.max returns NaN if a value is NaN.
      angle[frame] = Math.max(angle[frame], turned);
      position[frame] = Math.max(position[frame], moved);
    }
  }
  return { angle, position };
}

/** Return the magnified joints: each pin and slot with its gap [m], each blade with its slip [m/s], as vectors.
 * @param {Pick<Take, "joints"|"blades"|"bodies">} take
 * @returns {{name: string, unit: string, at: (motion: States, frame: number) => number[]}[]} */
export function gapsOf({ joints, blades, bodies: { length: bodies } }) {
  return [
    ...joints.map((joint) => ({
      name: joint.name, unit: "m",
      at: (/** @type {States} */ { pose }, /** @type {number} */ frame) => {
        const [[ax, ay], [bx, by]] = ends(joint, pose, bodies, frame);
        return [bx - ax, by - ay];
      },
    })),
    ...blades.map((blade) => ({
      name: blade.name, unit: "m/s", at: (/** @type {States} */ { pose, twist }, /** @type {number} */ frame) => slip(blade, pose, twist, bodies, frame),
    })),
  ];
}

/** Replace values of at least 1e6 by NaN. @param {Float64Array} pose */
export const finite = (pose) => pose.map((value) => (Math.abs(value) < 1e6 ? value : NaN));

/** Return the velocity across a blade at its point, as a vector [m/s]. @param {Blade} blade
 * @param {ArrayLike<number>} pose @param {ArrayLike<number>} twist @param {number} bodies @param {number} frame @returns {Point} */
export function slip({ body, point, angle }, pose, twist, bodies, frame) {
  const [vx, vy, rate] = poseAt(twist, bodies, frame, body);
  const heading = poseAt(pose, bodies, frame, body)[2];
  const [ax, ay] = placed([0, 0, heading], point);
  const [nx, ny] = [-Math.sin(heading + angle), Math.cos(heading + angle)];
  const across = (vx - rate * ay) * nx + (vy + rate * ax) * ny;
  return [across * nx, across * ny];
}

/** Return the instant centre of a body for its pose and twist; null if the body does not turn.
 * @param {number[]} pose @param {number[]} twist @returns {Point|null} */
export function instantCentre([x, y], [vx, vy, rate]) {
  return Math.abs(rate) < 1e-9 ? null : [x - vy / rate, y + vx / rate];
}

/** Format a whole number with commas. Number.toLocaleString takes 5 ms for its first number. @param {number} value */
export const grouped = (value) => String(value).replace(/\B(?=(\d{3})+$)/g, ",");

/** Format a number with two digits; a small or large number has a power of ten. @param {number} value */
export function formatNumber(value) {
  if (!Number.isFinite(value)) return "lost";
  if (value === 0) return "0";
  const size = Math.abs(value);
  return size >= 0.01 && size < 1000 ? String(Number(value.toPrecision(2))) : value.toExponential(1);
}
