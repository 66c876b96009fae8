// @ts-check
/** The engines themselves: MuJoCo and Munk2D in WebAssembly, run as the Python adapters run them. */

import { changesOf, doubles, mjcf, samplesOf, stepOf, truth } from "./live_data.js";

/** @typedef {import("./live_data.js").Setting} Setting */
/** @typedef {import("./live_data.js").Texts} Texts @typedef {import("./live_data.js").Plans} Plans */

const HEAD = 5; // numbers of a plan before its bodies, see live/munk_plan.py
const BODY = 11; // numbers of a body

/** Poses at the samples by MuJoCo. @param {any} mujoco @param {Setting} setting */
export function runMujoco(mujoco, setting) {
  const texts = /** @type {Texts} */ (setting.scene.mujoco[setting.mujoco]);
  const model = mujoco.MjModel.from_xml_string(mjcf(setting.scene, texts, setting.place));
  const data = new mujoco.MjData(model);
  try {
    change(model, changesOf(setting, texts));
    set(model, setting);
    const velocity = /** @type {number[]} */ (setting.scene.pool[texts.velocity[setting.place]]);
    data.qvel.set(velocity.map((rate) => rate * setting.tempo));
    mujoco.mj_forward(model, data);
    return poses(setting, texts, mujoco, model, data);
  } finally {
    data.delete();
    model.delete();
  }
}

/** What the adapter changes in the compiled model. @param {any} model @param {[string, number[]][]} changes */
function change(model, changes) {
  for (const [path, values] of changes) {
    const [name, ...parts] = path.split(".").reverse();
    const owner = parts.reverse().reduce((object, part) => object[part], model);
    if (typeof owner[name] === "number") owner[name] = values[0];
    else owner[name].set(values);
  }
}

/** The sliders of MuJoCo; what is null stays as shipped. @param {any} model @param {Setting} setting */
function set(model, setting) {
  const { opt } = model;
  opt.timestep = stepOf(setting);
  opt.integrator = setting.integrator;
  opt.iterations = setting.solverIterations;
  opt.tolerance = setting.tolerance;
  for (const kind of ["eq", "pair"]) {
    const rows = model[`${kind}_solref`].length / 2;
    for (let row = 0; row < rows; row++) {
      if (setting.timeConstant !== null) model[`${kind}_solref`].set([setting.timeConstant, 1], 2 * row);
      if (setting.impedance !== null) {
        model[`${kind}_solimp`].set([setting.impedance, setting.impedance, 0.001, 0.5, 1], 5 * row);
      }
    }
  }
}

/** @param {Setting} setting @param {Texts} texts @param {any} mujoco @param {any} model @param {any} data */
function poses(setting, texts, mujoco, model, data) {
  const samples = samplesOf(setting);
  const bodies = texts.bodies.length;
  const found = new Float64Array(3 * bodies * (samples + 1));
  const between = setting.every * stepOf(setting);
  const start = truth(setting).subarray(0, 3 * bodies);
  for (let sample = 0; sample <= samples; sample++) {
    for (let count = 0; sample > 0 && count < setting.every; count++) mujoco.mj_step(model, data);
    // MuJoCo starts anew, its clock too, once numbers grow too large: what follows is no motion of this mechanism.
    if (!(Math.abs(data.time - sample * between) < stepOf(setting) / 2)) return found.fill(NaN, 3 * sample * bodies);
    mujoco.mj_kinematics(model, data); // a step leaves the places of bodies as they were before it
    const { xpos, qpos } = data;
    texts.bodies.forEach((own, body) => {
      const turned = texts.turns[body].reduce((sum, place) => sum + qpos[place], 0);
      found.set([xpos[3 * own], xpos[3 * own + 1], start[3 * body + 2] + turned], 3 * (sample * bodies + body));
    });
  }
  return found;
}

/** Poses at the samples by Munk2D. @param {any} munk @param {Setting} setting */
export function runMunk(munk, setting) {
  const plans = /** @type {Plans} */ (setting.scene.munk[setting.munk]);
  const plan = doubles(/** @type {string} */ (setting.scene.pool[plans.plans[setting.place]]));
  const bodies = plan[HEAD - 1];
  for (let body = 0; body < bodies; body++) {
    for (let velocity = 6; velocity < 9; velocity++) plan[HEAD + BODY * body + velocity] *= setting.tempo;
  }
  const samples = samplesOf(setting);
  const size = (samples + 1) * 3 * bodies;
  const given = munk._malloc(8 * plan.length);
  const out = munk._malloc(8 * size);
  try {
    munk.HEAPF64.set(plan, given / 8);
    munk._munk_run(given, plan.length, stepOf(setting), setting.iterations, setting.bias, samples, setting.every, out);
    const found = Float64Array.from(munk.HEAPF64.subarray(out / 8, out / 8 + size));
    for (let body = 0; body < bodies; body++) fromOrigin(found, plan, body, bodies);
    return found;
  } finally {
    munk._free(given);
    munk._free(out);
  }
}

/** From where Munk2D has a body's origin to our own. @param {Float64Array} found @param {Float64Array} plan
 * @param {number} body @param {number} bodies */
function fromOrigin(found, plan, body, bodies) {
  const [x, y] = plan.subarray(HEAD + BODY * body + 9, HEAD + BODY * body + 11);
  if (x === 0 && y === 0) return;
  for (let place = 3 * body; place < found.length; place += 3 * bodies) {
    const [c, s] = [Math.cos(found[place + 2]), Math.sin(found[place + 2])];
    found[place] -= c * x - s * y;
    found[place + 1] -= s * x + c * y;
  }
}

/** The engines that this site has, loaded; null for one that it was built without. @param {string} packages */
export async function load(packages) {
  const one = async (/** @type {string} */ name, /** @type {object} */ given) => {
    const address = new URL(`${packages}${name}`, document.baseURI);
    const { default: start } = await import(address.href);
    return start(given);
  };
  const wanted = (document.body.dataset.engines ?? "").split(" ");
  const [mujoco, munk] = await Promise.all([
    wanted.includes("mujoco") ? one("mujoco.js", { printErr: () => {}, print: () => {} }) : null,
    wanted.includes("munk2d") ? one("munk2d.js", {}) : null,
  ]);
  return { mujoco, munk };
}
