// @ts-check
/** Numbers of a motion that a lesson shows beside its errors; reports/site/lesson.py describes them. */

import { ends, grouped, instantCentre, poseAt, formatNumber, UNITS } from "./motion.js";

/** @typedef {{kind: "gap"|"rates"|"bend"|"centre"|"contact"|"energy"|"friction", words: string, bodies: number[]}} Quantity
 * @typedef {{pose: ArrayLike<number>, twist: ArrayLike<number>}} States
 * @typedef {{t: ArrayLike<number>, bodies: number, window: number[], joints: import("./motion.js").Joint[],
 *   forces: import("./motion.js").Force[]|null, exact: States, inertia: number[], gravity: number[]}} Run
 * @typedef {number[]|null} Found one number, or the least and the largest one */

/** Return a quantity of one motion; null for a motion without it. @param {Quantity} quantity @param {Run} run @param {States} states @returns {Found} */
export function measured({ kind, bodies }, run, states) {
  const { t, bodies: count, exact, window: [first, last] } = run;
  const frames = Array.from({ length: last - first + 1 }, (_, index) => first + index);
  const angle = (/** @type {number} */ body, /** @type {number} */ frame) => poseAt(states.pose, count, frame, body)[2];
  const rate = (/** @type {number} */ frame) => Math.abs(poseAt(states.twist, count, frame, bodies[0])[2]);
  switch (kind) {
    case "gap": {
      const gaps = run.joints.flatMap((joint) => frames.map((frame) => {
        const [[ax, ay], [bx, by]] = ends(joint, states.pose, count, frame);
        return Math.hypot(bx - ax, by - ay);
      }));
      return states === exact ? null : [gaps.reduce((a, b) => Math.max(a, b), 0)];
    }
    case "rates":
      return [frames.reduce((a, frame) => Math.min(a, rate(frame)), Infinity), frames.reduce((a, frame) => Math.max(a, rate(frame)), 0)];
    case "bend": {
      const bend = (/** @type {number} */ frame) => Math.abs(angle(bodies[1], frame) - angle(bodies[0], frame));
      const after = frames.find((frame) => frame > first && bend(frame) >= 1);
      if (after === undefined) return null;
      const [low, high] = [bend(after - 1), bend(after)];
      return [t[after - 1] + ((1 - low) / (high - low)) * (t[after] - t[after - 1])];
    }
    case "centre": {
      const centre = (/** @type {States} */ { pose, twist }, /** @type {number} */ frame) => instantCentre(poseAt(pose, count, frame, bodies[0]), poseAt(twist, count, frame, bodies[0]));
      const apart = frames.flatMap((frame) => {
        const [own, right] = [centre(states, frame), centre(exact, frame)];
        return own && right ? [Math.hypot(own[0] - right[0], own[1] - right[1])] : [];
      }).sort((a, b) => a - b);
      return states === exact ? null : [apart[Math.floor(apart.length / 2)]];
    }
    case "energy": {
      const energy = (/** @type {number} */ frame) => run.inertia.reduce((sum, inertia, k) => {
        const [place, rate] = [states.pose, states.twist].map((all) => all[run.inertia.length * frame + k]);
        return sum + inertia * (rate * rate / 2 - (run.gravity[k % 3] ?? 0) * place);
      }, 0);
      return [energy(last) - energy(0)];
    }
    case "friction": {
      const ratios = run.forces?.flatMap(({ friction }) => friction ?? []) ?? [];
      return states === exact && ratios.length ? [Math.max(...ratios.map((ratio) => ratio ?? Infinity))] : null;
    }
    case "contact": {
      const at = run.forces?.find(({ contact }) => contact)?.at;
      if (states !== exact || !at) return null;
      const pins = run.joints.filter(({ first: body, line }) => body < 0 && line === null).map(({ firstPoint }) => firstPoint);
      const sums = frames.map((frame) => pins.reduce((sum, [x, y]) => sum + Math.hypot((at[2 * frame] ?? NaN) - x, (at[2 * frame + 1] ?? NaN) - y), 0));
      return [Math.max(...sums) - Math.min(...sums)];
    }
  }
}

const QUANTITY_UNITS = { gap: "m", rates: "rad/s", bend: "s", centre: "m", contact: "m", energy: "J", friction: "" };

/** Return a quantity as text. @param {Quantity["kind"]} kind @param {Found|undefined} found */
function worded(kind, found) {
  if (!found) return kind === "bend" ? "never" : "–";
  return `${found.map(formatNumber).join(" to ")} ${QUANTITY_UNITS[kind]}`;
}

/** @param {any} answer @param {string} name @returns {number|undefined} */
const errorOf = (answer, name) => answer?.motions.find((/** @type {any} */ each) => each.name === name)?.error;

/** Return the error and the quantities of one motion, compared with those before. @param {string} name @param {any} answer @param {any} before */
export function cell(name, answer, before) {
  const unit = UNITS[/** @type {"angle"|"position"} */ (answer.measure)];
  const [error, old] = [answer, before].map((each) => errorOf(each, name));
  const missing = name === "exact" ? [] : [name in answer.lost ? "cannot be run here" : "–"];
  const errors = error === undefined ? missing : [`${formatNumber(error)}${Number.isFinite(error) ? ` ${unit}` : ""}${ratio(error, old)}`];
  const numbers = answer.quantities.filter((/** @type {any} */ each) => each.found[name] !== undefined && (each.found[name] || each.kind === "bend"));
  return [...errors, ...numbers.map((/** @type {any} */ each) => `${each.words} ${worded(each.kind, each.found[name])}`)].join("; ");
}

/** @param {number} error @param {number|undefined} old */
function ratio(error, old) {
  if (old === undefined || !(old > 0) || !(error > 0)) return "";
  const by = Math.max(error / old, old / error);
  const times = grouped(Number(by.toPrecision(2)));
  return by < 1.05 ? ", as before" : `, ${times} times ${error > old ? "as large" : "smaller"}`;
}

/** Return what a wrong answer predicts. @param {string} name @param {number|undefined} times @param {any} before @param {string|undefined} of */
export function expected(name, times, before, of) {
  if (times === undefined) return "";
  const quantity = before.quantities.find((/** @type {any} */ { kind }) => kind === of);
  if (quantity) return `${quantity.words} ${worded(quantity.kind, quantity.found[name]?.map((/** @type {number} */ value) => value * times))}`;
  const old = errorOf(before, name);
  return old === undefined ? "" : `about ${formatNumber(old * times)} ${UNITS[/** @type {"angle"|"position"} */ (before.measure)]}`;
}
