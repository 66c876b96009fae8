// @ts-check
/** The controls of a lesson, the numbers in the text that set them, and the link that stores them. */

import { onDrag } from "./motion.js";

/** @typedef {import("./live_data.js").Setting} Setting */

const LINK = "#set&";

export class Form {
  /** @param {HTMLElement} root */
  constructor(root) {
    this.root = root;
    this.form = /** @type {HTMLFormElement} */ (root.querySelector(".settings form"));
    this.choice = /** @type {HTMLSelectElement} */ (this.form.elements.namedItem("scene"));
    this.inputs = /** @type {HTMLInputElement[]} */ ([...this.form.querySelectorAll("input[name]")]);
    this.scenes = JSON.parse(root.dataset.scenes ?? "[]");
    this.onchange = () => {};
    this.form.addEventListener("submit", (event) => event.preventDefault());
    this.form.addEventListener("input", () => this.onchange());
    for (const number of root.querySelectorAll(".drag")) if (number instanceof HTMLElement) this.draggable(number);
  }

  get index() {
    return Number(this.choice.value);
  }

  /** Return a slider of the selected scene or of an engine. @param {string} name */
  input(name) {
    const own = `${this.index}.${name}`;
    return this.inputs.find((input) => input.name === own) ?? this.inputs.find((input) => input.name === name);
  }

  /** @param {string} name */
  place(name) {
    return Number(this.input(name)?.value ?? 0);
  }

  /** Return the value of a slider. @param {string} name */
  value(name) {
    return JSON.parse(this.input(name)?.dataset.values ?? "[null]")[this.place(name)];
  }

  /** Return the label of a slider's value. @param {string} name */
  words(name) {
    return JSON.parse(this.input(name)?.dataset.words ?? '[""]')[this.place(name)];
  }

  /** Return labels of an engine's settings that differ from the method's settings. @param {string} engine */
  changed(engine) {
    const own = this.inputs.filter((input) => input.closest("fieldset")?.dataset.engine === engine && input.value !== input.defaultValue && !input.disabled);
    return own.map(({ name }) => `${(this.input(name)?.closest("label")?.dataset.name ?? name)} ${this.words(name)}`);
  }

  /** Return the positions and values of all sliders. @param {number[]|null} start @returns {Setting} */
  setting(start) {
    const { key, fields } = this.scenes[this.index];
    const place = fields.reduce((/** @type {number} */ sum, /** @type {string} */ name) => sum * (Number(this.input(name)?.max) + 1) + this.place(name), 0);
    const ways = ["munk", "mujoco"];
    return {
      key, place, start, stepPlace: this.place("steps"), steps: this.value("steps"), munk: this.place("munk"), mujoco: this.place("mujoco"),
      .../** @type {any} */ (Object.fromEntries(this.inputs.filter(({ name }) => !name.includes(".")).map(({ name }) => [name, this.value(name)]))),
      own: !start && this.shown().every((input) => ways.some((way) => input.name.endsWith(`.${way}`)) || input.value === input.defaultValue),
    };
  }

  /** Return the sliders of the selected scene and of the engines. */
  shown() {
    return this.inputs.filter(({ name }) => !name.includes(".") || name.startsWith(`${this.index}.`));
  }

  /** Write the value of each slider beside it and in the text; disable the sliders in `idle`. @param {string[]} idle
   * @param {Record<string, string>} own values that the methods choose, by the name of the slider */
  label(idle, own) {
    for (const group of this.form.querySelectorAll("fieldset[data-scene]")) {
      if (group instanceof HTMLElement) group.hidden = group.dataset.scene !== this.choice.value;
    }
    for (const input of this.shown()) {
      const name = input.name.split(".").at(-1) ?? "";
      input.disabled = idle.includes(name);
      const chosen = this.value(name) === null && own[name] ? ` (${own[name]})` : "";
      const text = input.disabled ? "no effect here" : this.words(name) + chosen;
      const output = input.closest("label")?.querySelector(".value");
      if (output) output.textContent = text;
      input.setAttribute("aria-valuetext", text);
    }
    for (const number of this.root.querySelectorAll(".part.shown .drag")) {
      if (!(number instanceof HTMLElement)) continue;
      const input = this.input(number.dataset.name ?? "");
      const name = number.dataset.name ?? "";
      number.textContent = this.value(name) === null ? (own[name] ?? number.textContent) : this.words(name);
      number.setAttribute("aria-valuenow", input?.value ?? "0");
      number.setAttribute("aria-valuemax", input?.max ?? "0");
      number.setAttribute("aria-valuetext", number.textContent ?? "");
    }
  }

  /** Let the reader set a slider by dragging a number in the text, or by the arrow keys. @param {HTMLElement} number */
  draggable(number) {
    const part = /** @type {HTMLElement|null} */ (number.closest(".part"));
    const name = number.dataset.name ?? "";
    /** Return the place of the slider, after the part's own scene is selected. */
    const now = () => {
      const own = Number(part?.dataset.scene);
      if (own !== this.index) this.move(own, JSON.parse(part?.dataset.before ?? "{}"));
      this.mark(part);
      return this.place(name);
    };
    const to = (/** @type {number} */ place) => {
      const input = this.input(name);
      const wanted = String(Math.min(Math.max(place, 0), Number(input?.max)));
      if (!input || input.value === wanted) return;
      input.value = wanted;
      this.onchange();
    };
    let [from, begin] = [0, 0];
    onDrag(number, {
      begin: (event) => void ([from, begin] = [event.clientX, now()]),
      move: (event) => to(begin + Math.round((event.clientX - from) / 25)),
    });
    number.addEventListener("keydown", (event) => {
      const by = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, Home: -1000, End: 1000 }[event.key];
      if (!by) return;
      event.preventDefault();
      to(now() + by);
    });
  }

  /** Select a scene and positions of sliders; the other sliders get their start positions. @param {number} scene @param {Record<string, number>} places */
  move(scene, places) {
    this.choice.value = String(scene);
    for (const input of this.shown()) input.value = input.defaultValue;
    for (const [name, place] of Object.entries(places)) {
      const input = this.input(name);
      if (input) input.value = String(Math.min(place, Number(input.max)));
    }
  }

  /** Mark the experiment to which the picture belongs. @param {Element|null|undefined} part */
  mark(part) {
    for (const other of this.root.querySelectorAll(".part")) other.classList.toggle("shown", other === part);
    this.root.classList.toggle("at-widget", Boolean(part?.querySelector(".widget")));
  }

  /** Return the link that stores the marked experiment, the sliders and the poses of release. @param {number[]|null} start */
  link(start) {
    const parts = [...this.root.querySelectorAll(".part")];
    const part = 1 + parts.findIndex((each) => each.classList.contains("shown"));
    const released = start ? [`start=${start.join(",")}`] : [];
    const state = /** @type {HTMLElement|null} */ (this.root.querySelector(".part.shown .widget"))?.dataset.state;
    if (state) released.push(`state=${state}`);
    return `${LINK}${[`part=${part}`, `scene=${this.index}`, ...released, ...this.shown().filter(({ value, defaultValue }) => value !== defaultValue).map(({ name, value }) => `${name}=${value}`)].join("&")}`;
  }

  /** Set the sliders from a link and mark its experiment. Returns that experiment and the poses of release, or null if the link
   * stores no sliders; invalid parts are ignored. @param {string} link
   * @returns {{part: Element|undefined, start: number[]|null}|null} */
  restore(link) {
    if (!link.startsWith(LINK)) return null;
    const all = link.slice(LINK.length).split("&").map((part) => part.split("="));
    const given = all.filter(([, value]) => /^\d+$/.test(value ?? ""));
    const scene = Number(given.find(([name]) => name === "scene")?.[1] ?? 0);
    this.move(scene < this.scenes.length ? scene : 0, {});
    for (const [name, value] of given) {
      const input = this.inputs.find((each) => each.name === name);
      if (input && Number(value) <= Number(input.max)) input.value = value;
    }
    const parts = /** @type {HTMLElement[]} */ ([...this.root.querySelectorAll(".part")]);
    const ours = parts.filter((each) => Number(each.dataset.scene) === this.index);
    const named = parts[Number(given.find(([name]) => name === "part")?.[1]) - 1];
    const part = ours.includes(named) ? named : ours[0];
    this.mark(part);
    const widget = /** @type {HTMLElement|null} */ (part?.querySelector(".widget") ?? null);
    if (widget) widget.dataset.state = all.find(([name]) => name === "state")?.[1] ?? "";
    widget?.dispatchEvent(new Event("restore")); // a widget whose script comes later reads the state itself
    const start = (all.find(([name]) => name === "start")?.[1] ?? "").split(",").map(Number);
    return { part, start: start.length > 2 && start.every(Number.isFinite) ? start : null };
  }
}
