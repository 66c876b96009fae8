// @ts-check
/** The chart of errors over time, as an SVG with a logarithmic scale. */

const WIDEST = 640;
const NARROWEST = 280;
const HEIGHT = 150;
const LEFT = 62;
const BOTTOM = 30;
const TOP = 20;
const FLOOR = 1e-16; // errors below rounding are not drawn

/** @typedef {{label: string, mark: number, errors: ArrayLike<number>}} Line */

/** Return the width of the chart in its element. @param {Element} place */
const widthIn = (place) => Math.min(WIDEST, Math.max(NARROWEST, place.clientWidth || WIDEST));

/** @param {string} tag @param {Record<string, string|number>} attributes @param {string} [text] */
export function svg(tag, attributes, text) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, String(value));
  if (text !== undefined) made.textContent = text;
  return made;
}

/** @typedef {"angle"|"position"} Measure */
const MEASURES = { angle: "largest error of an angle [rad]", position: "largest error of a place [m]" };

/** Draw lines over time; return a function that moves the mark of the shown instant.
 * @param {Element} place @param {ArrayLike<number>} t @param {Line[]} lines @param {Measure} measure
 * @returns {(time: number) => void} */
export function errorChart(place, t, lines, measure) {
  const width = widthIn(place); // before the change of the page, which would need a layout
  place.replaceChildren();
  const positive = lines.flatMap((line) => Array.from(line.errors).filter((v) => v > FLOOR && Number.isFinite(v)));
  if (!positive.length) return () => {};
  const high = Math.ceil(Math.log10(Math.max(...positive)));
  // The scale covers nine of ten values, since errors at the first instants are very small.
  const tenth = positive.sort((a, b) => a - b)[Math.floor(positive.length / 10)];
  const low = Math.min(high - 1, Math.max(Math.floor(Math.log10(tenth)), high - 9));
  const last = t[t.length - 1];
  const first = t[0];
  const x = (/** @type {number} */ time) => LEFT + ((width - LEFT - 12) * (time - first)) / (last - first || 1);
  const y = (/** @type {number} */ power) => TOP + ((HEIGHT - TOP - BOTTOM) * (high - power)) / Math.max(1, high - low);
  const label = `Against time, logarithmic: ${MEASURES[measure]}`;
  const chart = svg("svg", { class: "chart", viewBox: `0 0 ${width} ${HEIGHT}`, role: "img", "aria-label": label });
  chart.append(svg("text", { x: LEFT, y: 13 }, MEASURES[measure]));
  const stride = Math.ceil((high - low) / 5);
  for (let power = high; power >= low; power -= stride) {
    chart.append(svg("line", { class: "axis", x1: LEFT, x2: width - 12, y1: y(power), y2: y(power) }));
    chart.append(svg("text", { x: LEFT - 8, y: y(power) + 4, "text-anchor": "end" }, `1e${power}`));
  }
  const parts = width < 400 ? 2 : 4; // number of labels that fit
  for (let part = 0; part <= parts; part++) {
    const time = first + ((last - first) * part) / parts;
    const text = `${Number(time.toPrecision(3))}${part === parts ? " s" : ""}`;
    chart.append(svg("text", { x: x(time), y: HEIGHT - 10, "text-anchor": part === parts ? "end" : "middle" }, text));
  }
  for (const line of lines) {
    let path = "";
    let drawing = false;
    for (let index = 0; index < t.length; index++) {
      const power = Math.log10(line.errors[index]);
      const seen = Number.isFinite(power) && power >= low;
      if (seen) path += `${drawing ? "L" : "M"}${x(t[index]).toFixed(1)} ${y(Math.min(power, high)).toFixed(1)}`;
      drawing = seen;
    }
    const group = svg("g", { class: `method-${line.mark}` });
    group.append(svg("path", { class: "line", d: path }), svg("title", {}, line.label));
    chart.append(group);
  }
  const now = svg("line", { class: "now", y1: TOP, y2: HEIGHT - BOTTOM, x1: LEFT, x2: LEFT });
  chart.append(now);
  place.append(chart);
  return (time) => {
    now.setAttribute("x1", x(time).toFixed(1));
    now.setAttribute("x2", x(time).toFixed(1));
  };
}
