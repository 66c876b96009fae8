// @ts-check
/** What the page loads of its live scenes: models, truth and drawings at every place of the sliders. */

/**
 * @typedef {import("./motion.js").Joint} Joint
 * @typedef {{parts: string[], numbers: number[], changes: number[][], velocity: number[], bodies: number[],
 *   turns: number[][], springs: boolean}} Texts
 * @typedef {{plans: number[]}} Plans
 * @typedef {{why: string}} Missing
 * @typedef {{box: string, ground: string, bodies: string[], size: number}} Drawing
 * @typedef {{word: string, scene: string, measure: "angle"|"position", frames: number, steps: number[],
 *   duration: number, sliders: {name: string, size: number}[], bodies: string[], truth: number[], drawings: number[],
 *   joints: number[], mujoco: (Texts|Missing)[], munk: (Plans|Missing)[], traces: {body: number, point: number[]}[],
 *   native: Record<"munk"|"mujoco", {version: string, pose: string|null}>, pool: unknown[]}} Scene
 * @typedef {{scene: Scene, place: number, stepPlace: number, steps: number, every: number, tempo: number, munk: number, mujoco: number,
 *   integrator: number, timeConstant: number|null, impedance: number|null, solverIterations: number,
 *   tolerance: number, iterations: number, bias: number}} Setting
 */

/** Doubles as the site wrote them: base64, the lowest byte first. @param {string} text */
export function doubles(text) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const view = new DataView(bytes.buffer);
  return Float64Array.from({ length: bytes.length / 8 }, (_, index) => view.getFloat64(8 * index, true));
}

/** Where the tables have these places of a scene's sliders; the last slider changes first.
 * @param {Scene} scene @param {number[]} places */
export function placeOf(scene, places) {
  return scene.sliders.reduce((place, { size }, index) => place * size + places[index], 0);
}

/** Sampling intervals of the motion. @param {Setting} setting */
export const samplesOf = ({ steps, every }) => steps / every;

/** The step of the engines [s]. @param {Setting} setting */
export const stepOf = ({ scene, tempo, steps }) => scene.duration / tempo / steps;

/** Times of the samples [s]. @param {Setting} setting */
export function times(setting) {
  const samples = samplesOf(setting);
  const { scene, tempo } = setting;
  return Float64Array.from({ length: samples + 1 }, (_, index) => (index * scene.duration) / tempo / samples);
}

/** The exact poses at the samples, as the reference computed them. A faster motion passes the same poses sooner.
 * @param {Setting} setting */
export function truth(setting) {
  const { scene, place } = setting;
  const whole = doubles(/** @type {string} */ (scene.pool[scene.truth[place]]));
  const width = 3 * scene.bodies.length;
  const samples = samplesOf(setting);
  const stride = scene.frames / samples;
  const poses = new Float64Array((samples + 1) * width);
  for (let frame = 0; frame <= samples; frame++) {
    poses.set(whole.subarray(frame * stride * width, (frame * stride + 1) * width), frame * width);
  }
  return poses;
}

/** MJCF as the Python adapter writes it. @param {Scene} scene @param {Texts} texts @param {number} place */
export function mjcf(scene, texts, place) {
  const numbers = /** @type {string} */ (scene.pool[texts.numbers[place]]).split(",");
  return texts.parts.map((part, index) => part + (numbers[index] ?? "")).join("");
}

/** @param {Setting} setting */
export const drawingOf = ({ scene, place }) => /** @type {Drawing} */ (scene.pool[scene.drawings[place]]);

/** @param {Setting} setting */
export const jointsOf = ({ scene, place }) => /** @type {Joint[]} */ (scene.pool[scene.joints[place]]);

/** What the adapter changes in MuJoCo's compiled model; on skates it depends on the step.
 * @param {Setting} setting @param {Texts} texts */
export function changesOf({ scene, place, stepPlace }, texts) {
  const own = texts.changes[place];
  return /** @type {[string, number[]][]} */ (scene.pool[own[Math.min(stepPlace, own.length - 1)]]);
}

/** Why an engine can't run what is chosen, or an empty text. @param {Setting} setting @param {"munk"|"mujoco"} engine */
export function whyNot(setting, engine) {
  const way = setting.scene[engine][setting[engine]];
  return "why" in way ? way.why : "";
}
