// @ts-check
/** Two shapes from a drawn motion: the reader draws the path of a point of a body that turns once, and both centrodes follow. */

import { ARROWS, onDrag, pathThrough, placed, pointerIn, put } from "./motion.js";
import { beginAll, remembered } from "./widget.js";

/** @typedef {import("./motion.js").Point} Point
 * @typedef {{cosines: Point[], sines: Point[]}} Series a closed path as a Fourier series: sum of cosines[k] cos(k t) + sines[k] sin(k t)
 * @typedef {{path: Point[], space: Point[], body: Point[], angles: number[]}} Shapes points at equal steps of the angle [m, rad] */

const HARMONICS = 3; // highest frequency of a drawn path, which makes the shapes smooth
const POINTS = 360; // points of each shape
const FEWER = 120; // points of the shapes among which a number of turns is selected; with 360 points a slow phone would be blocked for 60 ms
const STEP = { turn: 15, move: 0.02 }; // a press of a key [degrees, m]
const SMALL = 1e-9; // an extent of the path of the centre that counts as zero [m]
const ROUNDING = 1e-18; // a product of two areas [m^4]: a curve that is traced twice touches itself to rounding and does not cross itself

/** Return the series of a closed path through drawn points, which have equal distances along the path. @param {Point[]} drawn @returns {Series} */
export function seriesOf(drawn) {
  const closed = [...drawn, drawn[0]];
  const lengths = [0];
  for (let k = 1; k < closed.length; k++) lengths.push(lengths[k - 1] + Math.hypot(closed[k][0] - closed[k - 1][0], closed[k][1] - closed[k - 1][1]));
  const count = 128;
  const even = Array.from({ length: count }, (_, index) => {
    const wanted = (lengths[lengths.length - 1] * index) / count;
    const k = Math.max(1, lengths.findIndex((length) => length > wanted));
    const share = (wanted - lengths[k - 1]) / (lengths[k] - lengths[k - 1]);
    return [0, 1].map((axis) => closed[k - 1][axis] + share * (closed[k][axis] - closed[k - 1][axis]));
  });
  const part = (/** @type {(angle: number) => number} */ of, /** @type {number} */ k) => /** @type {Point} */ ([0, 1].map((axis) =>
    ((k ? 2 : 1) / count) * even.reduce((sum, point, index) => sum + point[axis] * of((2 * Math.PI * k * index) / count), 0)));
  const frequencies = [...Array(HARMONICS + 1).keys()];
  return { cosines: frequencies.map((k) => part(Math.cos, k)), sines: frequencies.map((k) => part(Math.sin, k)) };
}

/** Return a closed path whose point at the angle `t` is moved by `by` [m]. The points near it follow; the weights are those of
 * Fejér's kernel, which is nowhere negative. @param {Series} series @param {number} t [rad] @param {Point} by @returns {Series} */
export function pulled(series, t, by) {
  const added = (/** @type {Point[]} */ old, /** @type {(angle: number) => number} */ of) => Array.from({ length: HARMONICS + 1 }, (_, k) => {
    const weight = ((k ? 2 : 1) * (1 - k / (HARMONICS + 1)) * of(k * t)) / (HARMONICS + 1);
    return /** @type {Point} */ ([0, 1].map((axis) => (old[k]?.[axis] ?? 0) + weight * by[axis]));
  });
  return { cosines: added(series.cosines, Math.cos), sines: added(series.sines, Math.sin) };
}

/** Return both centrodes of a body whose point O' follows the path once while the body turns `turn` times.
 * The instant centre is at k x v / omega from O'. @param {Series} series @param {number} turn @param {number} [points] @returns {Shapes} */
export function shapesOf({ cosines, sines }, turn, points = POINTS) {
  /** @type {Shapes} */
  const out = { path: [], space: [], body: [], angles: [] };
  for (let index = 0; index <= points; index++) {
    const t = (2 * Math.PI * index) / points;
    const sum = (/** @type {number} */ axis, /** @type {boolean} */ rate) => cosines.reduce((total, _, k) => {
      const [a, b, c, s] = [cosines[k][axis], sines[k][axis], Math.cos(k * t), Math.sin(k * t)];
      return total + (rate ? k * (b * c - a * s) : a * c + b * s);
    }, 0);
    const [x, y, vx, vy] = [sum(0, false), sum(1, false), sum(0, true), sum(1, true)];
    const [rx, ry, angle] = [-vy / turn, vx / turn, turn * t];
    out.path.push([x, y]);
    out.space.push([x + rx, y + ry]);
    out.body.push(placed([0, 0, -angle], [rx, ry]));
    out.angles.push(angle);
  }
  return out;
}

/** Return the larger side of the box around points. @param {Point[]} points */
export const extent = (points) => Math.max(...[0, 1].map((axis) => Math.max(...points.map((p) => p[axis])) - Math.min(...points.map((p) => p[axis]))));

/** Return whether a closed path crosses itself. @param {Point[]} points */
export function crosses(points) {
  const side = (/** @type {Point} */ [ax, ay], /** @type {Point} */ [bx, by], /** @type {Point} */ [cx, cy]) => (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
  const apart = (/** @type {number} */ a, /** @type {number} */ b) => side(points[a], points[a + 1], points[b]) * side(points[a], points[a + 1], points[b + 1]) < -ROUNDING;
  const high = points.map(([, y], k) => Math.max(y, points[k + 1]?.[1] ?? y));
  const low = points.map(([, y], k) => Math.min(y, points[k + 1]?.[1] ?? y));
  const last = points.length - 1;
  for (let a = 0; a < last; a++) for (let b = a + 2; b < last; b++) if (low[a] <= high[b] && low[b] <= high[a] && apart(a, b) && apart(b, a)) return true;
  return false;
}

/** Return the points of one round of a closed curve that may be traced several times. @param {Point[]} points @returns {Point[]} */
export function once(points) {
  const rounds = [6, 5, 4, 3, 2].find((parts) => {
    const length = (points.length - 1) / parts;
    return Number.isInteger(length) && points.every(([x, y], k) => k < length || Math.hypot(x - points[k - length][0], y - points[k - length][1]) < SMALL);
  });
  return points.slice(0, (points.length - 1) / (rounds ?? 1) + 1);
}

/** Return whether both shapes are curves that do not cross themselves. @param {Shapes} shapes */
const cuttable = ({ space, body }) => extent(space) > SMALL && !crosses(space) && !crosses(body);

const line = (/** @type {Point[]} */ points) => `${pathThrough(points, 7)}Z`;

/** Return both shapes as an SVG, side by side at one scale, 1 m of the drawing as 100 mm. @param {Shapes} shapes */
export function asSvg({ space, body }) {
  [space, body] = [once(space), once(body)];
  const size = 1.1 * Math.max(extent(space), extent(body));
  const middle = (/** @type {Point[]} */ points) => [0, 1].map((axis) => (Math.max(...points.map((p) => p[axis])) + Math.min(...points.map((p) => p[axis]))) / 2);
  const shape = (/** @type {Point[]} */ points, /** @type {string} */ name, /** @type {number} */ at) =>
    `<path id="${name}" transform="translate(${at - middle(points)[0]} ${size / 2 + middle(points)[1]}) scale(1 -1)" d="${line(points)}"/>`;
  return `<svg xmlns="http://www.w3.org/2000/svg" width="${200 * size}mm" height="${100 * size}mm" viewBox="0 0 ${2 * size} ${size}" fill="none" stroke="black" stroke-width="0.002">` +
    `${shape(space, "space", size / 2)}${shape(body, "body", 1.5 * size)}</svg>\n`;
}

/** Return both shapes as a DXF of release 12 in metres, on the layers SPACE and BODY. @param {Shapes} shapes */
export function asDxf({ space, body }) {
  const polyline = (/** @type {string} */ layer, /** @type {Point[]} */ points) => [
    ...[0, "POLYLINE", 8, layer, 66, 1, 70, 1],
    ...points.slice(0, -1).flatMap(([x, y]) => [0, "VERTEX", 8, layer, 10, x.toFixed(7), 20, y.toFixed(7)]),
    ...[0, "SEQEND"],
  ];
  const head = [0, "SECTION", 2, "HEADER", 9, "$ACADVER", 1, "AC1009", 9, "$INSUNITS", 70, 6, 0, "ENDSEC", 0, "SECTION", 2, "ENTITIES"];
  return `${[...head, ...polyline("SPACE", once(space)), ...polyline("BODY", once(body)), 0, "ENDSEC", 0, "EOF"].join("\n")}\n`;
}

/** @type {Record<string, {cosines: Point[], sines: Point[]}>} */
export const MOTIONS = {
  "Straight line": { cosines: [[0, 0], [0.5, 0]], sines: [[0, 0], [0, 0]] },
  Circle: { cosines: [[0, 0], [0.3, 0]], sines: [[0, 0], [0, 0.3]] },
  Ellipse: { cosines: [[0, 0], [0.5, 0]], sines: [[0, 0], [0, 0.2]] },
};

/** @param {HTMLElement} place */
function begin(place) {
  place.innerHTML =
    '<svg class="lot" viewBox="-1.2 -.9 2.4 1.8" tabindex="0" role="application" aria-label="The path of a point, which a pointer draws. Page Up and Page Down select a place on it, the arrow keys move the path there."><g transform="scale(1 -1)"><path class="space"/><path class="path"/>' +
    '<g class="moving"><path class="body"/><path class="mark" d="M0 0H.2"/><circle class="nose" r=".03"/></g><circle class="touch" r=".025"/></g></svg>' +
    `<div class="controls">${Object.keys(MOTIONS).map((name) => `<button type="button" data-motion="${name}">${name}</button>`).join("")}` +
    '<label>the body turns <select><option value="1">once</option><option value="-1">once clockwise</option><option value="2">twice</option><option value="-2">twice clockwise</option></select></label>' +
    '<label class="time">place on the path <input type="range" min="0" max="360" value="0"></label>' +
    '<button type="button" data-file="svg">Download SVG</button><button type="button" data-file="dxf">Download DXF</button></div><p class="count" role="status"></p>';
  const find = (/** @type {string} */ name) => /** @type {SVGElement} */ (place.querySelector(name));
  const count = /** @type {HTMLElement} */ (place.querySelector(".count"));
  const drawing = /** @type {SVGSVGElement} */ (/** @type {unknown} */ (find("svg")));
  const turns = /** @type {HTMLSelectElement} */ (place.querySelector("select"));
  const angle = /** @type {HTMLInputElement} */ (place.querySelector("input"));
  let series = MOTIONS.Ellipse;
  let shapes = shapesOf(series, 1);
  /** @type {Point[]} */
  let drawn = [];

  const selected = () => Math.round((Number(angle.value) / 360) * POINTS);

  function turnTo() {
    const index = selected();
    put(find(".moving"), ...shapes.path[index], shapes.angles[index]);
    put(find(".touch"), ...shapes.space[index], 0);
  }

  function make() {
    shapes = shapesOf(series, Number(turns.value));
    for (const name of /** @type {const} */ (["path", "space", "body"])) find(`.${name}`).setAttribute("d", line(shapes[name]));
    const [fixed, moving] = [extent(shapes.space), extent(shapes.body)];
    const still = fixed < SMALL;
    for (const button of place.querySelectorAll("[data-file]")) button.toggleAttribute("disabled", still);
    count.textContent = still ? "The body only turns about one fixed point, so both shapes are that point. Draw another path, or choose another number of turns."
      : `The fixed shape is ${fixed.toFixed(3)} m wide, the moving shape ${moving.toFixed(3)} m. The moving shape rolls on the fixed one, and the dot of the body then follows the drawn path.` +
        (crosses(shapes.space) || crosses(shapes.body) ? " A shape crosses itself, so it cannot be cut from one piece: draw a rounder path, or choose another number of turns." : "");
    turnTo();
  }

  /** Take a path; another number of turns is selected if only then both shapes can be cut. @param {Series} next */
  function take(next) {
    series = next;
    turns.value = [turns.value, "2", "-2", "1", "-1"].find((turn) => cuttable(shapesOf(series, Number(turn), FEWER))) ?? turns.value;
    make();
  }

  const keep = remembered(place, ([turn, ...numbers]) => {
    const points = numbers.flatMap((value, k) => (k % 2 ? [/** @type {Point} */ ([numbers[k - 1], value])] : []));
    const half = points.length / 2;
    if (half < 2 || half % 1 || ![...turns.options].some(({ value }) => value === String(turn))) return;
    turns.value = String(turn);
    series = { cosines: points.slice(0, half), sines: points.slice(half) };
    make();
  });
  const stored = () => keep([Number(turns.value), ...series.cosines.flat(), ...series.sines.flat()]);
  const hand = (/** @type {PointerEvent} */ event) => pointerIn(drawing.firstElementChild, event);
  onDrag(drawing, {
    begin: (event) => void (drawn = [hand(event)]),
    move(event) {
      const now = hand(event);
      const last = drawn[drawn.length - 1];
      if (Math.hypot(now[0] - last[0], now[1] - last[1]) > 0.005) drawn.push(now);
      find(".path").setAttribute("d", line(drawn));
    },
    end() {
      if (extent(drawn) > 0.1) take(seriesOf(drawn));
      else make();
      stored();
    },
  });
  drawing.addEventListener("keydown", (event) => {
    const turn = { PageUp: STEP.turn, PageDown: -STEP.turn }[event.key];
    const by = ARROWS[event.key];
    if (!turn && !by) return;
    event.preventDefault();
    if (turn) angle.value = String((Number(angle.value) + turn + 360) % 360);
    if (by) {
      take(pulled(series, (2 * Math.PI * selected()) / POINTS, /** @type {Point} */ (by.map((each) => STEP.move * each))));
      stored();
    } else make();
    const [x, y] = shapes.path[selected()];
    count.prepend(`The path at ${angle.value}° is at (${x.toFixed(2)}, ${y.toFixed(2)}) m. `);
  });
  for (const button of place.querySelectorAll("button")) {
    const { motion, file } = button.dataset;
    button.addEventListener("click", () => {
      if (motion) {
        take(MOTIONS[motion]);
        stored();
      }
      if (!file) return;
      const text = file === "svg" ? asSvg(shapes) : asDxf(shapes);
      const link = Object.assign(document.createElement("a"), { href: URL.createObjectURL(new Blob([text])), download: `shapes.${file}` });
      link.click();
      setTimeout(() => URL.revokeObjectURL(link.href), 1000);
    });
  }
  turns.addEventListener("change", () => {
    make();
    stored();
  });
  angle.addEventListener("input", turnTo);
  make();
}

beginAll("cam", begin);
