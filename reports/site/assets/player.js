// @ts-check
/** An animated picture with overlays, whose mechanism the reader can drag. */

import { errorChart, svg } from "./chart.js";
import { Lens } from "./lens.js";
import { ARROWS, UNITS, distance, onDrag, pathThrough, placed, pointerIn, poseAt, put, formatNumber } from "./motion.js";
import { OVERLAYS } from "./overlays.js";

/** @typedef {import("./motion.js").Take} Take */

/** Return the path of a body's point. @param {ArrayLike<number>} pose @param {number} bodies @param {number} body @param {number[]} point */
function pathOf(pose, bodies, body, point) {
  const points = Array.from({ length: pose.length / (3 * bodies) }, (_, frame) => placed(poseAt(pose, bodies, frame, body), point));
  return pathThrough(points.filter(([x, y]) => Number.isFinite(x + y)), 4);
}

export class Player {
  /** @param {HTMLElement} figure */
  constructor(figure) {
    const find = (/** @type {string} */ name) => /** @type {HTMLElement} */ (figure.querySelector(name));
    this.figure = figure;
    this.time = /** @type {HTMLInputElement} */ (find(".time input"));
    this.clock = find(".clock");
    this.button = /** @type {HTMLButtonElement} */ (find(".play"));
    this.remark = find(".remark");
    this.chart = find(".errors");
    this.lens = new Lens(find(".lens"));
    this.boxes = /** @type {HTMLInputElement[]} */ ([...figure.querySelectorAll(".overlays input")]);
    /** @type {Element[][]} the drawn bodies of each motion */
    this.groups = [];
    /** @type {Take|null} */
    this.take = null;
    this.frame = 0;
    this.playing = false;
    /** @type {(time: number) => void} */
    this.mark = () => {};
    /** @type {ArrayLike<number>[]} the drawn poses of each motion, and the exact ones */
    this.drawn = [];
    for (const box of this.boxes) box.addEventListener("change", () => this.draw());
    this.time.addEventListener("input", () => {
      this.stop();
      this.frame = Number(this.time.value);
      this.show();
    });
    this.button.addEventListener("click", () => (this.playing ? this.stop() : this.play(false)));
  }

  get stage() {
    return /** @type {SVGSVGElement} */ (this.figure.querySelector("svg.stage"));
  }

  /** Use a drawing with a group for each motion; the exact motion is last. @param {Take} take */
  load(take) {
    this.take = take;
    this.groups = [...this.stage.querySelectorAll(".motion")].map((group) => [...group.querySelectorAll(".body")]);
    [this.time.min, this.time.max] = take.window.map(String);
    this.frame = Math.min(Math.max(this.frame, take.window[0]), take.window[1]);
    const { enlarged } = take.playback;
    for (const box of this.boxes) {
      const there = box.value === "enlarged" ? enlarged > 1 : box.value === "paths" ? take.traces.length > 0 : OVERLAYS[box.value].there(take);
      const label = /** @type {HTMLElement} */ (box.closest("label"));
      box.disabled = label.hidden = !there;
      label.querySelector("span")?.replaceChildren(String(enlarged)); // only the label of "enlarged" has a number
    }
    this.lens.take = null; // loaded by its own task
    this.draw();
  }

  /** Compute the drawn poses, with enlarged differences where the reader wants them; draw the paths and the shown instant. */
  draw() {
    const { take } = this;
    if (!take) return;
    const factor = this.on("enlarged") ? take.playback.enlarged : 1;
    const exact = take.exact.pose;
    const pose = (/** @type {ArrayLike<number>} */ own) => (factor === 1 ? own : Float64Array.from(own, (value, k) => exact[k] + factor * (value - exact[k])));
    this.drawn = [...take.motions.map((motion) => pose(motion.pose)), exact];
    this.lens.enlarged = factor;
    this.stage.querySelectorAll(".traces").forEach((group, index) => group.replaceChildren(
      ...take.traces.map(({ body, point }) => svg("path", { class: "trace", d: pathOf(this.drawn[index], take.bodies.length, body, point) })),
    ));
    this.show();
  }

  /** Show the errors in the chart and in the legend. @param {Take} take */
  chartErrors({ t, motions, measure }) {
    this.mark = errorChart(this.chart, t, motions, measure);
    for (const { mark, error } of motions) {
      const place = this.figure.querySelector(`.legend .method-${mark} .figure`);
      if (place) place.textContent = `up to ${formatNumber(error)} ${UNITS[measure]}`;
    }
  }

  /** @param {boolean} anew true: from the first frame to the largest difference; false: from here to the end */
  play(anew) {
    if (!this.take) return;
    const [first, last] = this.take.window;
    const { schedule, stopAt } = this.take.playback;
    const end = anew ? stopAt : last;
    if (anew || this.frame >= last) this.frame = first;
    this.playing = true;
    this.button.textContent = "Pause";
    this.button.setAttribute("aria-pressed", "true");
    const begin = performance.now() / 1000 - schedule[this.frame];
    const take = this.take;
    const step = (/** @type {number} */ now) => {
      if (!this.playing || this.take !== take) return;
      const passed = now / 1000 - begin;
      while (this.frame < end && schedule[this.frame + 1] <= passed) this.frame++;
      this.show();
      if (this.frame >= end) this.stop();
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

  /** Draw the shown instant. */
  show() {
    const { take, frame } = this;
    if (!take) return;
    this.groups.forEach((group, index) => {
      group.forEach((element, body) => {
        const [x, y, angle] = poseAt(this.drawn[index], take.bodies.length, frame, body);
        const there = Number.isFinite(x + y + angle);
        element.setAttribute("visibility", there ? "visible" : "hidden");
        if (there) put(element, x, y, angle);
      });
    });
    this.stage.classList.toggle("paths", this.on("paths"));
    this.time.value = String(frame);
    this.clock.textContent = `${take.t[frame].toFixed(3)} s${take.playback.slower > 1 ? `, ${take.playback.slower} × slower` : ""}`;
    this.time.setAttribute("aria-valuetext", this.clock.textContent);
    this.mark(take.t[frame]);
    const overlay = /** @type {SVGGElement} */ (this.stage.querySelector(".overlay"));
    overlay.replaceChildren();
    const width = this.stage.viewBox.baseVal.width;
    const remarks = Object.entries(OVERLAYS).map(([name, { draw }]) => (this.on(name) ? draw({ take, frame, overlay, width }) : ""));
    this.lens.show(frame);
    if (this.on("enlarged")) remarks.unshift(`The engines' differences from the exact motion are drawn ${take.playback.enlarged} times as large.`);
    this.remark.textContent = remarks.filter(Boolean).join(" ");
  }

  /** Return the frame near the shown one at which a body's point is nearest to the pointer. @param {Take} take @param {number} body @param {number[]} point @param {number[]} wanted */
  nearest({ window: [first, last], exact, bodies }, body, point, wanted) {
    const reach = Math.ceil((last - first) / 10); // a motion may return to a place, so distant frames do not count
    const away = (/** @type {number} */ frame) => distance(poseAt(exact.pose, bodies.length, frame, body), point, wanted);
    let best = this.frame;
    for (let frame = Math.max(first, this.frame - reach); frame <= Math.min(last, this.frame + reach); frame++) if (away(frame) < away(best)) best = frame;
    return best;
  }

  /** Let the reader drag a linkage anywhere, and another mechanism along its motion; `pull` gets the body, its point and the position of the pointer.
   * @param {(body: number, point: number[], wanted: number[]) => Float64Array|null} pull @param {() => void} release */
  grabbed(pull, release) {
    const place = /** @type {HTMLElement} */ (this.figure.querySelector(".frame"));
    /** @type {{body: number, point: number[]}|null} */
    let held = null;
    const hand = (/** @type {PointerEvent} */ event) => pointerIn(this.stage.querySelector(".world"), event);
    const press = (/** @type {PointerEvent} */ event) => {
      const take = this.take;
      if (!take) return false;
      const wanted = hand(event);
      const near = take.bodies.map((_, body) => poseAt(take.exact.pose, take.bodies.length, this.frame, body)).flatMap((pose, body) => {
        const own = take.joints.flatMap(({ first, second, firstPoint, secondPoint }) => [...(first === body ? [firstPoint] : []), ...(second === body ? [secondPoint] : [])]);
        return [[0, 0], ...own].map((point) => ({ body, point, away: distance(pose, point, wanted) }));
      }).sort((a, b) => a.away - b.away)[0];
      if (take.mechanism ? near.away > 0.15 * take.size || !pull(near.body, near.point, wanted) : near.away > take.size) return false;
      if (!take.mechanism) { // the point of the body at the pointer
        const [x, y, angle] = poseAt(take.exact.pose, take.bodies.length, this.frame, near.body);
        near.point = placed([0, 0, -angle], [wanted[0] - x, wanted[1] - y]);
      }
      this.stop();
      held = near;
      return true;
    };
    /** @type {Float64Array|null} */
    let pose = null;
    const follow = (/** @type {{body: number, point: number[]}} */ { body, point }, /** @type {number[]} */ wanted) => {
      if (this.take && !this.take.mechanism) {
        this.frame = this.nearest(this.take, body, point, wanted);
        return this.show();
      }
      pose = pull(body, point, wanted);
      for (const group of pose ? this.groups : []) {
        group.forEach((element, body) => put(element, ...poseAt(/** @type {Float64Array} */ (pose), group.length, 0, body)));
      }
      this.stage.querySelector(".overlay")?.replaceChildren();
    };
    place.addEventListener("keydown", (event) => {
      const by = ARROWS[event.key];
      const { take } = this;
      if (!take?.mechanism || !by) return;
      event.preventDefault();
      this.stop();
      // The far end of the last free bar, or its centre.
      const joint = take.joints.findLast(({ first }) => first >= 0);
      held = { body: joint?.first ?? take.bodies.length - 1, point: joint?.firstPoint ?? [0, 0] };
      const now = poseAt(pose ?? take.exact.pose, take.bodies.length, pose ? 0 : this.frame, held.body);
      follow(held, placed(now, held.point).map((value, axis) => value + 0.05 * take.size * by[axis]));
    });
    const end = () => {
      if (held && this.take?.mechanism) release();
      held = pose = null;
    };
    onDrag(place, { begin: press, move: (event) => held && follow(held, hand(event)), end });
    place.addEventListener("keyup", end);
  }
}
