// @ts-check
/** A picture that moves: what a page shows at rest is moved, dragged, and given what can be switched on over it. */

import { errorChart } from "./chart.js";
import { UNITS, errors, largestGap, poseAt, told } from "./motion.js";
import { OVERLAYS } from "./overlays.js";

/** @typedef {import("./motion.js").Take} Take */

const SECONDS = 6; // how long a motion takes to play, however fast it was

export class Player {
  /** @param {HTMLElement} figure @param {Take} take */
  constructor(figure, take) {
    this.figure = figure;
    this.controls = /** @type {HTMLElement} */ (figure.querySelector(".controls"));
    this.time = /** @type {HTMLInputElement} */ (figure.querySelector(".time input"));
    this.clock = /** @type {HTMLElement} */ (figure.querySelector(".clock"));
    this.button = /** @type {HTMLButtonElement} */ (figure.querySelector(".play"));
    this.remark = /** @type {HTMLElement} */ (figure.querySelector(".remark"));
    this.chart = /** @type {HTMLElement} */ (figure.querySelector(".errors"));
    this.boxes = /** @type {HTMLInputElement[]} */ ([...figure.querySelectorAll(".overlays input")]);
    this.stage = /** @type {SVGSVGElement} */ (figure.querySelector("svg.stage"));
    this.overlay = /** @type {SVGGElement} */ (this.stage.querySelector(".overlay"));
    /** @type {Element[][]} the drawn bodies of each motion */
    this.groups = [];
    /** @type {number[]} the largest of each motion [m] */
    this.gaps = [];
    this.bodies = take.bodies.length;
    this.frames = take.t.length;
    this.frame = 0;
    this.playing = false;
    /** @type {(time: number) => void} */
    this.mark = () => {};
    const on = (figure.dataset.on ?? "").split(" ");
    for (const box of this.boxes) {
      box.checked = on.includes(box.value);
      box.addEventListener("change", () => this.show());
    }
    this.time.addEventListener("input", () => {
      this.stop();
      this.frame = Number(this.time.value);
      this.show();
    });
    this.button.addEventListener("click", () => (this.playing ? this.stop() : this.play()));
    this.controls.hidden = false;
    this.chart.hidden = false;
    this.take = take;
    // At rest most motions have nothing to show: no gap is open yet, and forces are those of the start.
    if (on.some((word) => word !== "paths" && word)) this.frame = Math.round(0.4 * (take.t.length - 1));
    this.load(take);
  }

  /** Take over a drawing whose groups stand in the order of the motions, the truth last. @param {Take} take */
  load(take) {
    this.take = take;
    this.bodies = take.bodies.length;
    this.frames = take.t.length;
    this.stage = /** @type {SVGSVGElement} */ (this.figure.querySelector("svg.stage"));
    this.overlay = /** @type {SVGGElement} */ (this.stage.querySelector(".overlay"));
    this.groups = [...this.stage.querySelectorAll(".motion")].map((group) => [...group.querySelectorAll(".body")]);
    this.time.max = String(this.frames - 1);
    this.frame = Math.min(this.frame, this.frames - 1);
    for (const box of this.boxes) {
      const there = box.value === "paths" ? take.traces.length > 0 : OVERLAYS[box.value].there(take);
      box.disabled = !there;
      const row = box.closest("label");
      if (row) row.hidden = !there;
    }
    this.measure();
    this.show();
  }

  /** The errors of the motions, drawn and told. */
  measure() {
    const { take, bodies, frames } = this;
    const lines = take.motions.map((motion, index) => ({
      name: motion.name,
      mark: motion.mark ?? index + 1,
      values: errors(take.truth.pose, motion.pose, bodies, frames)[take.measure],
    }));
    this.mark = errorChart(this.chart, take.t, lines, take.measure);
    for (const line of lines) {
      const worst = line.values.reduce((a, b) => Math.max(a, b), 0);
      const place = this.figure.querySelector(`.legend .method-${line.mark} .figure`);
      if (place) place.textContent = `up to ${told(worst)} ${UNITS[take.measure]}`;
    }
    this.gaps = take.motions.map((motion) => largestGap(take.joints, motion.pose, bodies, frames));
  }

  play() {
    this.playing = true;
    this.button.textContent = "Pause";
    this.button.setAttribute("aria-pressed", "true");
    if (this.frame >= this.frames - 1) this.frame = 0;
    const begin = performance.now() - (this.frame / (this.frames - 1)) * SECONDS * 1000;
    const step = (/** @type {number} */ now) => {
      if (!this.playing) return;
      // The first frame may have begun before the button was pressed.
      const passed = Math.max(0, (now - begin) / 1000 / SECONDS);
      this.frame = Math.min(this.frames - 1, Math.floor(passed * (this.frames - 1)));
      this.show();
      if (this.frame >= this.frames - 1) this.stop();
      else requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  }

  stop() {
    this.playing = false;
    this.button.textContent = "Play";
    this.button.setAttribute("aria-pressed", "false");
  }

  /** @param {string} overlay */
  on(overlay) {
    return this.boxes.some((box) => box.value === overlay && box.checked && !box.disabled);
  }

  /** Draw the present instant. */
  show() {
    const { take, frame, bodies } = this;
    const motions = [...take.motions.map((motion) => motion.pose), take.truth.pose];
    this.groups.forEach((group, index) => {
      group.forEach((element, body) => {
        const [x, y, angle] = poseAt(motions[index], bodies, frame, body);
        const there = Number.isFinite(x + y + angle);
        element.setAttribute("visibility", there ? "visible" : "hidden");
        if (there) element.setAttribute("transform", `translate(${x} ${y}) rotate(${(angle * 180) / Math.PI})`);
      });
    });
    this.stage.classList.toggle("paths", this.on("paths"));
    this.time.value = String(frame);
    this.clock.textContent = `${take.t[frame].toFixed(3)} s`;
    this.time.setAttribute("aria-valuetext", this.clock.textContent);
    this.mark(take.t[frame]);
    this.overlay.replaceChildren();
    const { overlay, gaps } = this;
    const width = this.stage.viewBox.baseVal.width;
    const remarks = Object.entries(OVERLAYS).map(([name, { draw }]) => (this.on(name) ? draw({ take, frame, overlay, width, gaps }) : ""));
    this.remark.textContent = remarks.filter(Boolean).join(" ");
  }
}
