// @ts-check
/** A skate that the reader turns and slides by hand to a place straight sideways, and the commutator of both moves. */

import { ARROWS, onDrag, pathThrough, placed, pointerIn, put } from "./motion.js";
import { beginAll, remembered } from "./widget.js";

/** @typedef {[number, number, number]} Pose x, y [m] and angle [rad] of the blade
 * @typedef {{turn: number, slide: number}} Move a turn [rad] about the blade or a slide [m] along it */

const GOAL = 0.4; // distance of the goal to the left [m]
const MOST = { turn: Math.PI / 6, ahead: 0.5 }; // largest angle [rad] and largest distance ahead or back [m] between the kerbs
const NEAR = { place: 0.03, angle: Math.PI / 90 }; // a skate nearer to the goal is parked [m, rad]
const STEP = { turn: Math.PI / 36, slide: 0.05 }; // a press of a key

/** Return the pose after a move: a turn about the blade, then a slide along it. @param {Pose} pose @param {Move} move @returns {Pose} */
export function moved([x, y, angle], { turn, slide }) {
  const now = angle + turn;
  return [x + slide * Math.cos(now), y + slide * Math.sin(now), now];
}

/** Return the four moves of the commutator. @param {number} turn @param {number} slide @returns {Move[]} */
export const commutator = (turn, slide) => [{ turn, slide: 0 }, { turn: 0, slide }, { turn: -turn, slide: 0 }, { turn: 0, slide: -slide }];

/** Return five moves to a place straight sideways, by slides of a given length. @param {number} distance @param {number} slide @returns {Move[]} */
export function sidestep(distance, slide) {
  const turn = Math.asin(distance / 2 / slide);
  return [{ turn, slide: 0 }, { turn: 0, slide }, { turn: -2 * turn, slide: 0 }, { turn: 0, slide: -slide }, { turn, slide: 0 }];
}

/** Append a move; consecutive turns are one turn, and consecutive slides are one slide. @param {Move[]} moves @param {Move} move */
export function append(moves, move) {
  const last = moves.at(-1);
  if (last && Boolean(last.turn) === Boolean(move.turn)) {
    last.turn += move.turn;
    last.slide += move.slide;
    if (Math.abs(last.turn) + Math.abs(last.slide) < 1e-12) moves.pop();
  } else if (move.turn || move.slide) moves.push({ ...move });
}

// The sum with 0 turns -0 into 0.
const degrees = (/** @type {number} */ angle) => `${(Math.round((angle * 1800) / Math.PI) / 10 + 0).toFixed(1)}°`;
const metres = (/** @type {number} */ length) => `${(Math.round(length * 1000) / 1000 + 0).toFixed(3)} m`;
const NOSE = 0.24; // distance from the blade [m]
const BODY = `M${-NOSE} -.09H${NOSE}V.09H${-NOSE}Z`;

/** @param {HTMLElement} place */
function begin(place) {
  place.innerHTML =
    '<svg class="lot" viewBox="-.95 -.75 1.9 1.1" tabindex="0" role="application" aria-label="The skate. The left and right arrow keys turn it, the up and down arrow keys slide it.">' +
    `<g transform="scale(1 -1)"><path class="kerb" d="M-.9 ${GOAL + 0.14}H.9M-.9 -.14H.9"/><path class="goal" d="${BODY}" transform="translate(0 ${GOAL})"/>` +
    `<path class="start" d="${BODY}"/><path class="track"/><g class="skate"><path class="car" d="${BODY}"/><path class="blade" d="M-.12 0H.12"/><circle class="nose" cx="${NOSE}" r=".05"/></g></g></svg>` +
    '<div class="controls"><button data-turn="1">Turn left</button><button data-turn="-1">Turn right</button><button data-slide="1">Slide ahead</button><button data-slide="-1">Slide back</button>' +
    '<button data-shown="commutator">Show the commutator</button><button data-shown="sidestep">Show the sidestep</button><button data-shown="">Start again</button></div>' +
    '<p class="count" role="status"></p>';
  const drawing = /** @type {SVGSVGElement} */ (place.querySelector("svg"));
  const find = (/** @type {string} */ name) => /** @type {SVGElement} */ (drawing.querySelector(name));
  /** @type {Pose} */
  let pose = [0, 0, 0];
  /** @type {Move[]} */
  let moves = [];
  /** @type {Pose[]} */
  let track = [pose];

  /** Move as far as the kerbs allow. @param {Move} wanted */
  function drive({ turn, slide }) {
    turn = Math.min(MOST.turn, Math.max(-MOST.turn, pose[2] + turn)) - pose[2];
    const next = moved(pose, { turn, slide });
    if (Math.abs(next[0]) > MOST.ahead + 1e-9) slide = 0;
    append(moves, { turn, slide });
    pose = moved(pose, { turn, slide });
    track.push(pose);
    show();
  }

  function show() {
    put(find(".skate"), ...pose);
    find(".track").setAttribute("d", pathThrough(track.map(([x, y]) => [x, y]), 4));
    const parked = Math.hypot(pose[0], pose[1] - GOAL) < NEAR.place && Math.abs(pose[2]) < NEAR.angle;
    const total = (/** @type {(move: Move) => number} */ of) => moves.reduce((sum, move) => sum + Math.abs(of(move)), 0);
    const turn = moves.find((move) => move.turn)?.turn ?? 0;
    const slide = moves.find((move) => move.slide)?.slide ?? 0;
    const four = commutator(turn, slide).reduce(moved, /** @type {Pose} */ ([0, 0, 0]));
    place.classList.toggle("parked", parked);
    /** @type {HTMLElement} */ (place.querySelector(".count")).textContent =
      `${parked ? "Parked: " : ""}${moves.length} moves; turned by ${degrees(total(({ turn }) => turn))} and slid by ${metres(total(({ slide }) => slide))} in total. ` +
      `The blade is ${metres(pose[0])} ahead and ${metres(pose[1])} to the left, at ${degrees(pose[2])}. ` +
      (turn && slide ? `The commutator of your first turn and slide moves it by ${metres(four[0])} ahead and ${metres(four[1])} to the left in 4 moves. ` : "") +
      (parked ? `The sidestep needs 5 moves, with slides of ${metres(MOST.ahead)} and turns of ${degrees(sidestep(GOAL, MOST.ahead)[0].turn)}.` : "");
  }

  /** Start again, and drive the moves in small parts. @param {Move[]} wanted */
  function follow(wanted) {
    [pose, moves, track] = [[0, 0, 0], [], [[0, 0, 0]]];
    for (const { turn, slide } of wanted) for (let part = 0; part < 10; part++) drive({ turn: turn / 10, slide: slide / 10 });
    show();
  }

  const keep = remembered(place, (numbers) => follow(numbers.flatMap((turn, k) => (k % 2 ? [] : [{ turn, slide: numbers[k + 1] ?? 0 }]))));
  const stored = () => keep(moves.flatMap(({ turn, slide }) => [turn, slide]));
  for (const button of place.querySelectorAll("button")) {
    const { turn, slide, shown } = button.dataset;
    button.type = "button";
    button.addEventListener("click", () => {
      if (shown === undefined) drive({ turn: Number(turn ?? 0) * STEP.turn, slide: Number(slide ?? 0) * STEP.slide });
      else follow(shown === "commutator" ? commutator(MOST.turn, MOST.ahead) : shown ? sidestep(GOAL, MOST.ahead) : []);
      stored();
    });
  }
  drawing.addEventListener("keydown", (event) => {
    const by = ARROWS[event.key];
    if (!by) return;
    event.preventDefault();
    drive({ turn: -by[0] * STEP.turn, slide: by[1] * STEP.slide });
    stored();
  });
  // A dragged nose follows the pointer: its motion along the blade slides the skate, its motion across turns the skate.
  onDrag(drawing, {
    move(event) {
      const [x, y] = pointerIn(drawing.firstElementChild, event);
      const [ahead, across] = placed([0, 0, -pose[2]], [x - pose[0], y - pose[1]]);
      const along = ahead - NOSE;
      // One kind of move at a time, so that the moves can be counted.
      if (Math.abs(across) > 2 * Math.abs(along)) drive({ turn: Math.atan2(across, NOSE), slide: 0 });
      else if (Math.abs(along) > 2 * Math.abs(across)) drive({ turn: 0, slide: Math.max(-0.1, Math.min(0.1, along)) });
    },
    end: stored,
  });
  show();
}

beginAll("parking", begin);
