// @ts-check
/** Exercises: the page computes each answer from equations, and compares it with the reader's. */

import { MOTIONS, extent, shapesOf } from "./cam.js";
import { ERRATA, L1, L2, L3, L4, closedForm, direction, scaled, sum, zero } from "./errata.js";
import { freedoms, motion, rates } from "./exact.js";
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

/** @param {number} degrees */
const rad = (degrees) => (degrees * Math.PI) / 180;

/** Return a double pendulum of links of 1 m at angles [degrees] from the downward vertical. @param {number} one @param {number} two */
function pendulum(one, two) {
  const A = /** @type {Point} */ (direction(rad(one - 90)));
  const B = /** @type {Point} */ (sum(A, direction(rad(two - 90))));
  return linkage({ O: [0, 0], A, B }, ["OA", "AB"], "O");
}

/** Return the sample's four-bar at a crank angle [degrees], on the side of C that sample 18.15 draws. @param {number} angle @param {number} [side] -1 for the other side */
function fourBar(angle, side = 1) {
  const B = /** @type {Point} */ (scaled(L1, direction(rad(angle))));
  const C = /** @type {Point} */ (sum(B, scaled(L2, direction(closedForm(rad(angle), side)[0]))));
  return linkage({ A: [0, 0], B, C, D: [L4, 0] }, ["AB", "BC", "DC"], "AD");
}

/** Return the velocity of a body's point. @param {ReturnType<typeof linkage>} mechanism @param {number[]} twist @param {number} body @param {number[]} point */
function velocity({ pose }, twist, body, point) {
  const [x, y] = placed([0, 0, pose[3 * body + 2]], point);
  const [vx, vy, rate] = twist.slice(3 * body, 3 * body + 3);
  return [vx - rate * y, vy + rate * x];
}

/** Return a slider-crank with a crank of 0.3 m and a rod of 0.9 m; C slides on the x axis. @param {number} angle [degrees] */
function sliderCrank(angle) {
  const B = /** @type {Point} */ (scaled(0.3, direction(rad(angle))));
  const C = /** @type {Point} */ ([B[0] + Math.sqrt(0.81 - B[1] ** 2), 0]);
  return sliding(linkage({ A: [0, 0], B, C }, ["AB", "BC"], "A"), 1, [0.45, 0], 0);
}

/** Let a point of a body slide on a line through the origin at an angle [rad]. @param {ReturnType<typeof linkage>} mechanism
 * @param {number} second @param {number[]} secondPoint @param {number} line */
function sliding(mechanism, second, secondPoint, line) {
  const slot = { name: "slot", first: -1, second, firstPoint: [0, 0], secondPoint, line };
  return { ...mechanism, joints: [.../** @type {any[]} */ (mechanism.joints), slot] };
}

/** Return the instant centre of a body. @param {ReturnType<typeof linkage>} mechanism @param {number[]} twist @param {number} body */
function centreOf({ pose }, twist, body) {
  const [at, moving] = [pose, twist].map((flat) => /** @type {[number, number, number]} */ (flat.slice(3 * body, 3 * body + 3)));
  return instantCentre(at, moving) ?? [NaN, NaN];
}

/** Return the swing of a bar of 1 m and 2 kg that is released at a right angle to the vertical. */
function swing() {
  const bar = { ...linkage({ O: [0, 0], A: [1, 0] }, ["OA"], "O"), inertia: [2, 2, 2 / 12], gravity: [0, -9.81] };
  return motion(bar, 1000, 1e-3);
}

/** Return the solution of x' = rate(x) by the midpoint rule. @param {(x: number) => number} rate @param {number} x @param {number} time */
function integrated(rate, x, time) {
  const steps = 20_000;
  for (let step = 0; step < steps; step++) x += (time / steps) * rate(x + ((time / steps) * rate(x)) / 2);
  return x;
}

/** Return the arc of the contact for each radian; curvatures [1/m] are positive towards the material. @param {number} fixed @param {number} rolling */
const arcRate = (fixed, rolling) => 1 / (fixed + rolling);
const CURVE = 1 / (2.6 / Math.tan(0.4)); // curvature of the car's circle [1/m]
/** Return the rate of a trailer's bend [1/s] behind a car; the trailer is 3 m long. @param {number} speed @param {number} curve */
const bending = (speed, curve) => (/** @type {number} */ bend) => speed * (curve - Math.sin(bend) / 3);
const gearDistance = (/** @type {number} */ angle) => 0.75 / (1 + 0.5 * Math.cos(angle)); // from the focus, half axis 1 m and eccentricity 0.5
const gearRatio = (/** @type {number} */ angle) => gearDistance(angle) / (2 - gearDistance(angle));
const ladder = () => sliding(sliding(linkage({ A: [1, 0], B: [0, Math.sqrt(3)] }, ["AB"], ""), 0, [-1, 0], 0), 0, [1, 0], Math.PI / 2);

const TURNING = { angle: 0, rate: 3, acceleration: 0, speed: 2, push: 0, ahead: 0, left: 0 }; // the blade of a skate at constant rates
const PERSON = ["AB", "BH", "HS", "HK", "KE"];
/** @type {Record<string, Point>} */
const STANDING = { A: [0, 0], B: [0.1, 0.4], H: [0.25, 0.8], S: [0.2, 1.4], K: [0.4, 0.45], E: [0.5, 0], L: [0.4, 1.1], G: [0.7, 1.2] };

/** @type {Record<string, () => number>} */
export const ANSWERS = {
  tip_speed: () => {
    const links = pendulum(30, 60);
    const turning = rates(links, [[-1, 0, 2], [0, 1, -3]]); // the rate of the second link is relative to the first one
    return Math.hypot(...velocity(links, turning, 1, [0.5, 0]));
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
  rocker_angle: () => fourBar(180).pose[8],
  other_assembly: () => {
    const { pose } = fourBar(90, -1);
    return -placed([pose[6], pose[7], pose[8]], [L3 / 2, 0])[1];
  },
  dead_centre: () => zero((angle) => rates(fourBar(angle), [[-1, 0, 10]])[8], 30, 90),
  slider_place: () => {
    const { pose } = sliderCrank(60);
    return placed([pose[3], pose[4], pose[5]], [0.45, 0])[0];
  },
  slider_speed: () => {
    const mechanism = sliderCrank(60);
    return velocity(mechanism, rates(mechanism, [[-1, 0, 10]]), 1, [0.45, 0])[0];
  },
  rod_centre: () => {
    const mechanism = sliderCrank(60);
    return centreOf(mechanism, rates(mechanism, [[-1, 0, 10]]), 1)[1];
  },
  bottom_rate: () => Math.max(...swing().twist.filter((_, index) => index % 3 === 2).map(Math.abs)),
  bottom_force: () => Math.max(...swing().forces[0].force.filter((_, index) => index % 2 === 1)),
  tip_acceleration: () => {
    const [a, b] = [[30, 2, 1], [60, -1, 3]].map(([angle, rate, acceleration]) => ERRATA[28].of({ angle: rad(angle), rate, acceleration, length: 1 }).decides);
    return Math.hypot(a[0] + b[0], a[1] + b[1]);
  },
  speed_ahead: () => Math.hypot(2, 3 * 0.3),
  turning_acceleration: () => ERRATA[11].of(TURNING).decides[1],
  skated_aside: () => Array.from({ length: 20_000 }, () => ({ turn: 1e-4, slide: 5e-5 })).reduce((pose, { turn, slide }) =>
    moved(moved(pose, { turn: turn / 2, slide }), { turn: turn / 2, slide: 0 }), START)[1],
  turning_circle: () => 1 / CURVE,
  steady_bend: () => integrated(bending(1, CURVE), 0, 100),
  doubling_time: () => Math.LN2 / Math.log(integrated(bending(-1, 0), 1e-6, 1) / 1e-6),
  contact_on_circle: () => 3.5 * arcRate(1 / 0.5, 1 / 0.2),
  ellipse_curvature: () => (0.5 * 0.3) / 0.3 ** 3,
  conformal_acceleration: () => 2 ** 2 * arcRate(-1 / 0.3, 1 / 0.2),
  largest_ratio: () => gearRatio(Math.PI),
  gear_rate: () => (4 * 0.3) / (1 - 0.3),
  second_angle: () => {
    let sum = 0;
    for (let part = 0; part < 10_000; part++) sum += (gearRatio(((part + 0.5) * Math.PI) / 2 / 10_000) * Math.PI) / 2 / 10_000;
    return sum;
  },
  coupler_centre: () => centreOf(fourBar(90), rates(fourBar(90), [[-1, 0, 10]]), 1)[1],
  coupler_speed: () => Math.hypot(...velocity(fourBar(90), rates(fourBar(90), [[-1, 0, 10]]), 1, [0, 0])),
  ladder_centre: () => Math.hypot(...centreOf(ladder(), rates({ ...ladder() }, [[-1, 0, 1]]), 0)),
  rocker_rate: () => rates(fourBar(0), [[-1, 0, 10]])[8],
  ring_contact: () => ERRATA[4].of({ ...ERRATA[4].start, rate: 3, fixed: 0.5, rolling: 0.2 }).decides[0],
  terms_apart: () => {
    const { printed, decides } = ERRATA[11].of(TURNING);
    return Math.hypot(printed[0] - decides[0], printed[1] - decides[1]);
  },
  bar_up: () => ERRATA[28].of({ angle: rad(60), rate: -1, acceleration: 3, length: 1 }).decides[1],
};

/** Usual mistakes: the factor by which an answer is wrong, and the sentence about it. @type {[number, string][]} */
const MISTAKES = [
  [-1, "The size is right, the sign is not."],
  [2, "Not so: this is twice the answer."],
  [1 / 2, "Not so: this is half of the answer."],
  [180 / Math.PI, "Not so: this answer is in degrees."],
  [Math.PI / 180, "Not so: this answer is in radians."],
];

/** Return the sentence about an answer. @param {string} name @param {string} text that the reader typed */
export function verdict(name, text) {
  const given = Number(text.trim().replace(",", ".").replace("\u2212", "-") || NaN);
  const answer = ANSWERS[name]();
  const is = (/** @type {number} */ value) => Math.abs(given - value) <= CLOSE * Math.abs(value);
  if (Number.isNaN(given)) return "Give a number.";
  if (is(answer)) return `Right. The page computes ${Number(answer.toPrecision(5))}.`;
  return MISTAKES.find(([factor]) => is(factor * answer))?.[1] ?? "Not so. The solution is below.";
}

if (typeof document !== "undefined") {
  for (const form of document.querySelectorAll("form.exercise")) {
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      const place = form.querySelector(".verdict");
      if (form instanceof HTMLFormElement && place) place.textContent = verdict(form.dataset.answer ?? "", form.querySelector("input")?.value ?? "");
    });
  }
}
