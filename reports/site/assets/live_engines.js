// @ts-check
/** Runs of MuJoCo and Munk2D in WebAssembly, with the models of the Python adapters. */

import { doubles, mechanismOf, modelOf, split, truth } from "./live_data.js";

/** @typedef {import("./live_data.js").Run} Run
 * @typedef {import("./live_data.js").Text} Text @typedef {import("./live_data.js").Space} Space */

const HEAD = 8; // count of numbers before the bodies, see live/models.py
const BODY = 11; // numbers of a body

/** Return poses and twists at the samples by MuJoCo, and the spring of its first constraint row at the end. @param {any} mujoco @param {Run} run */
export function runMujoco(mujoco, run) {
  const plan = /** @type {Text} */ (modelOf(run, "mujoco"));
  const model = mujoco.MjModel.from_xml_string(plan.text);
  const data = new mujoco.MjData(model);
  try {
    const own = chosen(model);
    set(model, run);
    mujoco.mj_resetDataKeyframe(model, data, 0);
    if (run.start) begin(run, plan, data);
    mujoco.mj_forward(model, data);
    return { ...states(run, plan, mujoco, model, data), spring: data.nefc ? [...data.efc_KBIP.slice(0, 3)] : null, own };
  } finally {
    data.delete();
    model.delete();
  }
}

/** Return the settings that the method itself chooses, as texts of the controls. @param {any} model @returns {Record<string, string>} */
function chosen(model) {
  const { opt } = model;
  const kind = model.neq ? "eq" : "pair";
  const constant = model[`${kind}_solref`][0];
  const short = (/** @type {number} */ value, /** @type {number} */ digits) => String(Number(value.toPrecision(digits)));
  return {
    integrator: ["Euler", "RK4", "implicit", "implicitfast"][opt.integrator] ?? "", solverIterations: String(opt.iterations), tolerance: short(opt.tolerance, 2),
    ...(model.neq + model.npair ? { timeConstant: constant > 0 ? `${short(1000 * constant, 2)} ms` : "given by a stiffness", impedance: short(model[`${kind}_solimp`][0], 4) } : {}),
  };
}

/** Apply the sliders of MuJoCo; null keeps the value of the method. @param {any} model @param {Run} run */
function set(model, run) {
  const { opt } = model;
  opt.timestep = run.step;
  opt.integrator = run.integrator ?? opt.integrator;
  opt.iterations = run.solverIterations ?? opt.iterations;
  opt.tolerance = run.tolerance ?? opt.tolerance;
  for (const kind of ["eq", "pair"]) {
    const rows = model[`${kind}_solref`].length / 2;
    for (let row = 0; row < rows; row++) {
      if (run.timeConstant !== null) model[`${kind}_solref`].set([run.timeConstant, 1], 2 * row);
      if (run.impedance !== null) model[`${kind}_solimp`].set([run.impedance, run.impedance, 0.001, 0.5, 1], 5 * row);
    }
  }
}

/** Set the coordinates from the poses at which the reader released the mechanism. @param {Run} run @param {Text} plan @param {any} data */
function begin(run, plan, data) {
  const now = /** @type {import("./exact.js").Mechanism} */ (mechanismOf(run));
  const old = /** @type {import("./exact.js").Mechanism} */ (mechanismOf({ ...run, start: null }));
  for (const [body, parent, rotation, slide, dx, dy] of plan.links) {
    const moved = (/** @type {number} */ own, /** @type {number} */ axis) => (own < 0 ? 0 : now.pose[3 * own + axis] - old.pose[3 * own + axis]);
    const rate = (/** @type {number} */ own) => (own < 0 ? 0 : now.twist[3 * own + 2]);
    if (rotation >= 0) {
      data.qpos[rotation] = moved(body, 2) - moved(parent, 2);
      data.qvel[rotation] = rate(body) - rate(parent);
    }
    if (slide >= 0) {
      data.qpos[slide] = dx * moved(body, 0) + dy * moved(body, 1);
      data.qvel[slide] = dx * now.twist[3 * body] + dy * now.twist[3 * body + 1];
    }
  }
}

/** @param {Run} run @param {Text} plan @param {any} mujoco @param {any} model @param {any} data */
function states(run, plan, mujoco, model, data) {
  const { samples, every, step } = run;
  const compiled = { ...run, start: null };
  const first = mechanismOf(compiled)?.pose ?? truth(compiled).pose; // tree coordinates are changes of angles
  const state = () => {
    // After a step, `data` has the positions and velocities of bodies before the step.
    for (const renew of ["mj_kinematics", "mj_comPos", "mj_comVel"]) mujoco[renew](model, data);
    const { xpos, qpos, cvel, subtree_com: com } = data;
    /** @type {number[]} */
    const turned = [];
    for (const [body, parent, rotation] of plan.links) turned[body] = (turned[parent] ?? 0) + (rotation < 0 ? 0 : qpos[rotation]);
    return plan.bodies.flatMap((own, body) => {
      const [x, y] = [xpos[3 * own], xpos[3 * own + 1]];
      const [rate, vx, vy] = cvel.subarray(6 * own + 2, 6 * own + 5); // velocity at the centre of mass of the tree
      const root = 3 * model.body_rootid[own];
      return [x, y, first[3 * body + 2] + turned[body], vx - rate * (y - com[root + 1]), vy + rate * (x - com[root]), rate];
    });
  };
  /** @type {number[][]} */
  const found = [];
  for (let sample = 0; sample <= samples; sample++) {
    for (let count = 0; sample > 0 && count < every; count++) mujoco.mj_step(model, data);
    // MuJoCo resets its state and its time if numbers become too large.
    if (!(Math.abs(data.time - sample * every * step) < step / 2)) break;
    found.push(state());
  }
  while (found.length <= samples) found.push(new Array(6 * plan.bodies.length).fill(NaN));
  return split(found);
}

/** Return poses and twists at the samples by Munk2D. `last`: number of iterations of an additional last step, after which the
 * impulse of each joint is returned [N s]; 0 for no such step. @param {any} munk @param {Run} run @param {number} last */
export function runMunk(munk, run, last = 0) {
  const plan = doubles(/** @type {Space} */ (modelOf(run, "munk")).numbers);
  const bodies = plan[HEAD - 4];
  if (run.start) place(run, plan);
  const iterations = run.iterations ?? plan[HEAD - 3];
  const bias = run.bias ?? plan[HEAD - 2];
  // The unit of time is the step if error_bias is the residual after a step.
  const unit = run.bias === null && plan[HEAD - 1] ? run.step : 1;
  const states_ = run.samples + 1 + (last ? 1 : 0);
  const size = states_ * 6 * bodies + (last ? 2 * plan.length : 0);
  const given = munk._malloc(8 * plan.length);
  const out = munk._malloc(8 * size);
  try {
    munk.HEAPF64.set(plan, given / 8);
    munk._munk_run(given, plan.length, run.step / unit, unit, iterations, bias, run.samples, run.every, last, out);
    const found = Float64Array.from(munk.HEAPF64.subarray(out / 8, out / 8 + size));
    const rows = Array.from({ length: states_ }, (_, index) => fromOrigins(found.subarray(6 * bodies * index, 6 * bodies * (index + 1)), plan));
    return { ...split(rows), impulses: found.subarray(6 * bodies * states_), iterations, left: unit === 1 ? bias ** run.step : bias,
      own: { iterations: String(plan[HEAD - 3]), bias: String(Number(plan[HEAD - 2].toPrecision(2))) } };
  } finally {
    munk._free(given);
    munk._free(out);
  }
}

/** Set the poses at which the reader released the mechanism. @param {Run} run @param {Float64Array} plan */
function place(run, plan) {
  const { pose, twist } = /** @type {import("./exact.js").Mechanism} */ (mechanismOf(run));
  for (let at = HEAD, body = 0; body < run.scene.bodies.length; at += BODY, body++) {
    const [x, y, angle] = pose.slice(3 * body, 3 * body + 3);
    const [ox, oy] = plan.subarray(at + 9, at + 11);
    const [c, s] = [Math.cos(angle), Math.sin(angle)];
    plan.set([x + c * ox - s * oy, y + s * ox + c * oy, angle], at + 3);
    // A kinematic crank turns about its origin, which is its pin.
    plan.set(plan[at] ? [0, 0, twist[3 * body + 2]] : twist.slice(3 * body, 3 * body + 3), at + 6);
  }
}

/** Convert states from Munk2D's origin of a body to ours, in place. @param {Float64Array} state @param {Float64Array} plan */
function fromOrigins(state, plan) {
  for (let at = HEAD + 9, own = 0; own < state.length; at += BODY, own += 6) {
    const [x, y] = plan.subarray(at, at + 2);
    if (x === 0 && y === 0) continue;
    const [c, s] = [Math.cos(state[own + 2]), Math.sin(state[own + 2])];
    const [ax, ay] = [c * x - s * y, s * x + c * y];
    state[own] -= ax;
    state[own + 1] -= ay;
    state[own + 3] += state[own + 5] * ay;
    state[own + 4] -= state[own + 5] * ax;
  }
  return state;
}

/** Load the engines; null for an engine that this site does not contain, or that could not be loaded. `why`: the reason.
 * @param {string} packages @param {string[]} wanted */
export async function load(packages, wanted) {
  /** @type {Record<string, string>} */
  const why = {};
  const one = async (/** @type {"mujoco"|"munk"} */ name, /** @type {string} */ file, /** @type {object} */ given) => {
    why[name] = "this site was built without it";
    if (!wanted.includes(file)) return null;
    try {
      return await (await import(`${packages}${file}.js`)).default(given);
    } catch {
      why[name] = "its file could not be loaded. Check the network or the browser's blocker, then reload the page";
      return null;
    }
  };
  const [mujoco, munk] = await Promise.all([one("mujoco", "mujoco", { printErr: () => {}, print: () => {} }), one("munk", "munk2d", {})]);
  return { mujoco, munk, why };
}
