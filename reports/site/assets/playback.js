// @ts-check
/** How a motion is played: where it slows down and ends, and by which factor its errors are enlarged. */

/** @typedef {{enlarged: number, stopAt: number, slower: number, schedule: number[]}} Playback
 * enlarged: factor of the drawn differences from the exact motion. stopAt: the frame with the largest visible difference.
 * slower: factor of slow motion. schedule: when each frame is shown [s], from the first on */

const SHORTEST = 5; // shortest duration of a playback [s]; shorter motions are shown in slow motion
const GROWING = 3; // factor of slow motion at the fastest growth of the visible difference
const FACTORS = [1000, 500, 200, 100, 50, 20, 10, 5, 2]; // of enlarged differences
const VISIBLE = 0.15; // size of the largest enlarged difference, relative to the mechanism
const SLOWER = [1, 2, 5, 10, 20, 50, 100];

/** @param {ArrayLike<number>} t @param {number[]} window @param {number} size of the mechanism [m]
 * @param {{angle: Float64Array, position: Float64Array}[]} wrong the errors of each motion @returns {Playback} */
export function playback(t, [first, last], size, wrong) {
  const apart = Float64Array.from(t, (_, frame) => wrong.reduce((most, { angle, position }) =>
    Math.max(most, position[frame] + 0.5 * size * Math.sin(Math.min(angle[frame], Math.PI) / 2) || 0), 0)); // 0 after a failure
  const largest = apart.reduce((a, b) => Math.max(a, b), 0);
  const far = apart.map((value) => Math.min(value, size));
  let stopAt = last;
  for (let frame = last; frame >= first; frame--) if (far[frame] > far[stopAt]) stopAt = frame;
  // If the largest difference is at the beginning, the motion is played to its end.
  if (stopAt < first + 0.3 * (last - first)) stopAt = last;
  const slower = SLOWER.find((by) => (t[last] - t[first]) * by >= SHORTEST) ?? 100;
  const growth = far.map((value, frame) => Math.max(0, value - (far[frame - 1] ?? 0)));
  const fastest = Math.max(...growth.slice(first), 1e-3 * size);
  const schedule = [];
  let at = 0;
  for (let frame = first; frame <= last; frame++) {
    if (frame > first) at += (t[frame] - t[frame - 1]) * slower * (1 + ((GROWING - 1) * growth[frame]) / fastest);
    schedule[frame] = at;
  }
  return { enlarged: largest > 0 ? (FACTORS.find((by) => by * largest <= VISIBLE * size) ?? 1) : 1, stopAt, slower, schedule };
}
