// @ts-check
/** The models of the engines at a place of the sliders, from the tables that the site was built with; and the truth. */

/**
 * @typedef {{crank: number, coupler: number, ratio: number, speed: number, steps: number, every: number,
 *   integrator: number, timeConstant: number, impedance: number, solverIterations: number, tolerance: number,
 *   iterations: number, bias: number, free: boolean}} Setting
 * @typedef {{samples: number, duration: number, mjcf: string[], numbers: string[], start: number[][],
 *   meanInertia: number[], munk: number[][], masses: number[][], truth?: number[]}} Table
 * @typedef {{cranks: number[], couplers: number[], ratios: number[], bodies: string[],
 *   lengths: {rocker: number, ground: number[], start: number, rate: number},
 *   options: {gravity: number[], disableflags: number, jacobian: number},
 *   joints: {name: string, first: number, second: number, ends: (number|null)[]}[],
 *   links: {body: number, parent: number|null, column: number}[], driven: Table, free: Table}} Live
 */

const BODY = 11; // numbers of a body of Munk2D, see live.py

/** Where the tables have this place of the sliders. @param {Live} live @param {Setting} setting */
export function placeOf(live, setting) {
  if (setting.free) return 0;
  return (setting.crank * live.couplers.length + setting.coupler) * live.ratios.length + setting.ratio;
}

/** @param {Live} live @param {Setting} setting @returns {Table} */
export function tableOf(live, setting) {
  return setting.free ? live.free : live.driven;
}

/** How often the present mechanism turns faster than the one of the tables. @param {Setting} setting */
export function faster(setting) {
  return setting.free ? 1 : setting.speed;
}

/** Times of the samples [s]. @param {Live} live @param {Setting} setting */
export function times(live, setting) {
  const { duration } = tableOf(live, setting);
  const samples = setting.steps / setting.every;
  return Float64Array.from({ length: samples + 1 }, (_, index) => (index * duration) / faster(setting) / samples);
}

/** The step of the engines [s]. @param {Live} live @param {Setting} setting */
export function stepOf(live, setting) {
  return tableOf(live, setting).duration / faster(setting) / setting.steps;
}

/** MJCF as the Python adapter writes it. @param {Live} live @param {Setting} setting */
export function mjcf(live, setting) {
  const table = tableOf(live, setting);
  const numbers = table.numbers[placeOf(live, setting)].split(",");
  return table.mjcf.map((part, index) => part + (numbers[index] ?? "")).join("");
}

/** The numbers of the shim of Munk2D; all velocities in proportion to the speed. @param {Live} live @param {Setting} setting */
export function munkPlan(live, setting) {
  const plan = Float64Array.from(tableOf(live, setting).munk[placeOf(live, setting)]);
  for (let body = 0; body < plan[2]; body++) {
    for (let velocity = 6; velocity < 9; velocity++) plan[3 + BODY * body + velocity] *= faster(setting);
  }
  return plan;
}

/** Where the origin of each body of Munk2D is in our frame. @param {Float64Array} plan */
export function origins(plan) {
  return Array.from({ length: plan[2] }, (_, body) => [plan[3 + BODY * body + 9], plan[3 + BODY * body + 10]]);
}

/** The exact poses at the samples: of the driven four-bar by the closed form (18.67)-(18.69), of the free one as
 * the reference has integrated them. @param {Live} live @param {Setting} setting */
export function truth(live, setting) {
  if (setting.free) {
    const { samples, truth: whole } = live.free;
    const stride = samples / (setting.steps / setting.every);
    const bodies = live.bodies.length;
    const poses = new Float64Array((setting.steps / setting.every + 1) * bodies * 3);
    for (let frame = 0; frame <= setting.steps / setting.every; frame++) {
      for (let part = 0; part < 3 * bodies; part++) {
        poses[frame * 3 * bodies + part] = (whole ?? [])[frame * stride * 3 * bodies + part];
      }
    }
    return poses;
  }
  const { rocker, ground, start, rate } = live.lengths;
  return fourBar(
    [live.cranks[setting.crank], live.couplers[setting.coupler], rocker], ground, start,
    rate * setting.speed, times(live, setting),
  );
}

/** Closed form of a driven four-bar whose C lies left of the line from B to D.
 * @param {number[]} lengths crank, coupler, rocker [m] @param {number[]} ground @param {number} start [rad]
 * @param {number} rate [rad/s] @param {Float64Array} t */
export function fourBar([crank, coupler, rocker], [dx, dy], start, rate, t) {
  const poses = new Float64Array(t.length * 9);
  let [lastBeta, lastPhi] = [NaN, NaN];
  for (let frame = 0; frame < t.length; frame++) {
    const theta = start + rate * t[frame];
    const [bx, by] = [crank * Math.cos(theta), crank * Math.sin(theta)];
    const [ux, uy] = [dx - bx, dy - by];
    const squared = ux * ux + uy * uy;
    const along = (squared + coupler * coupler - rocker * rocker) / (2 * squared);
    const across = Math.sqrt(coupler * coupler / squared - along * along);
    const [cx, cy] = [bx + along * ux - across * uy, by + along * uy + across * ux];
    const beta = near(Math.atan2(cy - by, cx - bx), lastBeta);
    const phi = near(Math.atan2(cy - dy, cx - dx), lastPhi);
    [lastBeta, lastPhi] = [beta, phi];
    poses.set([bx / 2, by / 2, theta, (bx + cx) / 2, (by + cy) / 2, beta, (cx + dx) / 2, (cy + dy) / 2, phi], 9 * frame);
  }
  return poses;
}

/** The angle with whole turns added that is nearest to another. @param {number} angle @param {number} other */
function near(angle, other) {
  return Number.isNaN(other) ? angle : angle + 2 * Math.PI * Math.round((other - angle) / (2 * Math.PI));
}

/** The pins with their points in the frames of the bars, for pictures. @param {Live} live @param {Setting} setting */
export function joints(live, setting) {
  const lengths = setting.free
    ? [0.4, 0.4 * Math.SQRT2, live.lengths.rocker]
    : [live.cranks[setting.crank], live.couplers[setting.coupler], live.lengths.rocker];
  const end = (/** @type {number} */ body, /** @type {number|null} */ side, /** @type {string} */ name) =>
    side === null ? (name === "A" ? [0, 0] : live.lengths.ground) : [(side * lengths[body]) / 2, 0];
  return live.joints.map(({ name, first, second, ends: [one, other] }) => ({
    name, first, second, firstPoint: end(first, one, name), secondPoint: end(second, other, name),
  }));
}
