// @ts-check
/** The exact motion of mechanisms with ideal pins, slots of the ground and drives.
 *
 * The Lagrange multipliers l solve M a = f + J' l and J a = -J. v. The integrator is the classical Runge-Kutta method with
 * a projection onto the joints after each step. tests/reports/test_site_in_browser.py compares it with the reference. */

import { placed } from "./motion.js";

/** @typedef {import("./motion.js").Joint} Joint */
/** @typedef {{inertia: number[], gravity: number[], pose: number[], twist: number[], joints: Joint[],
 *   drives: {first: number, second: number, rate: number}[]}} Mechanism inertia: m, m, I of each body [kg, kg m^2] */
/** @typedef {{columns: number[], gap: number, rate: number, bias: number}} Row one equation: J v = rate, J a = bias */

const STEP = 5e-4; // largest step [s]
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

/** Return the mechanism released at a pose: at rest, apart from drives. @param {Mechanism} mechanism @param {ArrayLike<number>} pose @returns {Mechanism} */
export function released(mechanism, pose) {
  const [place, twist] = [Float64Array.from(pose), new Float64Array(pose.length)];
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

/** Return poses and twists at `samples` intervals of `spacing` [s], and the forces of joints on their second bodies [N],
 * by steps of STEP / `finer` or less. @param {Mechanism} mechanism @param {number} samples @param {number} spacing @param {number} finer */
export function motion(mechanism, samples, spacing, finer = 1) {
  const width = mechanism.inertia.length;
  const pose = Float64Array.from(mechanism.pose);
  const twist = Float64Array.from(mechanism.twist);
  const start = offsetsOf(mechanism, pose);
  const offsets = (/** @type {number} */ t) => start.map((angle, index) => angle + mechanism.drives[index].rate * t);
  const out = { pose: new Float64Array((samples + 1) * width), twist: new Float64Array((samples + 1) * width), forces: mechanism.joints.map(({ name }) => ({ name, at: /** @type {number[]} */ ([]), force: /** @type {number[]} */ ([]) })) };
  const steps = finer * Math.ceil(spacing / STEP);
  const h = spacing / steps;
  const moved = (/** @type {Float64Array} */ from, /** @type {ArrayLike<number>} */ by, /** @type {number} */ time) => from.map((value, k) => value + time * by[k]);
  for (let sample = 0; sample <= samples; sample++) {
    for (let step = 0; sample && step < steps; step++) {
      const now = (sample - 1) * spacing + step * h;
      const at = (/** @type {Float64Array} */ q, /** @type {Float64Array} */ v) => acceleration(mechanism, q, v, start).change;
      const a1 = at(pose, twist);
      const v2 = moved(twist, a1, h / 2);
      const a2 = at(moved(pose, twist, h / 2), v2);
      const v3 = moved(twist, a2, h / 2);
      const a3 = at(moved(pose, v2, h / 2), v3);
      const v4 = moved(twist, a3, h);
      const a4 = at(moved(pose, v3, h), v4);
      for (let k = 0; k < width; k++) {
        pose[k] += (h / 6) * (twist[k] + 2 * v2[k] + 2 * v3[k] + v4[k]);
        twist[k] += (h / 6) * (a1[k] + 2 * a2[k] + 2 * a3[k] + a4[k]);
      }
      close(mechanism, pose, offsets(now + h), ROUNDS - 1);
      steer(mechanism, pose, twist, offsets(now + h));
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
