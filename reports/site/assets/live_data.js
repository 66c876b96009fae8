// @ts-check
/** The data of scenes: models, exact motions and drawings at every position of the sliders. */

import { FINE, ROUGH, motion, released } from "./exact.js";

/**
 * @typedef {{text: string, bodies: number[], links: number[][], idle: string[]}} Text
 * @typedef {{numbers: string, idle: string[], impulses: number[]}} Space
 * @typedef {{why: string, idle: string[]}} Missing
 * @typedef {{box: string, ground: string, bodies: string[], size: number}} Drawing
 * @typedef {{inertia: number[], gravity: number[], equations: Omit<import("./exact.js").Mechanism, "joints"|"inertia"|"gravity">|null, truth: string|null, drawing: Drawing,
 *   forces: import("./motion.js").Force[]|null, joints: import("./motion.js").Joint[],
 *   blades: import("./motion.js").Blade[], traces: {body: number, point: number[]}[]}} Place
 * @typedef {"munk"|"mujoco"} Name
 * @typedef {{measure: "angle"|"position", frames: number, window: [number, number], duration: number, bodies: string[],
 *   centre: number|null, places: Place[], mujoco: ({models: Text[][]}|Missing)[], munk: ({models: Space[][]}|Missing)[],
 *   native: Record<Name, (string[]|null)[]>, versions: Record<Name, string>}} Scene
 * @typedef {{key: string, place: number, stepPlace: number, steps: number, munk: number, mujoco: number,
 *   integrator: number|null, timeConstant: number|null, impedance: number|null, solverIterations: number|null,
 *   tolerance: number|null, iterations: number|null, bias: number|null, start: number[]|null, own: boolean}} Setting
 *   the settings of a run. start: poses at which the reader released the mechanism. own: whether only methods were changed
 * @typedef {Setting & {scene: Scene, at: Place, every: number, samples: number, step: number}} Run
 */

/** Parse doubles: base64, little-endian. @param {string} text */
export function doubles(text) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  return new Float64Array(bytes.buffer);
}

/** @param {Setting} setting @param {Scene} scene @returns {Run} */
export function runOf(setting, scene) {
  const every = Math.max(1, setting.steps / scene.frames);
  return { ...setting, scene, at: scene.places[setting.place], every, samples: setting.steps / every, step: scene.duration / setting.steps };
}

/** Return the model of an engine for the chosen settings, or the reason why it cannot run them. @param {Run} run @param {Name} engine @returns {any} */
export function modelOf({ scene, place, stepPlace, ...run }, engine) {
  const way = scene[engine][run[engine]];
  return "why" in way ? way : way.models[place][Math.min(stepPlace, way.models[place].length - 1)];
}

/** Return the equations of a pinned linkage, with the start at which the reader released it; null for other mechanisms.
 * @param {Run} run @returns {import("./exact.js").Mechanism|null} */
export function mechanismOf(run) {
  const { at: { equations, inertia, gravity, joints }, start } = run;
  if (!equations) return null;
  const mechanism = { ...equations, inertia, gravity, joints };
  return start ? released(mechanism, start) : mechanism;
}

/** Return the exact motion at the samples. `computed`: whether the page has computed it, and not the reference. @param {Run} run
 * @returns {{pose: Float64Array, twist: Float64Array, forces: import("./motion.js").Force[], computed: boolean}} */
export function truth(run) {
  const { scene, at, start, samples } = run;
  if (at.truth !== null && !start) {
    const width = 6 * scene.bodies.length;
    const whole = doubles(at.truth);
    const stride = (scene.frames / samples) * width;
    const states = Array.from({ length: samples + 1 }, (_, frame) => whole.subarray(frame * stride, frame * stride + width));
    return { ...split(states), forces: [], computed: false };
  }
  return { ...computed(run, FINE), computed: true };
}

/** Compute the motion of a pinned linkage. @param {Run} run @param {number} tolerance */
function computed(run, tolerance) {
  return motion(/** @type {import("./exact.js").Mechanism} */ (mechanismOf(run)), run.samples, run.every * run.step, tolerance);
}

/** Return the largest difference between the computed exact motion and one with a tolerance that is a hundred times as large. @param {Run} run */
export function missed(run) {
  const [fine, rough] = [FINE, ROUGH].map((tolerance) => computed(run, tolerance).pose);
  return fine.reduce((most, value, index) => Math.max(most, Math.abs(value - rough[index])), 0);
}

/** Split states into poses and twists. @param {ArrayLike<number>[]} states of every sample, six numbers a body */
export function split(states) {
  const half = (/** @type {boolean} */ first) => Float64Array.from(states.flatMap((state) => Array.from(state).filter((_, index) => index % 6 < 3 === first)));
  return { pose: half(true), twist: half(false) };
}
