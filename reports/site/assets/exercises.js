// @ts-check
/** Exercises: the page computes each answer from equations, and compares it with the reader's. */

import { MOTIONS, extent, shapesOf } from "./cam.js";
import { freedoms, rates } from "./exact.js";
import { instantCentre, placed } from "./motion.js";
import { commutator, moved, sidestep } from "./parking.js";

/** @typedef {import("./motion.js").Point} Point */

/** @type {[number, number, number]} */
const START = [0, 0, 0];
const CLOSE = 0.01; // largest relative difference of an answer

/** Return a linkage of thin bars between named points: the bar "AB" is from A to B, and the points in `fixed` are pinned to
 * the ground. @param {Record<string, Point>} points @param {string[]} bars @param {string} fixed */
function linkage(points, bars, fixed) {
  const pose = bars.flatMap(([a, b]) => {
    const [[x, y], [u, v]] = [points[a], points[b]];
    return [(x + u) / 2, (y + v) / 2, Math.atan2(v - y, u - x)];
  });
  const own = (/** @type {number} */ bar, /** @type {string} */ name) => {
    const [[x, y], [u, v]] = [...bars[bar]].map((each) => points[each]);
    return [(Math.hypot(u - x, v - y) / 2) * (bars[bar][0] === name ? -1 : 1), 0];
  };
  const joints = Object.keys(points).flatMap((name) => {
    const all = [...bars.keys()].filter((bar) => bars[bar].includes(name));
    const [first, ...others] = fixed.includes(name) ? [-1, ...all] : all;
    const place = first < 0 ? points[name] : own(first, name);
    return others.map((second) => ({ name, first, second, firstPoint: place, secondPoint: own(second, name), line: null }));
  });
  return { joints, pose, inertia: pose.map(() => 1), gravity: [0, 0], twist: pose.map(() => 0), drives: [] };
}

/** Return the third corner of a triangle on the left of the line from `a` to `b`. @param {Point} a @param {Point} b
 * @param {number} fromA @param {number} fromB @returns {Point} */
function corner([x, y], [u, v], fromA, fromB) {
  const d = Math.hypot(u - x, v - y);
  const along = (d * d + fromA * fromA - fromB * fromB) / (2 * d);
  const aside = Math.sqrt(fromA * fromA - along * along);
  return [x + (along * (u - x) - aside * (v - y)) / d, y + (along * (v - y) + aside * (u - x)) / d];
}

/** @param {number} degrees */
const rad = (degrees) => (degrees * Math.PI) / 180;

/** Return a double pendulum of links of 1 m at angles [degrees] from the downward vertical. @param {number} one @param {number} two */
function pendulum(one, two) {
  const [a, b] = [rad(one - 90), rad(two - 90)];
  /** @type {Point} */
  const A = [Math.cos(a), Math.sin(a)];
  return linkage({ O: [0, 0], A, B: [A[0] + Math.cos(b), A[1] + Math.sin(b)] }, ["OA", "AB"], "O");
}

/** Return the sample's four-bar at a crank angle [degrees], on the side of C that sample 18.15 draws. @param {number} angle @param {boolean} [mirrored] */
function fourBar(angle, mirrored = false) {
  /** @type {Point[]} */
  const [A, D] = [[0, 0], [1.2, 0]];
  /** @type {Point} */
  const B = [0.4 * Math.cos(rad(angle)), 0.4 * Math.sin(rad(angle))];
  const [near, far] = [0.4 * Math.SQRT2, 0.8 * Math.SQRT2];
  const C = mirrored ? corner(D, B, far, near) : corner(B, D, near, far);
  return linkage({ A, B, C, D }, ["AB", "BC", "DC"], "AD");
}

const PERSON = ["AB", "BH", "HS", "HK", "KE"];
/** @type {Record<string, Point>} */
const STANDING = { A: [0, 0], B: [0.1, 0.4], H: [0.25, 0.8], S: [0.2, 1.4], K: [0.4, 0.45], E: [0.5, 0], L: [0.4, 1.1], G: [0.7, 1.2] };

/** @type {Record<string, () => number>} */
export const ANSWERS = {
  tip_speed: () => {
    const links = pendulum(30, 60);
    const turning = rates(links, [[-1, 0, 2], [0, 1, -3]]); // the rate of the second link is relative to the first one
    const [x, y] = placed([0, 0, links.pose[5]], [0.5, 0]);
    return Math.hypot(turning[3] - turning[5] * y, turning[4] + turning[5] * x);
  },
  freedoms_with_handle: () => freedoms(linkage(STANDING, [...PERSON, "SL", "LG"], "AEG")),
  centre_above: () => instantCentre([0, 0, 0], [3, 0, 2])?.[1] ?? NaN,
  moving_circle: () => extent(shapesOf(MOTIONS["Straight line"], 1).body) / 2,
  contact_speed: () => {
    const { space, angles } = shapesOf(MOTIONS["Straight line"], 1, 36_000);
    return (3 * Math.hypot(space[1][0] - space[0][0], space[1][1] - space[0][1])) / (angles[1] - angles[0]);
  },
  commutator_aside: () => commutator(rad(20), 0.5).reduce(moved, START)[1],
  sidestep_turn: () => (sidestep(0.4, 0.5)[0].turn * 180) / Math.PI,
  velocity_from_row: () => {
    // The velocity at O' of a skate with this forward speed at C; the speed follows from the given x velocity.
    const [angle, turning, arm] = [rad(30), 2, 0.3];
    const speed = (1 + turning * arm * Math.sin(angle)) / Math.cos(angle);
    return speed * Math.sin(angle) + turning * arm * Math.cos(angle);
  },
  rocker_rate: () => rates(fourBar(0), [[-1, 0, 10]])[8],
};

/** Show whether an answer is right. @param {HTMLFormElement} form */
function check(form) {
  const given = Number((form.querySelector("input")?.value ?? "").trim().replace(",", ".").replace("\u2212", "-"));
  const answer = ANSWERS[form.dataset.answer ?? ""]();
  const verdict = /** @type {HTMLElement} */ (form.querySelector(".verdict"));
  const right = Math.abs(given - answer) <= CLOSE * Math.abs(answer);
  verdict.textContent = Number.isNaN(given) ? "Give a number." : right ? `Right. The page computes ${Number(answer.toPrecision(5))}.` : Math.abs(given + answer) <= CLOSE * Math.abs(answer) ? "The size is right, the sign is not." : "Not so. The solution is below.";
}

if (typeof document !== "undefined") {
  for (const form of document.querySelectorAll("form.exercise")) {
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      if (form instanceof HTMLFormElement) check(form);
    });
  }
}
