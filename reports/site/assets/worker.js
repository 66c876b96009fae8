// @ts-check
/** A worker that runs the engines: it receives settings and sends motions. */

import { doubles, mechanismOf, missed, modelOf, runOf, truth } from "./live_data.js";
import { load, runMujoco, runMunk } from "./live_engines.js";
import { MARKS, NAMES, errors, finite, gapsOf } from "./motion.js";
import { playback } from "./playback.js";
import { measured } from "./quantities.js";

/** @typedef {import("./live_data.js").Setting} Setting @typedef {import("./live_data.js").Name} Name
 * @typedef {import("./live_data.js").Scene} Scene @typedef {Awaited<ReturnType<typeof load>>} Engines */

/** @type {Map<string, Promise<Scene>>} */
const scenes = new Map();
/** @type {Promise<Engines>|null} */
let loading = null;
let folder = "";

/** @param {string} address @returns {Promise<Scene>} */
async function download(address) {
  try {
    const answer = await fetch(address);
    if (answer.ok) return await answer.json();
  } catch {}
  throw new Error("the data of this motion could not be loaded. Check the network, then reload the page");
}

/** @param {string} key @returns {Promise<Scene>} */
async function sceneOf(key) {
  const known = scenes.get(key) ?? download(`${folder}live/${key}.json`);
  scenes.set(key, known);
  known.catch(() => scenes.delete(key)); // the next request tries again
  return known;
}

/** Return the motions, drawing, errors and quantities for a setting. @param {Setting} setting @param {Engines} engines
 * @param {import("./quantities.js").Quantity[]} quantities */
async function answer(setting, engines, quantities) {
  const scene = await sceneOf(setting.key);
  const run = runOf(setting, scene);
  const exact = truth(run);
  /** @type {any[]} */
  const motions = [];
  /** @type {ReturnType<typeof errors>[]} */
  const all = [];
  /** @type {Record<string, string>} */
  const lost = {};
  for (const name of /** @type {Name[]} */ (["munk", "mujoco"])) {
    const why = modelOf(run, name).why || (engines[name] ? "" : engines.why[name]);
    const kept = setting.own ? scene.native[name][setting[name]]?.map(doubles) : null; // stored motion of Python
    if (why && !kept) {
      lost[name] = why;
      continue;
    }
    const begin = performance.now();
    const found = kept && why ? { pose: kept[0], twist: kept[1] } : name === "munk" ? runMunk(engines.munk, run) : runMujoco(engines.mujoco, run);
    const pose = finite(found.pose);
    const wrong = errors(exact.pose, pose, scene.bodies.length, run.samples + 1);
    all.push(wrong);
    motions.push({
      ...found, name, label: NAMES[name], mark: MARKS[name], pose, milliseconds: performance.now() - begin, why: kept ? why : "",
      apart: kept && !why ? pose.reduce((most, value, index) => Math.max(most, Math.abs(value - kept[0][index])), 0) : null,
      errors: wrong[scene.measure], error: wrong[scene.measure].reduce((a, b) => Math.max(a, b), 0),
    });
  }
  const { measure, bodies, centre, versions } = scene;
  const { drawing, blades, traces, joints } = run.at;
  const taken = {
    exact, joints,
    forces: exact.computed ? exact.forces : run.at.forces,
    inertia: run.at.inertia, gravity: run.at.gravity,
    window: scene.window.map((frame) => Math.round((frame * run.samples) / scene.frames)),
    t: Float64Array.from({ length: run.samples + 1 }, (_, index) => index * run.every * run.step),
  };
  const largest = (/** @type {ReturnType<typeof gapsOf>[number]} */ { at }) => motions.reduce((most, motion) =>
    taken.t.reduce((/** @type {number} */ a, _, frame) => Math.max(a, Math.hypot(...at(motion, frame)) || 0), most), 0);
  return {
    ...taken, measure, bodies, centre, versions, motions, lost, drawing, blades, traces, size: drawing.size,
    playback: playback(taken.t, taken.window, drawing.size, all), gaps: gapsOf({ joints, blades, bodies }).map(largest),
    quantities: quantities.map((each) => ({
      ...each,
      found: Object.fromEntries([["exact", exact], ...motions.map((motion) => [motion.name, motion])].map(([name, states]) =>
        [name, measured(each, { ...taken, bodies: bodies.length }, states)])),
    })),
    own: Object.assign({}, ...motions.map(({ own }) => own)), // settings that the methods choose
    mechanism: mechanismOf(run), release: engines.mujoco?.mj_versionString() ?? "",
    // Sliders without an effect on this model are disabled.
    idle: [...modelOf(run, "munk").idle, ...modelOf(run, "mujoco").idle],
  };
}

/** Return velocities and impulses after each iteration of one step of Munk2D; `which`: index of each joint's impulse.
 * @param {Setting} setting @param {number} frame */
async function sweeps(setting, frame) {
  const { munk } = await /** @type {Promise<Engines>} */ (loading);
  const scene = await sceneOf(setting.key);
  const run = runOf(setting, scene);
  const before = frame * run.every - 1; // steps
  const upto = { ...run, samples: Math.min(before, 1), every: before };
  const whole = runMunk(munk, upto, 1).iterations;
  const found = [];
  for (let last = 1; last <= Math.min(whole, 60); last++) {
    const { pose, twist, impulses, left } = runMunk(munk, upto, last);
    const width = 3 * scene.bodies.length;
    found.push({ pose: pose.slice(-width), twist: twist.slice(-width), impulses, left });
  }
  return { found, whole, which: modelOf(run, "munk").impulses, step: run.step };
}

onmessage = async ({ data: { id, kind, setting, frame, quantities, packages, wanted, folder: where } }) => {
  try {
    if (kind === "load") {
      folder = where;
      loading = load(packages, wanted);
      await loading;
      postMessage({ id, result: {} });
    } else if (kind === "check") postMessage({ id, result: missed(runOf(setting, await sceneOf(setting.key))) });
    else if (kind === "sweeps") postMessage({ id, result: await sweeps(setting, frame) });
    else postMessage({ id, result: await answer(setting, await /** @type {Promise<any>} */ (loading), quantities ?? []) });
  } catch (reason) {
    postMessage({ id, why: reason instanceof Error ? reason.message : String(reason) });
  }
};
