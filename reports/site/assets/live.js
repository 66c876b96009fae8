// @ts-check
/** The part of a lesson in which sliders act on the engines themselves. */

import { scatter, svg } from "./chart.js";
import { doubles, drawingOf, jointsOf, stepOf, times, truth, whyNot } from "./live_data.js";
import { load, runMujoco, runMunk } from "./live_engines.js";
import { Form } from "./live_form.js";
import { UNITS, errors, largestGap, placed, told } from "./motion.js";
import { Player } from "./player.js";

/** @typedef {import("./live_data.js").Setting} Setting */
/** @typedef {import("./live_data.js").Scene} Scene @typedef {import("./live_data.js").Drawing} Drawing */
/** @typedef {"munk"|"mujoco"} Name */
/** @typedef {{name: Name, pose: Float64Array, milliseconds: number, mark: number}} Run */

const WORDS = { munk: "Munk2D, the engine in pymunk", mujoco: "MuJoCo" };
const MARKS = { munk: 1, mujoco: 2 };
const root = /** @type {HTMLElement} */ (document.getElementById("live"));
const status = /** @type {HTMLElement} */ (root.querySelector(".status"));
const table = /** @type {HTMLTableElement} */ (root.querySelector("table"));
const place = (/** @type {string} */ name) => /** @type {HTMLElement} */ (root.querySelector(name));

/** The drawing of a place of the sliders: bodies of each run, and of the truth over them.
 * @param {Drawing} drawing @param {number[]} marks */
function stage(drawing, marks) {
  const bodies = drawing.bodies.map((shape) => `<g class="body">${shape}</g>`).join("");
  const kinds = [...marks.map((mark) => `method method-${mark}`), "truth"];
  const groups = kinds.map((kind) => `<g class="motion ${kind}"><g class="traces"></g>${bodies}</g>`).join("");
  return (
    `<svg class="stage" viewBox="${drawing.box}" role="img" aria-label="The mechanism"><g class="world" ` +
    `transform="scale(1 -1)"><g class="ground">${drawing.ground}</g>${groups}<g class="overlay"></g></g></svg>`
  );
}

/** The path of a body's point. @param {ArrayLike<number>} pose @param {number} bodies @param {number} body @param {number[]} point */
function pathOf(pose, bodies, body, point) {
  let path = "";
  for (let start = 3 * body; start < pose.length; start += 3 * bodies) {
    const [x, y] = placed([pose[start], pose[start + 1], pose[start + 2]], point);
    if (Number.isFinite(x + y)) path += `${path ? "L" : "M"}${x.toFixed(4)} ${y.toFixed(4)}`;
  }
  return path;
}

/** Values that charts can have: what blew up is no number. @param {Float64Array} pose */
const finite = (pose) => pose.map((value) => (Math.abs(value) < 1e6 ? value : NaN));

/** Run every engine that is there and can. @param {Setting} now @param {Record<Name, any>} engines */
function runs(now, engines) {
  /** @type {Run[]} */
  const found = [];
  for (const name of /** @type {Name[]} */ (["munk", "mujoco"])) {
    if (!engines[name] || whyNot(now, name)) continue;
    const before = performance.now();
    const pose = finite((name === "munk" ? runMunk : runMujoco)(engines[name], now));
    found.push({ name, pose, milliseconds: performance.now() - before, mark: MARKS[name] });
  }
  return found;
}

/** How far each run is from what Python's engine of its release made of the same model.
 * @param {Scene} scene @param {Run[]} found @param {any} engines */
function apart(scene, found, engines) {
  const own = { munk: "Munk2D", mujoco: `MuJoCo ${engines.mujoco?.mj_versionString?.() ?? ""}`.trim() };
  const told_ = found.map(({ name, pose }) => {
    const { version, pose: kept } = scene.native[name];
    if (!kept) return `${own[name]} is not compared: Python's ${version} has no stored run of this.`;
    const native = doubles(kept);
    const most = pose.reduce((largest, value, index) => Math.max(largest, Math.abs(value - native[index])), 0);
    root.dataset[`apart_${name}`] = String(most);
    return `${own[name]} in this page and ${version} in Python: poses at most ${told(most)} m or rad apart.`;
  });
  return `As shipped, ${told_.join(" ")}`;
}

/** @param {Record<Name, any>} engines @param {any[]} rows @param {Form} form */
function start(engines, rows, form) {
  const figure = /** @type {HTMLElement} */ (root.querySelector("figure"));
  /** @type {Player|null} */
  let player = null;

  const run = () => {
    form.label();
    const now = form.setting();
    const { scene } = now;
    const begin = performance.now();
    const exact = truth(now);
    const found = runs(now, engines);
    root.dataset.spent = (performance.now() - begin).toFixed(2);
    const t = times(now);
    const bodies = scene.bodies.length;
    const drawing = drawingOf(now);
    place(".frame").innerHTML = stage(drawing, found.map(({ mark }) => mark));
    root.querySelectorAll(".frame .traces").forEach((group, index) => {
      const pose = index < found.length ? found[index].pose : exact;
      for (const { body, point } of scene.traces) {
        group.append(svg("path", { class: "trace", d: pathOf(pose, bodies, body, point) }));
      }
    });
    const joints = jointsOf(now);
    const take = {
      t: Array.from(t), bodies: scene.bodies, joints, size: drawing.size, measure: scene.measure,
      truth: { pose: /** @type {any} */ (exact), twist: [] },
      motions: found.map(({ name, pose, mark }) => ({ name: WORDS[name], pose: /** @type {any} */ (pose), mark })),
      lost: [], forces: [], loose: [], centre: null, traces: scene.traces,
    };
    if (player) player.load(take);
    else player = new Player(figure, take);
    const results = found.map(({ name, pose, milliseconds, mark }) => {
      const error = errors(exact, pose, bodies, t.length)[scene.measure].reduce((a, b) => Math.max(a, b), 0);
      return { name, mark, error, gap: largestGap(joints, pose, bodies, t.length), milliseconds };
    });
    show(now, results, joints.length > 0);
    for (const mark of [1, 2]) place(`.legend .method-${mark}`)?.toggleAttribute("hidden", !found.some((each) => each.mark === mark));
    scatter(
      place(".stored"), rows.filter((row) => row.scene === scene.scene), scene.measure,
      results.map(({ error, name, mark }) => ({ x: stepOf(now), y: error, mark, name: `${WORDS[name]}, now` })),
    );
    if (form.untouched) place(".apart").textContent = apart(scene, found, engines);
    history.replaceState(null, "", form.link);
  };
  form.form.addEventListener("input", run);
  for (const button of root.querySelectorAll("button[data-preset]")) {
    if (!(button instanceof HTMLButtonElement)) continue;
    button.addEventListener("click", () => {
      form.move(JSON.parse(button.dataset.preset ?? "{}"), button.dataset.anew !== undefined);
      place(".expected").textContent = button.dataset.expected ?? "";
      run();
    });
  }
  form.choice.addEventListener("input", () => (place(".expected").textContent = ""));
  run();
  Object.assign(window, { crosscheckLive: { engines, form, truth, runMujoco, runMunk } });
}

/** The table of results, and why an engine is not in it.
 * @param {Setting} now @param {{name: Name, error: number, gap: number, milliseconds: number}[]} results @param {boolean} gaps */
function show(now, results, gaps) {
  const unit = UNITS[now.scene.measure];
  place("th.error").textContent = now.scene.measure === "angle" ? `angle error [${unit}]` : `place error [${unit}]`;
  table.tBodies[0].replaceChildren(...results.map(({ name, error, gap, milliseconds }) => {
    const row = document.createElement("tr");
    for (const text of [WORDS[name], told(error), gaps ? told(gap) : "–", milliseconds.toFixed(1)]) row.insertCell().textContent = text;
    return row;
  }));
  const why = /** @type {Name[]} */ (["munk", "mujoco"]).map((name) => [WORDS[name], whyNot(now, name)]);
  place(".why").textContent = why.filter(([, reason]) => reason).map(([name, reason]) => `${name} can't run this: ${reason}.`).join(" ");
  root.dataset.errors = JSON.stringify(Object.fromEntries(results.map(({ name, error }) => [name, error])));
}

async function begin() {
  const folder = root.dataset.folder ?? "";
  try {
    const read = async (/** @type {string} */ name) => (await fetch(`${folder}live/${name}.json`)).json();
    const [rows, engines, ...scenes] = await Promise.all([
      read("rows"), load(`${folder}packages/`), ...(root.dataset.scenes ?? "").split(" ").map(read),
    ]);
    const form = new Form(root, scenes);
    const linked = form.restore(location.hash);
    start(engines, rows, form);
    status.textContent = "";
    root.classList.add("ready");
    if (linked) root.scrollIntoView();
  } catch (reason) {
    status.textContent = `The engines could not be loaded: ${reason instanceof Error ? reason.message : reason}`;
  }
}

begin();
