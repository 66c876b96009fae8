// @ts-check
/** The part of a lesson in which sliders act on the engines themselves. */

import { scatter, svg } from "./chart.js";
import { load, runMujoco, runMunk } from "./live_engines.js";
import { joints, stepOf, times, truth } from "./live_models.js";
import { ends, errors, largestGap, told } from "./motion.js";
import { Player } from "./player.js";

/** @typedef {import("./live_models.js").Live} Live @typedef {import("./live_models.js").Setting} Setting */

const FRAMES = { driven: 60, free: 100 };
const NAMES = { munk: "Munk2D, the engine in pymunk", mujoco: "MuJoCo" };
const root = /** @type {HTMLElement} */ (document.getElementById("live"));
const form = /** @type {HTMLFormElement} */ (root.querySelector("form"));
const status = /** @type {HTMLElement} */ (root.querySelector(".status"));
const table = /** @type {HTMLTableSectionElement} */ (root.querySelector("tbody"));
const inputs = /** @type {HTMLInputElement[]} */ ([...form.querySelectorAll("input[name]")]);

/** What a slider's place means: its values stand beside it. @param {HTMLInputElement} input */
const valuesOf = (input) => JSON.parse(input.dataset.values ?? "[]");
/** @param {string} name */
const inputOf = (name) => inputs.find((input) => input.name === name);
/** @param {string} name */
const valueOf = (name) => {
  const input = inputOf(name);
  return input ? valuesOf(input)[Number(input.value)] : undefined;
};

/** The present place of all sliders. @returns {Setting} */
function setting() {
  const free = Boolean(valueOf("free"));
  const most = free ? FRAMES.free : FRAMES.driven;
  const steps = valueOf(free ? "freeSteps" : "steps");
  return {
    free, steps, every: Math.max(1, steps / most),
    crank: Number(inputOf("crank")?.value), coupler: Number(inputOf("coupler")?.value), ratio: Number(inputOf("ratio")?.value),
    speed: valueOf("speed"), integrator: valueOf("integrator"), timeConstant: valueOf("timeConstant"),
    impedance: valueOf("impedance"), solverIterations: valueOf("solverIterations"), tolerance: valueOf("tolerance"),
    iterations: valueOf("iterations"), bias: valueOf("bias"),
  };
}

/** Beside each slider what it stands at; what has no meaning for this motion can't be moved. @param {Live} live */
function label(live) {
  const now = setting();
  for (const input of inputs) {
    const output = input.closest("label")?.querySelector(".value");
    const words = JSON.parse(input.dataset.words ?? "null");
    let text = words ? words[Number(input.value)] : String(valueOf(input.name));
    if (input.name === "steps" || input.name === "freeSteps") text = `${told(stepOf(live, now) * 1000)} ms`;
    if (output) output.textContent = text;
    input.setAttribute("aria-valuetext", text);
    const lengths = ["crank", "coupler", "ratio", "speed"].includes(input.name);
    input.disabled = now.free && lengths;
    const row = input.closest("label");
    if (row) row.hidden = (input.name === "steps" && now.free) || (input.name === "freeSteps" && !now.free);
  }
}

/** The drawing for these lengths: bars of the truth and of each engine. @param {number} motions @param {number[]} lengths */
function stage(motions, lengths) {
  const drawing = svg("svg", { class: "stage", viewBox: "-0.75 -1.35 2.95 2.15", role: "img", "aria-label": "The four-bar" });
  const world = svg("g", { class: "world", transform: "scale(1 -1)" });
  const ground = svg("g", { class: "ground" });
  for (const x of [0, 1.2]) ground.append(svg("path", { class: "support", d: `M${x} 0L${x - 0.05} -0.09L${x + 0.05} -0.09Z` }));
  world.append(ground);
  for (let motion = 0; motion <= motions; motion++) {
    const group = svg("g", { class: `motion ${motion === motions ? "truth" : `method method-${motion + 1}`}` });
    const traces = svg("g", { class: "traces" });
    traces.append(svg("path", { class: "trace", d: "" }));
    group.append(traces);
    for (const length of lengths) {
      const body = svg("g", { class: "body" });
      body.append(svg("path", { class: "bar", d: `M${-length / 2} 0L${length / 2} 0` }));
      for (const end of [-1, 1]) body.append(svg("circle", { class: "pin", cx: (end * length) / 2, cy: 0, r: 0.018 }));
      group.append(body);
    }
    world.append(group);
  }
  world.append(svg("g", { class: "overlay" }));
  drawing.append(world);
  return drawing;
}

/** @param {ArrayLike<number>} pose */
function couplerPath(pose) {
  let path = "";
  for (let place = 3; place < pose.length; place += 9) {
    if (Number.isFinite(pose[place])) path += `${path ? "L" : "M"}${pose[place].toFixed(4)} ${pose[place + 1].toFixed(4)}`;
  }
  return path;
}

/** Values that JSON and charts can have: what blew up is no number. @param {Float64Array} pose */
function finite(pose) {
  return pose.map((value) => (Math.abs(value) < 1e6 ? value : NaN));
}

/** @param {Live} live @param {{mujoco: any, munk: any}} engines @param {any[]} rows */
function start(live, engines, rows) {
  const figure = /** @type {HTMLElement} */ (root.querySelector("figure"));
  const frame = /** @type {HTMLElement} */ (figure.querySelector(".frame"));
  const place = /** @type {HTMLElement} */ (root.querySelector(".stored"));
  /** @type {Player|null} */
  let player = null;

  const run = () => {
    label(live);
    const now = setting();
    const begin = performance.now();
    const exact = truth(live, now);
    /** @type {{name: string, pose: Float64Array, milliseconds: number, method: string}[]} */
    const motions = [];
    const one = (/** @type {string} */ name, /** @type {string} */ method, /** @type {() => Float64Array} */ compute) => {
      const before = performance.now();
      const pose = finite(compute());
      motions.push({ name, pose, milliseconds: performance.now() - before, method });
    };
    if (engines.munk) one(NAMES.munk, "pymunk", () => runMunk(engines.munk, live, now));
    if (engines.mujoco) one(NAMES.mujoco, "mujoco", () => runMujoco(engines.mujoco, live, now));
    const spent = performance.now() - begin;
    const pins = joints(live, now);
    const t = times(live, now);
    const lengths = pins.slice(0, 3).map((pin) => 2 * Math.abs(pin.secondPoint[0]));
    frame.replaceChildren(stage(motions.length, [lengths[0], lengths[1], live.lengths.rocker]));
    frame.querySelectorAll(".trace").forEach((path, index) => {
      path.setAttribute("d", couplerPath(index < motions.length ? motions[index].pose : exact));
    });
    const take = {
      t: Array.from(t), bodies: live.bodies, joints: pins, size: 1,
      truth: { pose: /** @type {any} */ (exact), twist: [] },
      motions: motions.map(({ name, pose }) => ({ name, pose: /** @type {any} */ (pose) })),
      lost: [], forces: [], centre: null, traces: [{ body: 1, point: [0, 0] }],
    };
    if (player) player.load(take);
    else player = new Player(figure, take);
    const found = motions.map(({ name, pose, milliseconds, method }) => {
      const { angle } = errors(exact, pose, 3, t.length);
      const error = angle.reduce((a, b) => Math.max(a, b), 0);
      return { name, method, error, gap: largestGap(pins, pose, 3, t.length), milliseconds };
    });
    table.replaceChildren(...found.map(({ name, error, gap, milliseconds }) => {
      const row = document.createElement("tr");
      for (const text of [name, told(error), told(gap), milliseconds.toFixed(1)]) row.insertCell().textContent = text;
      return row;
    }));
    root.dataset.errors = JSON.stringify(found.map(({ error }) => error));
    root.dataset.gaps = JSON.stringify(found.map(({ gap }) => gap));
    root.dataset.spent = spent.toFixed(2);
    const scene = now.free ? "free_four_bar" : "driven_four_bar";
    const own = found.map(({ error, name }, index) => ({ x: stepOf(live, now), y: error, mark: index + 1, name: `${name}, now` }));
    scatter(place, rows.filter((row) => row.scene === scene), own);
    const state = inputs.map((input) => `${input.name}=${input.value}`).join("&");
    history.replaceState(null, "", `#live&${state}`);
  };
  form.addEventListener("input", run);
  form.addEventListener("submit", (event) => event.preventDefault());
  for (const button of root.querySelectorAll("button[data-preset]")) {
    if (!(button instanceof HTMLButtonElement)) continue;
    button.addEventListener("click", () => {
      for (const [name, value] of Object.entries(JSON.parse(button.dataset.preset ?? "{}"))) {
        const input = inputOf(name);
        if (input) input.value = String(value);
      }
      const remark = root.querySelector(".expected");
      if (remark) remark.textContent = button.dataset.expected ?? "";
      run();
    });
  }
  run();
  Object.assign(window, { crosscheckLive: { live, engines, setting, truth, runMujoco, runMunk, ends } });
}

/** The sliders as a link has them. */
function restore() {
  if (!location.hash.startsWith("#live&")) return;
  for (const part of location.hash.slice(6).split("&")) {
    const [name, value] = part.split("=");
    const input = inputOf(name);
    if (input && /^\d+$/.test(value) && Number(value) <= Number(input.max)) input.value = value;
  }
  root.scrollIntoView();
}

async function begin() {
  restore();
  const folder = root.dataset.folder ?? "";
  try {
    const read = async (/** @type {string} */ name) => (await fetch(`${folder}live/${name}`)).json();
    const [live, rows, engines] = await Promise.all([read("four_bar.json"), read("rows.json"), load(`${folder}packages/`)]);
    start(live, engines, rows);
    status.textContent = "";
    root.classList.add("ready");
  } catch (reason) {
    status.textContent = `The engines could not be loaded: ${reason instanceof Error ? reason.message : reason}`;
  }
}

begin();
