// @ts-check
/** The engines themselves: MuJoCo and Munk2D in WebAssembly, run as the Python adapters run them. */

import { faster, joints, mjcf, munkPlan, origins, placeOf, stepOf, tableOf, truth } from "./live_models.js";

/** @typedef {import("./live_models.js").Live} Live @typedef {import("./live_models.js").Setting} Setting */

/** Poses at the samples by MuJoCo. @param {any} mujoco @param {Live} live @param {Setting} setting */
export function runMujoco(mujoco, live, setting) {
  const place = placeOf(live, setting);
  const table = tableOf(live, setting);
  const model = mujoco.MjModel.from_xml_string(mjcf(live, setting));
  const data = new mujoco.MjData(model);
  try {
    const { opt } = model;
    opt.timestep = stepOf(live, setting);
    opt.gravity.set(live.options.gravity);
    opt.disableflags = live.options.disableflags;
    opt.jacobian = live.options.jacobian;
    opt.integrator = setting.integrator;
    opt.iterations = setting.solverIterations;
    opt.tolerance = setting.tolerance;
    model.stat.meaninertia = table.meanInertia[place];
    model.eq_solref.set([setting.timeConstant, 1]);
    // The two ends of the impedance are as shipped, or one value for both.
    model.eq_solimp.set(setting.impedance > 0 ? [setting.impedance, setting.impedance, 0.001, 0.5, 1] : [0.9, 0.95, 0.001, 0.5, 2]);
    data.qvel.set(table.start[place].map((rate) => rate * faster(setting)));
    mujoco.mj_forward(model, data);
    return poses(live, setting, data, () => mujoco.mj_step(model, data));
  } finally {
    data.delete();
    model.delete();
  }
}

/** @param {Live} live @param {Setting} setting @param {any} data @param {() => void} step */
function poses(live, setting, data, step) {
  const frames = setting.steps / setting.every + 1;
  const found = new Float64Array(frames * 9);
  const start = truth(live, setting).subarray(0, 9);
  const pins = joints(live, setting);
  // As tree.py: angles add up along the tree, and bodies hang on their pins.
  const offset = (/** @type {number} */ body, /** @type {number[]} */ [a, b]) => {
    const angle = body < 0 ? 0 : start[3 * body + 2];
    return [Math.cos(angle) * a - Math.sin(angle) * b, Math.sin(angle) * a + Math.cos(angle) * b];
  };
  for (let frame = 0; frame < frames; frame++) {
    for (let count = 0; frame > 0 && count < setting.every; count++) step();
    const turned = [0, 0, 0];
    for (const { body, parent, column } of live.links) {
      const pin = pins.find((each) => each.second === body && each.first === (parent ?? -1));
      if (!pin) throw new Error("a body hangs on no pin");
      const base = parent === null ? 0 : turned[parent];
      turned[body] = base + data.qpos[column];
      const [armX, armY] = offset(pin.first, pin.firstPoint);
      const [ownX, ownY] = offset(body, pin.secondPoint);
      const x = parent === null ? 0 : found[9 * frame + 3 * parent];
      const y = parent === null ? 0 : found[9 * frame + 3 * parent + 1];
      const [c, s, oc, os] = [Math.cos(base), Math.sin(base), Math.cos(turned[body]), Math.sin(turned[body])];
      found[9 * frame + 3 * body] = x + c * armX - s * armY - (oc * ownX - os * ownY);
      found[9 * frame + 3 * body + 1] = y + s * armX + c * armY - (os * ownX + oc * ownY);
      found[9 * frame + 3 * body + 2] = start[3 * body + 2] + turned[body];
    }
  }
  return found;
}

/** Poses at the samples by Munk2D. @param {any} munk @param {Live} live @param {Setting} setting */
export function runMunk(munk, live, setting) {
  const plan = munkPlan(live, setting);
  const samples = setting.steps / setting.every;
  const size = (samples + 1) * 3 * plan[2];
  const given = munk._malloc(8 * plan.length);
  const out = munk._malloc(8 * size);
  try {
    munk.HEAPF64.set(plan, given / 8);
    munk._munk_run(given, plan.length, stepOf(live, setting), setting.iterations, setting.bias, samples, setting.every, out);
    const found = Float64Array.from(munk.HEAPF64.subarray(out / 8, out / 8 + size));
    origins(plan).forEach(([x, y], body) => {
      if (x === 0 && y === 0) return;
      for (let place = 3 * body; place < size; place += 3 * plan[2]) {
        const [c, s] = [Math.cos(found[place + 2]), Math.sin(found[place + 2])];
        found[place] += c * -x - s * -y;
        found[place + 1] += s * -x + c * -y;
      }
    });
    return found;
  } finally {
    munk._free(given);
    munk._free(out);
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
