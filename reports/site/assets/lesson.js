// @ts-check
/** A lesson: a picture for all experiments, questions, numbers that can be dragged, and a worker for the engines. */

import { svg } from "./chart.js";
import { dragged } from "./exact.js";
import { Form } from "./form.js";
import { placed, told, UNITS } from "./motion.js";
import { Player } from "./player.js";

/** @typedef {import("./live_data.js").Setting} Setting */
/** @typedef {any} Answer the result of `answer` in worker.js */

/** @type {Record<string, string>} */
const NAMES = { munk: "pymunk", mujoco: "MuJoCo" };
/** @type {Record<string, number>} */
const MARKS = { munk: 1, mujoco: 2 };
const root = /** @type {HTMLElement} */ (document.getElementById("lesson"));
const find = (/** @type {string} */ name) => /** @type {HTMLElement} */ (root.querySelector(name));
const calm = matchMedia("(prefers-reduced-motion: reduce)");
const figure = find("figure");
const player = new Player(figure);
const form = new Form(root);
const lens = player.lens;
/** @type {Worker|null} */
let worker = null;
/** @type {Map<number, {resolve: (told: any) => void, reject: (why: Error) => void}>} */
const asked = new Map();
let number = 0;
/** @type {Answer} */
let shown = null;
/** @type {number[]|null} the poses at which the reader released the mechanism */
let start = null;
/** @type {{setting: Setting, play: boolean, ways: Record<string, string>}|null} the last
 * request that waits for a run to end, with the label of each engine's method */
let waiting = null;
let busy = false;

/** @param {object} message @returns {Promise<any>} */
function ask(message) {
  return new Promise((resolve, reject) => {
    asked.set(++number, { resolve, reject });
    worker?.postMessage({ id: number, ...message });
  });
}

/** Start the worker, which loads the engines. */
function load() {
  if (worker) return;
  const base = new URL(root.dataset.folder ?? "", document.baseURI).href;
  worker = new Worker(new URL("worker.js", import.meta.url), { type: "module" });
  worker.onmessage = ({ data: { id, told: answer, why } }) => {
    const one = asked.get(id);
    asked.delete(id);
    if (why) one?.reject(new Error(why));
    else one?.resolve(answer);
  };
  worker.onerror = (event) => failed(new Error(event.message ?? "the worker could not start"));
  ask({ kind: "load", folder: base, packages: `${base}packages/`, wanted: (root.dataset.engines ?? "").split(" ") }).catch(failed);
  find(".status").textContent = "Loading the engines.";
}

/** @param {unknown} reason */
function failed(reason) {
  find(".status").textContent = `The engines could not be run: ${reason instanceof Error ? reason.message : reason}`;
}

/** Run the settings of the form; of the requests during a run, only the last one is answered. @param {boolean} play */
function run(play) {
  const ways = Object.fromEntries(Object.keys(NAMES).map((name) => [name, [form.words(name), ...form.changed(name)].join(", ")]));
  waiting = { setting: form.setting(start), play, ways };
  if (!busy) requestAnimationFrame(next);
}

async function next() {
  if (!waiting || busy) return;
  const { setting, play, ways } = waiting;
  [waiting, busy] = [null, true];
  try {
    load();
    show(await ask({ setting }), play, ways);
  } catch (reason) {
    failed(reason);
  }
  busy = false;
  if (waiting) requestAnimationFrame(next);
}

/** Return the SVG of the bodies in each motion; the exact motion is above the others. @param {Answer} answer */
function stage({ drawing, motions }) {
  const bodies = drawing.bodies.map((/** @type {string} */ shape) => `<g class="body">${shape}</g>`).join("");
  const kinds = [...motions.map((/** @type {any} */ { name }) => `method method-${MARKS[name]}`), "truth"];
  const groups = kinds.map((kind) => `<g class="motion ${kind}"><g class="traces"></g>${bodies}</g>`).join("");
  return (
    `<svg class="stage" viewBox="${drawing.box}" role="img" aria-label="The mechanism"><g class="world" ` +
    `transform="scale(1 -1)"><g class="ground">${drawing.ground}</g>${groups}<g class="overlay"></g></g></svg>`
  );
}

/** Return the path of a body's point. @param {ArrayLike<number>} pose @param {number} bodies @param {number} body @param {number[]} point */
function pathOf(pose, bodies, body, point) {
  let path = "";
  for (let at = 3 * body; at < pose.length; at += 3 * bodies) {
    const [x, y] = placed([pose[at], pose[at + 1], pose[at + 2]], point);
    if (Number.isFinite(x + y)) path += `${path ? "L" : "M"}${x.toFixed(4)} ${y.toFixed(4)}`;
  }
  return path;
}

/** @param {Answer} answer @param {boolean} play @param {Record<string, string>} ways */
function show(answer, play, ways) {
  shown = answer;
  const { motions, exact, bodies, traces, lost } = answer;
  player.stop();
  player.stage.outerHTML = stage(answer);
  figure.querySelectorAll(".frame .traces").forEach((group, index) => {
    const pose = motions[index]?.pose ?? exact.pose;
    for (const { body, point } of traces) group.append(svg("path", { class: "trace", d: pathOf(pose, bodies.length, body, point) }));
  });
  const spring = motions.find((/** @type {any} */ { name }) => name === "mujoco")?.spring;
  find(".springs").textContent = springWords(spring, answer);
  player.load({
    ...answer, size: answer.drawing.size, truth: exact,
    motions: motions.map((/** @type {any} */ motion) => ({ ...motion, name: NAMES[motion.name], mark: MARKS[motion.name] })),
  });
  for (const name in NAMES) {
    const entry = find(`.legend .method-${MARKS[name]}`);
    const from = motions.find((/** @type {any} */ one) => one.name === name)?.from;
    find(`.legend .method-${MARKS[name]} .way`).textContent = `${NAMES[name]}, ${ways[name]}${from ? " (stored: run in Python)" : ""}`;
    entry.classList.toggle("lost", name in lost);
    if (name in lost) find(`.legend .method-${MARKS[name]} .figure`).textContent = lost[name];
  }
  form.label(answer.idle);
  find(".status").textContent = statusOf(answer);
  root.classList.add("ready");
  find(".next").hidden = !motions.some((/** @type {any} */ { name, impulses }) => name === "munk" && impulses) || !answer.joints.length;
  find(".sweeps").hidden = true;
  figure.classList.toggle("can-grab", Boolean(answer.mechanism));
  if (play && !calm.matches) player.play(true);
  else if (play) {
    player.frame = player.stopAt;
    player.show();
  }
}

/** Return a text on the spring that closes MuJoCo's loop. @param {any} spring @param {Answer} answer */
function springWords(spring, { joints, blades, motions, forces }) {
  if (!(joints.length + blades.length) || !motions.some((/** @type {any} */ { name }) => name === "mujoco")) return "";
  const contact = blades.length || forces.some((/** @type {any} */ each) => each.contact);
  if (!spring) return contact ? "" : "MuJoCo needs no spring here: its joints are hinges of a tree, which cannot open.";
  const [k, b, impedance] = spring; // stiffness [1/s^2] and damping [1/s] for a unit of inertia, impedance [1]
  return `MuJoCo enforces this ${contact ? "contact" : "loop"} by a spring and a damper: a gap decays in about ${told(2000 / b)} ms, and an acceleration a that opens it leaves a gap of (1 − d)/(d k) a: ${told((1 - impedance) / (impedance * k) * 1e6)} µm for each m/s².`;
}

/** @param {Answer} answer */
function statusOf({ exact, motions, versions, release }) {
  const missed = exact.missed === null ? "" : `The page computes this exact motion itself, with an error of at most ${told(Math.max(exact.missed, 1e-15))} m or rad. `;
  const apart = motions.filter((/** @type {any} */ each) => each.apart !== null).map((/** @type {any} */ { name, apart: by }) =>
    `${NAMES[name]} in the page${name === "mujoco" ? ` (${release})` : ""} and ${versions[name]} in Python differ by at most ${told(by)} m or rad.`);
  return missed + apart.join(" ");
}

/** Show an experiment in the picture. @param {HTMLElement} part @param {"before"|"after"} which @param {boolean} play */
function stageOf(part, which, play) {
  start = null;
  const { scene, before, after, shown: on } = part.dataset;
  const places = { ...JSON.parse(before ?? "{}"), ...(which === "after" ? JSON.parse(after ?? "{}") : {}) };
  form.move(Number(scene), places);
  player.boxes.forEach((box) => (box.checked = (on ?? "").split(" ").includes(box.value)));
  for (const other of root.querySelectorAll(".part")) other.classList.toggle("shown", other === part);
  run(play);
}

/** Run the settings before and after the change; show both errors and the explanation. @param {HTMLElement} part @param {HTMLElement} button */
async function guessed(part, button) {
  for (const each of part.querySelectorAll(".answers button")) {
    each.classList.toggle("chosen", each === button);
    each.setAttribute("aria-pressed", String(each === button));
    each.classList.toggle("right", each instanceof HTMLElement && each.dataset.right !== undefined);
  }
  const measured = /** @type {HTMLElement} */ (part.querySelector(".measured"));
  const why = /** @type {HTMLDetailsElement} */ (part.querySelector(".why"));
  const right = button.dataset.right !== undefined ? "Right." : "Not so.";
  if (part.dataset.after === "{}") {
    [why.open, measured.textContent] = [true, right]; // the question is not about an engine
    return;
  }
  load();
  stageOf(part, "before", false);
  const before = await ask({ setting: form.setting(null) }).catch(failed);
  stageOf(part, "after", true);
  const after = await ask({ setting: form.setting(null) }).catch(failed);
  why.open = true;
  const verdict = button.dataset.right === undefined ? "Not so." : "Right.";
  measured.textContent = before && after ? `${verdict} ${compared(before, after)}` : verdict;
}

/** @param {Answer} before @param {Answer} after */
function compared(before, after) {
  const unit = UNITS[/** @type {"angle"|"position"} */ (after.measure)];
  return after.motions.map((/** @type {any} */ { name, error }) => {
    const old = before.motions.find((/** @type {any} */ one) => one.name === name)?.error;
    const own = NAMES[name];
    if (!(old > 0) || !(error > 0)) return `${own}: largest error ${told(error)} ${unit}.`;
    const ratio = Math.max(error / old, old / error);
    const times = Number(ratio.toPrecision(2)).toLocaleString("en");
    const by = ratio < 1.05 ? "as before" : `${times} times ${error > old ? "as large" : "smaller"}`;
    return `${own}: ${told(old)} ${unit} before, ${told(error)} ${unit} now, ${by}.`;
  }).join(" ");
}

/** Store changes by the reader in the address. */
function changed() {
  history.replaceState(history.state, "", form.link);
  run(true);
}

function begin() {
  for (const part of root.querySelectorAll(".part")) {
    if (!(part instanceof HTMLElement)) continue;
    for (const button of part.querySelectorAll(".answers button")) {
      if (button instanceof HTMLElement) button.addEventListener("click", () => guessed(part, button));
    }
    part.querySelector(".set")?.addEventListener("click", () => stageOf(part, "before", true));
  }
  for (const button of root.querySelectorAll("button[data-way]")) {
    if (!(button instanceof HTMLElement)) continue;
    button.addEventListener("click", () => {
      start = null;
      form.move(form.index, { munk: Number(button.dataset.way), mujoco: Number(button.dataset.way) });
      changed();
    });
  }
  form.onchange = changed;
  /** @type {any} */
  let sweep = null;
  let at = 0;
  find(".next").addEventListener("click", async () => {
    const of = `${JSON.stringify(form.setting(start))} ${player.frame}`;
    if (find(".sweeps").hidden || at >= sweep.found.length - 1 || sweep.of !== of) {
      player.stop();
      sweep = { of, ...(await ask({ kind: "sweeps", setting: form.setting(start), frame: Math.max(1, player.frame) })) };
      at = -1;
    }
    find(".sweeps").hidden = false;
    find(".sweeps .which").textContent = lens.sweep(sweep, ++at, find(".sweeps tbody"));
    find(".next").textContent = at >= sweep.found.length - 1 ? "again from iteration 1" : "next iteration";
  });
  /** @type {Float64Array|null} */
  let held = null;
  player.grabbed((body, point, wanted) => {
    if (!shown?.mechanism) return null;
    const width = 3 * shown.bodies.length;
    held ??= shown.exact.pose.slice(player.frame * width, (player.frame + 1) * width);
    return (held = dragged(shown.mechanism, /** @type {Float64Array} */ (held), body, point, wanted));
  }, () => {
    start = held && [...held];
    held = null;
    run(true);
  });
  // The picture shows the experiment in the middle of the window. The first experiment loads the engines.
  const linked = form.restore(location.hash);
  const parts = [...root.querySelectorAll(".part")];
  if (linked) run(false);
  let moved = linked; // becomes false when the reader scrolls away from the experiment that the link has opened
  const looking = new IntersectionObserver((entries) => {
    const near = entries.filter(({ target, isIntersecting }) => isIntersecting && !target.classList.contains("shown"));
    for (const { target } of moved ? [] : near) {
      if (target instanceof HTMLElement && !target.querySelector(".answers .chosen")) stageOf(target, "before", true);
    }
    if (near.length) moved = false;
  }, { rootMargin: "-25% 0px -70% 0px" });
  for (const part of parts) looking.observe(part);
  if (!linked && parts[0] instanceof HTMLElement) stageOf(parts[0], "before", true);
  addEventListener("hashchange", () => form.restore(location.hash) && run(false));
  Object.assign(window, { crosscheck: { ask, form, setting: () => form.setting(start) } });
}

document.documentElement.classList.add("js");
begin();
