// @ts-check
/** The sliders of the live part: what they stand for, what is written beside them, and the link that holds them. */

import { placeOf, stepOf } from "./live_data.js";
import { told } from "./motion.js";

/** @typedef {import("./live_data.js").Scene} Scene @typedef {import("./live_data.js").Setting} Setting */

const LINK = "#live&";

export class Form {
  /** @param {HTMLElement} root @param {Scene[]} scenes */
  constructor(root, scenes) {
    this.root = root;
    this.scenes = scenes;
    this.form = /** @type {HTMLFormElement} */ (root.querySelector("form"));
    this.choice = /** @type {HTMLSelectElement} */ (this.form.elements.namedItem("scene"));
    this.inputs = /** @type {HTMLInputElement[]} */ ([...this.form.querySelectorAll("input[name]")]);
    this.form.addEventListener("submit", (event) => event.preventDefault());
  }

  get index() {
    return Number(this.choice.value);
  }

  /** A slider of the present scene, or of an engine. @param {string} name */
  input(name) {
    const own = `${this.index}.${name}`;
    return this.inputs.find((input) => input.name === own) ?? this.inputs.find((input) => input.name === name);
  }

  /** @param {string} name @param {number} otherwise */
  place(name, otherwise = 0) {
    const input = this.input(name);
    return input ? Number(input.value) : otherwise;
  }

  /** What a slider stands for. @param {string} name @param {any} otherwise */
  value(name, otherwise = undefined) {
    const input = this.input(name);
    return input ? JSON.parse(input.dataset.values ?? "[]")[Number(input.value)] : otherwise;
  }

  /** The present places of all sliders. @returns {Setting} */
  setting() {
    const scene = this.scenes[this.index];
    const steps = this.value("steps");
    return {
      scene, stepPlace: this.place("steps"), steps, every: Math.max(1, steps / scene.frames), tempo: this.value("tempo", 1),
      place: placeOf(scene, scene.sliders.map(({ name }) => this.place(name))),
      munk: this.place("munk"), mujoco: this.place("mujoco"),
      integrator: this.value("integrator"), timeConstant: this.value("timeConstant"),
      impedance: this.value("impedance"), solverIterations: this.value("solverIterations"),
      tolerance: this.value("tolerance"), iterations: this.value("iterations"), bias: this.value("bias"),
    };
  }

  /** Whether everything stands as the page was made: then Python's engines have run the same. */
  get untouched() {
    return this.shown().every((input) => input.value === input.defaultValue);
  }

  /** The sliders of the present scene and of the engines. */
  shown() {
    return this.inputs.filter(({ name }) => !name.includes(".") || name.startsWith(`${this.index}.`));
  }

  /** Write beside each slider what it stands for; what has no meaning for this motion can't be moved. */
  label() {
    const now = this.setting();
    for (const group of this.form.querySelectorAll("fieldset[data-scene]")) {
      if (group instanceof HTMLElement) group.hidden = group.dataset.scene !== this.choice.value;
    }
    for (const button of this.root.querySelectorAll("button[data-of]")) {
      if (button instanceof HTMLElement) button.hidden = button.dataset.of !== this.choice.value;
    }
    const way = now.scene.mujoco[now.mujoco];
    const springs = "springs" in way && way.springs;
    for (const input of this.shown()) {
      const words = JSON.parse(input.dataset.words ?? "[]");
      let text = input.name.endsWith(".steps") ? `${told(stepOf(now) * 1000)} ms` : words[Number(input.value)];
      if (input.name === "timeConstant" || input.name === "impedance") {
        input.disabled = !springs;
        if (!springs) text = "of no effect: this model has no spring";
      }
      const output = input.closest("label")?.querySelector(".value");
      if (output) output.textContent = text;
      input.setAttribute("aria-valuetext", text);
    }
  }

  /** Move sliders to places, the others as shipped if `anew`. @param {Record<string, number>} places @param {boolean} anew */
  move(places, anew) {
    if (anew) for (const input of this.shown()) input.value = input.defaultValue;
    for (const [name, place] of Object.entries(places)) {
      const input = this.input(name);
      if (input) input.value = String(Math.min(place, Number(input.max)));
    }
  }

  /** The link that holds the sliders. */
  get link() {
    return `${LINK}${[`scene=${this.index}`, ...this.shown().map(({ name, value }) => `${name}=${value}`)].join("&")}`;
  }

  /** The sliders as a link has them; what a link has wrong is left alone. @param {string} link */
  restore(link) {
    if (!link.startsWith(LINK)) return false;
    for (const part of link.slice(LINK.length).split("&")) {
      const [name, value] = part.split("=");
      if (!/^\d+$/.test(value ?? "")) continue;
      if (name === "scene" && Number(value) < this.scenes.length) this.choice.value = value;
      const input = this.inputs.find((each) => each.name === name);
      if (input && Number(value) <= Number(input.max)) input.value = value;
    }
    return true;
  }
}
