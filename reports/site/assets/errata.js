// @ts-check
/** Formulas of the chapter as printed and as they must be, and the derivative of a known motion, which decides. The reader
 * chooses the numbers of the motion. tests/reports/test_exercises.py compares the numbers with those of the reference. */

import { placed } from "./motion.js";
import { beginAll, remembered } from "./widget.js";

/** @typedef {Record<string, number>} Numbers
 * @typedef {{printed: number[], right: number[], decides: number[]}} Versions
 * @typedef {(t: number) => number[]} Motion */

const SPACING = 0.02; // of the points of a difference [s]; with it, differences of order eight have an error of 1e-12
const WEIGHTS = [[3, -32, 168, -672, 0, 672, -168, 32, -3].map((each) => each / 840), [-9, 128, -1008, 8064, -14350, 8064, -1008, 128, -9].map((each) => each / 5040)];
export const [L1, L2, L3, L4] = [0.4, 0.4 * Math.SQRT2, 0.8 * Math.SQRT2, 1.2]; // sample 18.15 [m]

/** Return the first or the second derivative at t = 0. @param {Motion} motion @param {number} [order] */
const derivative = (motion, order = 1) => motion(0).map((_, axis) =>
  WEIGHTS[order - 1].reduce((sum, weight, k) => sum + weight * motion((k - 4) * SPACING)[axis], 0) / SPACING ** order);
const across = (/** @type {number[]} */ [x, y]) => [-y, x];
export const scaled = (/** @type {number} */ by, /** @type {number[]} */ vector) => vector.map((each) => by * each);
export const sum = (/** @type {number[][]} */ ...vectors) => vectors[0].map((_, axis) => vectors.reduce((total, vector) => total + vector[axis], 0));
export const direction = (/** @type {number} */ angle) => [Math.cos(angle), Math.sin(angle)];
const angleAt = (/** @type {Numbers} */ { angle, rate, acceleration }, /** @type {number} */ t) => angle + rate * t + (acceleration * t * t) / 2;

/** A circle of radius `rolling` rolls on a circle of radius `fixed`: the place of the body's point `at` [m]. @param {Numbers} numbers @param {number[]} at @returns {Motion} */
const onCircle = (numbers, at) => (t) => {
  const angle = angleAt(numbers, t);
  const [x, y] = scaled(numbers.fixed + numbers.rolling, direction((angle * numbers.rolling) / (numbers.fixed + numbers.rolling)));
  return placed([x, y, angle], at);
};

/** Return the acceleration of a bar's end in problem 18.5.2: of three formulas with a slip, of the right one and of the motion. @param {Numbers} numbers */
function bar(numbers) {
  const { angle, rate, acceleration, length } = numbers;
  const end = (/** @type {number} */ t) => scaled(length, [Math.sin(angleAt(numbers, t)), -Math.cos(angleAt(numbers, t))]);
  const [c, s] = direction(angle);
  const of = (/** @type {number} */ first) => scaled(length, [first * c - rate * rate * s, first * s + rate * rate * c]);
  return { first: of(rate), second: [of(rate)[0], of(acceleration)[1]],
    third: [of(acceleration)[0], length * (rate * rate * s + acceleration * c)], right: of(acceleration), decides: derivative(end, 2) };
}

/** Return the place between `low` and `high` at which a function changes its sign. @param {(place: number) => number} of @param {number} low @param {number} high */
export function zero(of, low, high) {
  const positive = of(low) > 0;
  for (let round = 0; round < 60; round++) {
    const middle = (low + high) / 2;
    if (of(middle) > 0 === positive) low = middle;
    else high = middle;
  }
  return low;
}

/** Return beta' and phi' of (18.70) and (18.71) for a unit rate of the crank. @param {number} theta @param {number[]} angles */
const fourBarRates = (theta, [beta, phi]) => [(L1 * Math.sin(phi - theta)) / (L2 * Math.sin(beta - phi)), (L1 * Math.sin(beta - theta)) / (L3 * Math.sin(beta - phi))];

/** Integrate the printed rates from the start of sample 18.15 by Euler's method. @param {number} theta @param {number} steps for each turn */
function integrated(theta, steps) {
  let angles = [Math.PI / 4, (3 * Math.PI) / 4];
  const start = Math.PI / 2;
  const count = Math.max(1, Math.round((steps * (theta - start)) / (2 * Math.PI)));
  const step = (theta - start) / count;
  for (let k = 0; k < count; k++) angles = sum(angles, scaled(step, fourBarRates(start + k * step, angles)));
  return angles;
}

/** Return beta and phi in closed form; side: 1 if C is on the left of the line from B to D, else -1. @param {number} theta @param {number} side */
export function closedForm(theta, side) {
  const [bx, by] = scaled(L1, direction(theta));
  const d = Math.hypot(L4 - bx, by);
  const beta = Math.atan2(-by, L4 - bx) + side * Math.acos((d * d + L2 * L2 - L3 * L3) / (2 * d * L2));
  return [beta, phiOf(theta, beta)];
}
const phiOf = (/** @type {number} */ theta, /** @type {number} */ beta) =>
  Math.atan2(L1 * Math.sin(theta) + L2 * Math.sin(beta), L1 * Math.cos(theta) + L2 * Math.cos(beta) - L4);

/** Return beta and phi of both assemblies, by bisection of the length of the bar CD; the first one has C on the left of the
 * line from B to D. @param {number} theta */
function assemblies(theta) {
  const miss = (/** @type {number} */ beta) => Math.hypot(L1 * Math.cos(theta) + L2 * Math.cos(beta) - L4, L1 * Math.sin(theta) + L2 * Math.sin(beta)) - L3;
  const found = [];
  for (let k = 0; k < 360; k++) {
    const [low, high] = [k, k + 1].map((degree) => ((degree - 180) * Math.PI) / 180);
    if (miss(low) > 0 === miss(high) > 0) continue;
    const beta = zero(miss, low, high);
    found.push([beta, phiOf(theta, beta)]);
  }
  const toD = Math.atan2(-L1 * Math.sin(theta), L4 - L1 * Math.cos(theta));
  return found.sort(([a], [b]) => Math.sin(b - toD) - Math.sin(a - toD));
}

const SAMPLE = { theta: 2 + 2 * Math.PI, steps: 200 };
const ROLLING = { angle: 0.7, rate: 1.7, acceleration: -0.6, fixed: 0.8, rolling: 0.5 };
const SKATE = { angle: 0.7, rate: 1.7, acceleration: -0.6, speed: 1.3, push: 0.4, ahead: 0.35, left: -0.2 };
const FIRST = { angle: 0.4, rate: 2, acceleration: -5, length: 0.7 };
const SECOND = { angle: -1.1, rate: 3, acceleration: 0.6, length: 0.7 };

/** The versions of each formula by its number on the page of errata, with the numbers of the motion at the start.
 * @type {Record<string, {start: Numbers, of: (numbers: Numbers) => Versions}>} */
export const ERRATA = {
  1: { start: ROLLING, of(numbers) {
    const { angle, rate, fixed, rolling } = numbers;
    const at = (angle * rolling) / (fixed + rolling);
    const tangent = across(direction(at));
    const contact = (/** @type {number} */ t) => scaled(fixed, direction((angleAt(numbers, t) * rolling) / (fixed + rolling)));
    return { printed: scaled(fixed * at, tangent), right: scaled(rate / (1 / fixed + 1 / rolling), tangent), decides: derivative(contact) };
  } },
  2: { start: ROLLING, of(numbers) {
    const speed = (/** @type {number[]} */ arm) => derivative(onCircle(numbers, placed([0, 0, -numbers.angle], arm)));
    const centre = onCircle(numbers, [0, 0])(0);
    return { printed: speed(scaled(-1, centre)), right: speed(scaled(1 / numbers.rate, across(speed([0, 0])))), decides: [0, 0] };
  } },
  4: { start: { ...ROLLING, rolling: 0.3 }, of(numbers) {
    const { rate, fixed, rolling } = numbers;
    const contact = (/** @type {number} */ t) => scaled(fixed, direction((-angleAt(numbers, t) * rolling) / (fixed - rolling)));
    return { printed: [rate / (1 / fixed + 1 / rolling)], right: [rate / (1 / rolling - 1 / fixed)], decides: [Math.hypot(...derivative(contact))] };
  } },
  11: { start: SKATE, of: (numbers) => skate(numbers, scaled(-numbers.speed * numbers.rate, direction(numbers.angle))) },
  "2 v": { start: SKATE, of: (numbers) => skate(numbers, scaled(2 * numbers.speed * numbers.rate, across(direction(numbers.angle)))) },
  19: { start: SAMPLE, of: ({ theta, steps }) => ({ printed: integrated(theta, steps), right: closedForm(theta, 1), decides: assemblies(theta)[0] }) },
  "all angles": { start: { theta: Math.PI / 2 }, of: ({ theta }) => ({
    printed: [closedForm(theta, 1)[1]], right: [1, -1].map((side) => closedForm(theta, side)[1]), decides: assemblies(theta).map(([, phi]) => phi),
  }) },
  23: { start: FIRST, of: (numbers) => ({ ...bar(numbers), printed: bar(numbers).first }) },
  24: { start: FIRST, of: (numbers) => ({ printed: [numbers.rate], right: [numbers.acceleration], decides: derivative((t) => [angleAt(numbers, t)], 2) }) },
  25: { start: SECOND, of: (numbers) => ({ ...bar(numbers), printed: bar(numbers).first }) },
  26: { start: SECOND, of: (numbers) => ({ ...bar(numbers), printed: bar(numbers).first }) },
  27: { start: SECOND, of: (numbers) => ({ ...bar(numbers), printed: bar(numbers).second }) },
  28: { start: SECOND, of: (numbers) => ({ ...bar(numbers), printed: bar(numbers).third }) },
};

/** Return the acceleration of G with a given term for the turning of v_C, with the right term, and of the motion. @param {Numbers} numbers @param {number[]} term @returns {Versions} */
function skate(numbers, term) {
  const { angle, rate, acceleration, speed, push, ahead, left } = numbers;
  const arm = (/** @type {number} */ heading) => placed([0, 0, heading], [ahead, left]);
  const velocity = (/** @type {number} */ t) =>
    sum(scaled(speed + push * t, direction(angleAt(numbers, t))), scaled(rate + acceleration * t, across(arm(angleAt(numbers, t)))));
  const along = direction(angle);
  const rest = sum(scaled(push, along), scaled(acceleration, across(arm(angle))), scaled(-rate * rate, arm(angle)));
  return { printed: sum(rest, term), right: sum(rest, scaled(speed * rate, across(along))), decides: derivative(velocity) };
}

/** @type {Record<string, [string, number, number]>} label, least and largest value of a number that the reader chooses */
const SLIDERS = {
  angle: ["angle [rad]", -3, 3], rate: ["turning rate [rad/s]", 0.5, 5], acceleration: ["angular acceleration [rad/s²]", -5, 5],
  speed: ["speed of the blade [m/s]", 0.1, 3], theta: ["crank angle θ [rad]", 1, 13], steps: ["steps of Euler's method in a turn", 20, 2000],
};
const rounded = (/** @type {number} */ value) => String(Number(value.toPrecision(3)));
const written = (/** @type {number[]} */ values) => {
  const texts = values.map((value) => (Math.abs(value) < 5e-4 ? "0" : value.toFixed(3)));
  return texts.length > 1 ? `(${texts.join(", ")})` : texts[0];
};

/** Fill the tables of a part with numbers: the first cell of a row has the number of an erratum, and its code elements
 * have the values as printed, as they must be, and as the motion decides. @param {Element} part @param {Numbers} chosen */
function fill(part, chosen) {
  for (const row of part.querySelectorAll("tbody tr")) {
    const erratum = ERRATA[row.firstElementChild?.textContent ?? ""];
    if (!erratum) continue;
    const { printed, right, decides } = erratum.of({ ...erratum.start, ...chosen });
    [printed, right, decides].forEach((values, index) => (row.querySelectorAll("code")[index].textContent = written(values)));
  }
}

/** @param {HTMLElement} place */
function begin(place) {
  const part = /** @type {Element} */ (place.closest(".part"));
  const known = [...part.querySelectorAll("tbody tr")].flatMap((row) => ERRATA[row.firstElementChild?.textContent ?? ""] ?? []);
  /** @type {Numbers} */
  const chosen = {};
  part.querySelector(".why")?.append(place); // the tables are there
  const names = Object.keys(SLIDERS).filter((name) => known.some(({ start }) => name in start));
  place.innerHTML = `<div class="controls">${names.map((name) => {
    const [words, least, most] = SLIDERS[name];
    const value = known.find(({ start }) => name in start)?.start[name];
    return `<label class="time">${words} <input type="range" name="${name}" min="${least}" max="${most}" step="any" value="${value}"> <output>${rounded(Number(value))}</output></label>`;
  }).join("")}</div>`;
  const inputs = [...place.querySelectorAll("input")];
  for (const input of inputs) {
    input.addEventListener("change", () => keep(inputs.map(({ value }) => Number(value))));
    input.addEventListener("input", () => {
      chosen[input.name] = Number(input.value);
      /** @type {HTMLElement} */ (input.nextElementSibling).textContent = rounded(Number(input.value));
      fill(part, chosen);
    });
  }
  fill(part, chosen);
  const keep = remembered(place, (numbers) => inputs.forEach((input, index) => {
    input.value = String(numbers[index]);
    input.dispatchEvent(new Event("input"));
  }));
}

beginAll("errata", begin);
