// @ts-check
/** The exact motion of mechanisms with ideal pins, slots of the ground and drives.
 *
 * The Lagrange multipliers l solve M a = f + J' l and J a = -J. v. The integrator is the extrapolated midpoint method of
 * Gragg, Bulirsch and Stoer, with a projection onto the joints after each step. A mechanism whose drives prescribe the
 * whole motion is not integrated: Newton's method solves its joints at each sample.
 * tests/reports/test_engines_in_browser.py compares both with the reference. */

import { placed } from "./motion.js";

/** @typedef {import("./motion.js").Joint} Joint */
/** @typedef {{inertia: number[], gravity: number[], pose: number[], twist: number[], joints: Joint[],
 *   drives: {first: number, second: number, rate: number}[]}} Mechanism inertia: m, m, I of each body [kg, kg m^2] */
/** @typedef {{columns: number[], gap: number, rate: number, bias: number}} Row one equation: J v = rate, J a = bias */

export const FINE = 1e-12; // accepted error of the last but one column of an extrapolation, relative to the state
export const ROUGH = 1e-10; // the same for the motion that checks the fine one
const COLUMNS = 8; // largest number of columns of an extrapolation; the midpoint method takes 2, 4, 6, ... steps
const SHORTEST = 2 ** -12; // smallest fraction of a sample interval; shorter steps do not help near a singular position
const ROUNDS = 3; // number of Newton iterations that close the joints after a step

/** Return the vector from the centre of a body to its point, in world directions; for the ground the point itself. @param {ArrayLike<number>} pose @param {number} body @param {number[]} point */
function arm(pose, body, point) {
  return body < 0 ? [0, 0] : placed([0, 0, pose[3 * body + 2]], point);
}

/** Return the equations of all joints at a pose. @param {Pick<Mechanism, "joints"|"drives">} mechanism @param {ArrayLike<number>} pose
 * @param {ArrayLike<number>} twist @param {number[]|null} offsets of drives [rad]; null: without drives @returns {Row[]} */
export function rows(mechanism, pose, twist, offsets) {
  const width = pose.length;
  const found = [];
  for (const { first, second, firstPoint, secondPoint, line } of mechanism.joints) {
    const [a, b] = [arm(pose, first, firstPoint), arm(pose, second, secondPoint)];
    const place = (/** @type {number} */ body, /** @type {number[]} */ own, /** @type {number[]} */ point, /** @type {0|1} */ axis) =>
      body < 0 ? point[axis] : pose[3 * body + axis] + own[axis];
    const directions = line === null ? [[1, 0], [0, 1]] : [[-Math.sin(line), Math.cos(line)]];
    for (const [nx, ny] of directions) {
      const columns = new Array(width).fill(0);
      let gap = 0;
      let bias = 0;
      for (const [body, own, point, sign] of /** @type {[number, number[], number[], number][]} */ ([[first, a, firstPoint, -1], [second, b, secondPoint, 1]])) {
        gap += sign * (nx * place(body, own, point, 0) + ny * place(body, own, point, 1));
        if (body < 0) continue;
        columns[3 * body] += sign * nx;
        columns[3 * body + 1] += sign * ny;
        columns[3 * body + 2] += sign * (ny * own[0] - nx * own[1]);
        bias += sign * twist[3 * body + 2] ** 2 * (nx * own[0] + ny * own[1]);
      }
      found.push({ columns, gap, rate: 0, bias });
    }
  }
  const angles = offsetsOf(mechanism, pose);
  (offsets ? mechanism.drives : []).forEach(({ first, second, rate }, index) => {
    const columns = new Array(width).fill(0);
    if (first >= 0) columns[3 * first + 2] = -1;
    if (second >= 0) columns[3 * second + 2] = 1;
    found.push({ columns, gap: angles[index] - (offsets?.[index] ?? 0), rate, bias: 0 });
  });
  return found;
}

/** Solve J W J' l + c l = right by Cholesky's method. Returns the change W J' l. @param {Row[]} equations @param {number[]} weights
 * the inverse of the metric @param {number[]} right @param {number[]} [soft] c of each row */
function pushed(equations, weights, right, soft) {
  const size = equations.length;
  const low = equations.map(() => new Float64Array(size));
  const forces = new Float64Array(size);
  for (let i = 0; i < size; i++) {
    for (let j = 0; j <= i; j++) {
      let sum = i === j ? (soft?.[i] ?? 0) : 0;
      for (let k = 0; k < weights.length; k++) sum += equations[i].columns[k] * weights[k] * equations[j].columns[k];
      for (let k = 0; k < j; k++) sum -= low[i][k] * low[j][k];
      low[i][j] = i === j ? Math.sqrt(sum) : sum / low[j][j];
    }
    let sum = right[i];
    for (let k = 0; k < i; k++) sum -= low[i][k] * forces[k];
    forces[i] = sum / low[i][i];
  }
  for (let i = size - 1; i >= 0; i--) {
    for (let k = i + 1; k < size; k++) forces[i] -= low[k][i] * forces[k];
    forces[i] /= low[i][i];
  }
  return { forces, change: weights.map((weight, k) => weight * equations.reduce((sum, { columns }, i) => sum + columns[k] * forces[i], 0)) };
}

/** @param {Mechanism} mechanism */
const inverse = ({ inertia }) => inertia.map((value) => 1 / value);

/** Project a pose onto the joints. @param {Mechanism} mechanism @param {Float64Array} pose @param {number[]|null} offsets @param {number} rounds */
function close(mechanism, pose, offsets, rounds) {
  for (let round = 0; round < rounds; round++) {
    const equations = rows(mechanism, pose, pose, offsets);
    pushed(equations, inverse(mechanism), equations.map(({ gap }) => -gap)).change.forEach((by, k) => (pose[k] += by));
  }
}

/** Project velocities onto the joints. @param {Mechanism} mechanism @param {Float64Array} pose @param {Float64Array} twist @param {number[]} offsets */
function steer(mechanism, pose, twist, offsets) {
  const equations = rows(mechanism, pose, twist, offsets);
  const right = equations.map(({ columns, rate }) => rate - columns.reduce((sum, value, k) => sum + value * twist[k], 0));
  pushed(equations, inverse(mechanism), right).change.forEach((by, k) => (twist[k] += by));
}

/** @param {Mechanism} mechanism @param {Float64Array} pose @param {Float64Array} twist @param {number[]} offsets */
function acceleration(mechanism, pose, twist, offsets) {
  const equations = rows(mechanism, pose, twist, offsets);
  const free = mechanism.inertia.map((_, k) => (k % 3 < 2 ? mechanism.gravity[k % 3] : 0));
  const right = equations.map(({ columns, bias }) => bias - columns.reduce((sum, value, k) => sum + value * free[k], 0));
  const { forces, change } = pushed(equations, inverse(mechanism), right);
  return { forces, change: change.map((by, k) => free[k] + by) };
}

/** Drag a point of a body towards a place: return the nearest pose on the present branch, without drives.
 * @param {Mechanism} mechanism @param {ArrayLike<number>} pose @param {number} body @param {number[]} point @param {number[]} wanted */
export function dragged(mechanism, pose, body, point, wanted) {
  const found = Float64Array.from(pose);
  const size = Math.hypot(...mechanism.joints.flatMap(({ firstPoint, secondPoint }) => [...firstPoint, ...secondPoint]));
  const weights = mechanism.inertia.map((_, k) => (k % 3 < 2 ? 1 : 1 / size ** 2));
  for (let round = 0; round < 12; round++) {
    const equations = rows(mechanism, found, found, null);
    const fixed = equations.length;
    const own = arm(found, body, point);
    // Short steps keep the pose on its branch.
    const away = [wanted[0] - found[3 * body] - own[0], wanted[1] - found[3 * body + 1] - own[1]];
    const shorter = Math.min(1, (0.1 * size) / (Math.hypot(...away) || 1));
    for (const axis of [0, 1]) {
      const columns = new Array(found.length).fill(0);
      columns[3 * body + axis] = 1;
      columns[3 * body + 2] = axis ? own[0] : -own[1];
      equations.push({ columns, gap: -away[axis] * shorter, rate: 0, bias: 0 });
    }
    const soft = equations.map((_, index) => (index < fixed ? 0 : 0.3));
    pushed(equations, weights, equations.map(({ gap }) => -gap), soft).change.forEach((by, k) => (found[k] += by));
  }
  close(mechanism, found, null, ROUNDS);
  return rows(mechanism, found, found, null).every(({ gap }) => Math.abs(gap) < 1e-9 * size) ? found : Float64Array.from(pose);
}

/** Return the mechanism released at the nearest pose with closed joints: at rest, apart from drives. Without such a pose the
 * mechanism keeps its own start. @param {Mechanism} mechanism @param {ArrayLike<number>} pose @returns {Mechanism} */
export function released(mechanism, pose) {
  const [place, twist] = [Float64Array.from(pose), new Float64Array(pose.length)];
  if (pose.length !== mechanism.pose.length) return mechanism;
  close(mechanism, place, null, 4 * ROUNDS);
  if (!rows(mechanism, place, place, null).every(({ gap }) => Math.abs(gap) < 1e-9)) return mechanism;
  const offsets = offsetsOf(mechanism, place);
  steer(mechanism, place, twist, offsets);
  return { ...mechanism, pose: [...place], twist: [...twist] };
}

/** Return the relative angles of drives at a pose. @param {Pick<Mechanism, "drives">} mechanism @param {ArrayLike<number>} pose */
function offsetsOf({ drives }, pose) {
  const angle = (/** @type {number} */ body) => (body < 0 ? 0 : pose[3 * body + 2]);
  return drives.map(({ first, second }) => angle(second) - angle(first));
}

/** Return the twists of a mechanism at rest or driven: drives as [first, second, rate].
 * @param {Mechanism} mechanism @param {[number, number, number][]} drives */
export function rates(mechanism, drives) {
  return released({ ...mechanism, drives: drives.map(([first, second, rate]) => ({ first, second, rate })) }, mechanism.pose).twist;
}

/** Return the number of degrees of freedom without drives, from the rank of the equations. @param {Mechanism} mechanism */
export function freedoms(mechanism) {
  const left = rows(mechanism, mechanism.pose, mechanism.twist, null).map(({ columns }) => columns);
  let rank = 0;
  for (let column = 0; column < mechanism.pose.length; column++) {
    const pivot = left.slice(rank).reduce((best, row) => (Math.abs(row[column]) > Math.abs(best[column]) ? row : best), left[rank] ?? []);
    if (!(Math.abs(pivot[column]) > 1e-9)) continue;
    left.splice(left.indexOf(pivot), 1);
    left.splice(rank++, 0, pivot);
    for (const row of left.slice(rank)) {
      const share = row[column] / pivot[column];
      row.forEach((value, k) => (row[k] = value - share * pivot[k]));
    }
  }
  return mechanism.pose.length - rank;
}

/** Advance a pose and a twist, by one extrapolation; false if it did not converge to `tolerance`.
 * @param {Mechanism} mechanism @param {Float64Array} pose @param {Float64Array} twist @param {number[]} start @param {number} time [s] @param {number} tolerance */
function extrapolate(mechanism, pose, twist, start, time, tolerance) {
  const width = pose.length;
  const state = Float64Array.of(...pose, ...twist);
  const rates = (/** @type {Float64Array} */ at) => {
    const found = new Float64Array(2 * width);
    found.set(at.subarray(width));
    found.set(acceleration(mechanism, at.subarray(0, width), at.subarray(width), start).change, width);
    return found;
  };
  const first = rates(state);
  const scale = Math.max(1, ...state.map(Math.abs));
  /** @type {Float64Array[]} */
  let row = [];
  for (let column = 0; column < COLUMNS; column++) {
    const steps = 2 * (column + 1);
    const h = time / steps;
    let [old, now] = [state, state.map((value, k) => value + h * first[k])];
    for (let step = 1; step < steps; step++) {
      const by = rates(now);
      [old, now] = [now, old.map((value, k) => value + 2 * h * by[k])];
    }
    const by = rates(now);
    const next = [now.map((value, k) => (value + old[k] + h * by[k]) / 2)];
    for (let k = 0; k < column; k++) {
      const ratio = (steps / (2 * (column - k))) ** 2 - 1;
      next.push(next[k].map((value, index) => value + (value - row[k][index]) / ratio));
    }
    row = next;
    if (column && Math.max(...row[column].map((value, k) => Math.abs(value - row[column - 1][k]))) <= tolerance * scale) {
      pose.set(row[column].subarray(0, width));
      twist.set(row[column].subarray(width));
      return true;
    }
  }
  return false;
}

/** Return poses and twists at `samples` intervals of `spacing` [s], and the forces of joints on their second bodies [N].
 * @param {Mechanism} mechanism @param {number} samples @param {number} spacing @param {number} tolerance */
export function motion(mechanism, samples, spacing, tolerance = FINE) {
  const width = mechanism.inertia.length;
  const pose = Float64Array.from(mechanism.pose);
  const twist = Float64Array.from(mechanism.twist);
  const start = offsetsOf(mechanism, pose);
  const offsets = (/** @type {number} */ t) => start.map((angle, index) => angle + mechanism.drives[index].rate * t);
  const prescribed = rows(mechanism, pose, twist, start).length === width;
  const out = { pose: new Float64Array((samples + 1) * width), twist: new Float64Array((samples + 1) * width), forces: mechanism.joints.map(({ name }) => ({ name, at: /** @type {number[]} */ ([]), force: /** @type {number[]} */ ([]) })) };
  let part = 1; // step as a fraction of `spacing`
  for (let sample = 0; sample <= samples; sample++) {
    for (let done = sample ? 0 : 1; done < 1; ) {
      const by = (prescribed ? (tolerance > FINE ? 0.5 : 0.25) : part) * spacing;
      if (prescribed) {
        const { change } = acceleration(mechanism, pose, twist, start);
        pose.forEach((value, k) => (pose[k] = value + by * twist[k] + 0.5 * by * by * change[k]));
      } else if (!extrapolate(mechanism, pose, twist, start, by, part > SHORTEST ? tolerance : Infinity)) {
        part /= 2;
        continue;
      }
      done += by / spacing;
      const now = offsets((sample - 1 + done) * spacing);
      close(mechanism, pose, now, prescribed ? 2 * ROUNDS : ROUNDS - 1);
      steer(mechanism, pose, twist, now);
      if (done % (2 * part) === 0) part = Math.min(1, 2 * part);
    }
    out.pose.set(pose, sample * width);
    out.twist.set(twist, sample * width);
    const { forces } = acceleration(mechanism, pose, twist, start);
    let row = 0;
    mechanism.joints.forEach(({ second, secondPoint, line }, index) => {
      out.forces[index].at.push(...placed([...pose.subarray(3 * second, 3 * second + 3)], secondPoint));
      out.forces[index].force.push(...(line === null ? [forces[row], forces[row + 1]] : [-Math.sin(line) * forces[row], Math.cos(line) * forces[row]]));
      row += line === null ? 2 : 1;
    });
  }
  return out;
}
