// @ts-check
/** A lesson: a picture for all experiments, questions, numbers that can be dragged, and a worker for the engines. */

import { dragged } from "./exact.js";
import { Form } from "./form.js";
import { MARKS, NAMES, formatNumber } from "./motion.js";
import { Player } from "./player.js";
import { cell, expected } from "./quantities.js";

/** @typedef {import("./live_data.js").Setting} Setting */
/** @typedef {any} Answer the result of `answer` in worker.js */

const root = /** @type {HTMLElement} */ (document.getElementById("lesson"));
const find = (/** @type {string} */ name) => /** @type {HTMLElement} */ (root.querySelector(name));
/** Return an element of an engine's entry in the legend. @param {string} name @param {"way"|"figure"} part */
const legend = (name, part) => find(`.legend .method-${MARKS[name]} .${part}`);
const calm = matchMedia("(prefers-reduced-motion: reduce)");
const figure = find("figure");
const player = new Player(figure);
const form = new Form(root);
const lens = player.lens;
const parts = /** @type {HTMLElement[]} */ ([...root.querySelectorAll(".part")]);
/** @type {Worker|null} */
let worker = null;
/** @type {Map<number, {resolve: (result: any) => void, reject: (why: Error) => void}>} */
const asked = new Map();
let number = 0;
let scrolled = false; // whether the reader has scrolled; only then the experiment in the window is shown
let jumping = false; // whether the page has scrolled to a linked experiment, and the reader has not acted since
/** @type {Answer} */
let shown = null;
/** @type {number[]|null} the poses at which the reader released the mechanism */
let start = null;
let startScene = -1; // the scene of these poses
/** @type {WeakMap<Element, Record<string, number>>} the positions of sliders that the reader's answer to an experiment runs */
const answered = new WeakMap();
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
  worker.onmessage = ({ data: { id, result, why } }) => {
    const one = asked.get(id);
    asked.delete(id);
    if (why) one?.reject(new Error(why));
    else one?.resolve(result);
  };
  worker.onerror = (event) => failed(new Error(event.message || "their script could not be loaded. Check the network, then reload the page"));
  ask({ kind: "load", folder: base, packages: `${base}packages/`, wanted: (root.dataset.engines ?? "").split(" ") }).catch(failed);
  find(".status").textContent = "Loading the engines.";
}

/** @param {unknown} reason */
function failed(reason) {
  for (const name in NAMES) legend(name, "figure").textContent = "";
  find(".status").textContent = `The engines could not be run: ${reason instanceof Error ? reason.message : reason}`;
}

/** Run the settings of the form; of the requests during a run, only the last one is answered. The labels and the legend show
 * the new settings at once. @param {boolean} play */
function run(play) {
  if (startScene !== form.index) start = null;
  const ways = Object.fromEntries(Object.keys(NAMES).map((name) => [name, [NAMES[name], form.words(name), ...form.changed(name)].join(", ")]));
  waiting = { setting: form.setting(start), play, ways };
  form.label(shown?.idle ?? [], shown?.own ?? {});
  for (const name in NAMES) {
    legend(name, "way").textContent = ways[name];
    legend(name, "figure").textContent = "…";
  }
  if (!busy) requestAnimationFrame(next);
}

/** Wait until the next picture is drawn: a long task would block the page. */
const pause = () => new Promise((resolve) => requestAnimationFrame(() => setTimeout(resolve)));

async function next() {
  if (!waiting || busy) return;
  const { setting, play, ways } = waiting;
  [waiting, busy] = [null, true];
  try {
    load();
    const answer = await ask({ setting });
    await show(answer, play, ways);
    if (answer.exact.computed && !waiting) {
      const missed = await ask({ kind: "check", setting });
      if (shown === answer) find(".status").textContent = statusOf(answer, missed);
    }
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

/** @param {Answer} answer @param {boolean} play @param {Record<string, string>} ways */
async function show(answer, play, ways) {
  shown = answer;
  const { motions, lost } = answer;
  const motionOf = (/** @type {string} */ name) => motions.find((/** @type {any} */ each) => each.name === name);
  player.stop();
  player.stage.outerHTML = stage(answer);
  find(".springs").textContent = springWords(motionOf("mujoco"), answer);
  player.load(answer);
  await pause();
  lens.load(answer); // the width of the chart depends on whether there is a lens
  await pause();
  player.chartErrors(answer);
  await pause();
  lens.scale();
  for (const name in NAMES) {
    legend(name, "way").textContent = `${ways[name]}${motionOf(name)?.why ? " (stored)" : ""}`;
    find(`.legend .method-${MARKS[name]}`).classList.toggle("lost", name in lost);
    if (name in lost) legend(name, "figure").textContent = lost[name];
  }
  form.label(answer.idle, answer.own);
  find(".status").textContent = statusOf(answer, null);
  root.classList.add("ready");
  find(".next").hidden = !motionOf("munk")?.impulses || !answer.joints.length;
  find(".sweeps").hidden = true;
  figure.classList.add("can-grab");
  find(".frame").tabIndex = answer.mechanism ? 0 : -1;
  if (play && !calm.matches) player.play(true);
  else if (play) {
    player.frame = answer.playback.stopAt;
    player.show();
  }
}

/** Return a text on the spring that closes MuJoCo's loop. @param {any} motion of MuJoCo, or undefined @param {Answer} answer */
function springWords(motion, { joints, blades, forces }) {
  if (!motion || !(joints.length + blades.length)) return "";
  const contact = blades.length || forces.some((/** @type {any} */ each) => each.contact);
  if (!motion.spring) return contact ? "" : "MuJoCo needs no spring here: its joints are hinges of a tree, which cannot open.";
  const [k, b, impedance] = motion.spring; // stiffness [1/s^2] and damping [1/s] for a unit of inertia, impedance [1]
  return `MuJoCo enforces this ${contact ? "contact" : "loop"} by a spring and a damper: a gap decays in about ${formatNumber(2000 / b)} ms, and an acceleration a that opens it leaves a gap of (1 − d)/(d k) a: ${formatNumber((1 - impedance) / (impedance * k) * 1e6)} µm for each m/s².`;
}

/** @param {Answer} answer @param {number|null} missed the error of the page's exact motion; null: not known */
function statusOf({ exact, motions, versions, release }, missed) {
  const error = missed === null ? "" : `, with an error of at most ${formatNumber(Math.max(missed, 1e-15))} m or rad`;
  const own = exact.computed ? `The page computes this exact motion itself${error}. ` : "";
  const apart = motions.filter((/** @type {any} */ each) => each.apart !== null).map((/** @type {any} */ { name, apart: by }) =>
    `${NAMES[name]} in the page${name === "mujoco" ? ` (${release})` : ""} and ${versions[name]} in Python differ by at most ${formatNumber(by)} m or rad.`);
  const stored = motions.filter((/** @type {any} */ each) => each.why).map((/** @type {any} */ { name, why }) =>
    `${NAMES[name]}: ${why}. The picture shows the stored motion of Python.`);
  return own + [...apart, ...stored].join(" ");
}

/** Show an experiment in the picture, with the positions of sliders that differ from the experiment's start.
 * @param {HTMLElement} part @param {Record<string, number>} places @param {boolean} play */
function stageOf(part, places, play) {
  start = null;
  scrolled = false;
  select(part, places);
  player.boxes.forEach((box) => (box.checked = (part.dataset.shown ?? "").split(" ").includes(box.value)));
  form.mark(part);
  run(play);
}

/** Set the sliders. @param {HTMLElement} part @param {Record<string, number>} places */
function select(part, places) {
  form.move(Number(part.dataset.scene), { ...JSON.parse(part.dataset.before ?? "{}"), ...places });
}

/** Run the settings before and after the change, and those that a wrong answer proposes; show them side by side.
 * @param {HTMLElement} part @param {HTMLElement} button */
async function guessed(part, button) {
  for (const each of /** @type {NodeListOf<HTMLElement>} */ (part.querySelectorAll(".answers button"))) {
    each.setAttribute("aria-pressed", String(each === button));
    each.classList.toggle("right", each.dataset.right !== undefined);
  }
  const right = button.dataset.right !== undefined;
  const why = /** @type {HTMLDetailsElement} */ (part.querySelector(".why"));
  const measured = /** @type {HTMLElement} */ (part.querySelector(".measured"));
  const verdict = right ? "Right." : "Not so.";
  if (part.dataset.after === "{}") {
    [why.open, measured.textContent] = [true, verdict]; // the question is not about an engine
    return;
  }
  const own = right || !button.dataset.change ? null : JSON.parse(button.dataset.change);
  const after = JSON.parse(part.dataset.after ?? "{}");
  const quantities = JSON.parse(part.dataset.quantities ?? "[]");
  const proposed = own && Object.keys(own).length > 0;
  /** @type {{label: string, places: Record<string, number>}[]} */
  const runs = [{ label: "before", places: {} }];
  if (proposed) runs.push({ label: `your answer: ${button.textContent}`, places: own });
  runs.push({ label: proposed ? `the right answer: ${part.querySelector("[data-right]")?.textContent}` : "now", places: after });
  load();
  answered.set(part, runs[1].places);
  const answers = [];
  for (const { places } of runs) {
    select(part, places);
    answers.push(await ask({ setting: form.setting(null), quantities }).catch(failed));
  }
  stageOf(part, runs[1].places, true);
  why.open = true;
  measured.textContent = answers.includes(undefined) ? verdict : `${verdict} Largest errors:`;
  if (!answers.includes(undefined)) compare(part, runs, answers, right ? null : button);
}

/** Fill the table of the runs of a question; a click on the name of a run shows it in the picture.
 * @param {HTMLElement} part @param {{label: string, places: Record<string, number>}[]} runs @param {Answer[]} answers
 * @param {HTMLElement|null} wrong the wrong answer, whose prediction gets a line */
function compare(part, runs, answers, wrong) {
  const table = /** @type {HTMLTableElement} */ (part.querySelector(".compared"));
  const exact = answers.some(({ quantities }) => quantities.some((/** @type {any} */ each) => each.found.exact));
  const names = [...(exact ? ["exact"] : []), ...Object.keys(NAMES).filter((name) => answers.some(({ motions }) => motions.some((/** @type {any} */ each) => each.name === name)))];
  const [head, body] = [document.createElement("thead"), document.createElement("tbody")];
  const heading = (/** @type {"col"|"row"} */ scope, /** @type {string|Element} */ content) => {
    const made = Object.assign(document.createElement("th"), { scope });
    made.append(content);
    return made;
  };
  head.insertRow().append(...["run", ...names].map((name) => heading("col", NAMES[name] ?? (name === "exact" ? "exact motion" : name))));
  runs.forEach(({ label, places }, index) => {
    const row = body.insertRow();
    const show = Object.assign(document.createElement("button"), { type: "button", textContent: label });
    show.addEventListener("click", () => stageOf(part, places, true));
    row.append(heading("row", show));
    for (const name of names) row.insertCell().textContent = cell(name, answers[index], index ? answers[0] : null);
  });
  const times = JSON.parse(wrong?.dataset.times ?? "{}");
  if (wrong && Object.keys(times).length) {
    const row = body.insertRow(1);
    row.append(heading("row", `expected with your answer: ${wrong.textContent}`));
    for (const name of names) row.insertCell().textContent = expected(name, times[name], answers[0], wrong.dataset.of);
  }
  table.replaceChildren(head, body);
  table.hidden = false;
}

/** Store changes by the reader in the address. */
function changed() {
  if (startScene !== form.index) start = null;
  history.replaceState(history.state, "", form.link(start));
  run(true);
}

/** Store the state of a widget in the address. @param {Event} event */
function widgetChanged({ target }) {
  const part = target instanceof Element ? target.closest(".part") : null;
  if (part instanceof HTMLElement && !part.classList.contains("shown")) stageOf(part, {}, false);
  history.replaceState(history.state, "", form.link(start));
}

/** Restore the state that the address stores. @returns {boolean} */
function restored() {
  const found = form.restore(location.hash);
  if (!found) return false;
  [start, startScene] = [found.start, form.index];
  run(false);
  jumping = true;
  found.part?.scrollIntoView();
  return true;
}

function begin() {
  for (const part of parts) {
    for (const button of /** @type {NodeListOf<HTMLElement>} */ (part.querySelectorAll(".answers button"))) {
      button.addEventListener("click", () => guessed(part, button));
    }
    part.querySelector(".set")?.addEventListener("click", () => stageOf(part, {}, true));
  }
  for (const button of /** @type {NodeListOf<HTMLElement>} */ (root.querySelectorAll("button[data-way]"))) {
    button.addEventListener("click", () => {
      start = null;
      form.move(form.index, { munk: Number(button.dataset.way), mujoco: Number(button.dataset.way) });
      changed();
    });
  }
  form.onchange = changed;
  root.addEventListener("stored", widgetChanged);
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
    // The address stores these digits; the page closes the joints again.
    start = held && [...held].map((value) => Number(value.toFixed(4)));
    startScene = form.index;
    held = null;
    changed();
  });
  // One jump causes several scroll events, since the page's height changes while it loads. Only an action of the reader ends it.
  for (const action of ["wheel", "touchmove", "pointerdown", "keydown"]) addEventListener(action, () => (jumping = false), { passive: true });
  addEventListener("scroll", () => (scrolled ||= !jumping), { passive: true });
  // The picture shows the experiment on a line across the window, which a phone has below its picture. The first experiment loads the engines.
  const linked = restored();
  const looking = new IntersectionObserver((entries) => {
    const near = entries.filter(({ target, isIntersecting }) => isIntersecting && !target.classList.contains("shown"));
    for (const { target } of scrolled ? near : []) {
      if (target instanceof HTMLElement) stageOf(target, answered.get(target) ?? {}, true);
    }
  }, { rootMargin: matchMedia("(max-width: 52rem)").matches ? "-48% 0px -52% 0px" : "-28% 0px -72% 0px" });
  for (const part of parts) looking.observe(part);
  // The load event would lay out these changes together with the page.
  if (!linked) pause().then(() => !waiting && !busy && stageOf(parts[0], {}, true));
  addEventListener("hashchange", restored);
  Object.assign(window, { crosscheck: { ask, form, setting: () => form.setting(start) } });
}

begin();
