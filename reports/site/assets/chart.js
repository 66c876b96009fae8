// @ts-check
/** Errors over time on a logarithmic scale, as an SVG that needs no library. */

const WIDEST = 640;
const NARROWEST = 280;
const HEIGHT = 190;
const LEFT = 62;
const BOTTOM = 30;
const TOP = 20;
const FLOOR = 1e-16; // below rounding nothing is drawn

/** @typedef {{name: string, mark: number, values: ArrayLike<number>}} Line */

/** How wide a chart is in its place: letters are as large on a phone as elsewhere. @param {Element} place */
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

/** Draw lines over time; what is returned moves the mark of the present instant.
 * @param {Element} place @param {ArrayLike<number>} t @param {Line[]} lines @param {Measure} measure
 * @returns {(time: number) => void} */
export function errorChart(place, t, lines, measure) {
  place.replaceChildren();
  const width = widthIn(place);
  const positive = lines.flatMap((line) => Array.from(line.values).filter((v) => v > FLOOR && Number.isFinite(v)));
  if (!positive.length) return () => {};
  const high = Math.ceil(Math.log10(Math.max(...positive)));
  // The first instants would take half of the scale: what nine in ten values are above is shown.
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
  for (let part = 0; part <= 4; part++) {
    const time = first + ((last - first) * part) / 4;
    const text = `${Number(time.toPrecision(3))}${part === 4 ? " s" : ""}`;
    chart.append(svg("text", { x: x(time), y: HEIGHT - 10, "text-anchor": part === 4 ? "end" : "middle" }, text));
  }
  for (const line of lines) {
    let path = "";
    let drawing = false;
    for (let index = 0; index < t.length; index++) {
      const power = Math.log10(line.values[index]);
      const seen = Number.isFinite(power) && power >= low;
      if (seen) path += `${drawing ? "L" : "M"}${x(t[index]).toFixed(1)} ${y(Math.min(power, high)).toFixed(1)}`;
      drawing = seen;
    }
    const group = svg("g", { class: `method-${line.mark}` });
    group.append(svg("path", { class: "line", d: path }), svg("title", {}, line.name));
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

/** Stored rows and the present setting: error against the step, both logarithmic.
 * @param {Element} place @param {{method: string, mark: number, points: Record<Measure, [number, number][]>}[]} stored
 * @param {Measure} measure @param {{x: number, y: number, mark: number, name: string}[]} own */
export function scatter(place, stored, measure, own) {
  const series = stored.map(({ method, mark, points }) => ({ method, mark, points: points[measure] }));
  const width = widthIn(place);
  const height = 300;
  const bottom = 44;
  const seen = own.filter(({ y }) => Number.isFinite(y) && y > 0);
  const xs = [...series.flatMap(({ points }) => points.map(([x]) => x)), ...seen.map(({ x }) => x)].map(Math.log10);
  const ys = [...series.flatMap(({ points }) => points.map(([, y]) => y)), ...seen.map(({ y }) => y)].map(Math.log10);
  if (!xs.length) return;
  const [left, right] = [Math.floor(Math.min(...xs)), Math.ceil(Math.max(...xs))];
  const [low, high] = [Math.floor(Math.min(...ys)), Math.ceil(Math.max(...ys))];
  const x = (/** @type {number} */ value) => LEFT + ((width - LEFT - 12) * (Math.log10(value) - left)) / (right - left || 1);
  const y = (/** @type {number} */ value) => TOP + ((height - TOP - bottom) * (high - Math.log10(value))) / (high - low || 1);
  const label = `Against the step, in stored rows and with the present sliders: ${MEASURES[measure]}`;
  const chart = svg("svg", { class: "chart", viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": label });
  chart.append(svg("text", { x: LEFT, y: 13 }, `${MEASURES[measure]}; large marks: these sliders`));
  for (let power = low; power <= high; power += Math.ceil((high - low) / 6)) {
    chart.append(svg("line", { class: "axis", x1: LEFT, x2: width - 12, y1: y(10 ** power), y2: y(10 ** power) }));
    chart.append(svg("text", { x: LEFT - 8, y: y(10 ** power) + 4, "text-anchor": "end" }, `1e${power}`));
  }
  for (let power = left; power <= right; power++) {
    chart.append(svg("text", { x: x(10 ** power), y: height - 26, "text-anchor": power === right ? "end" : "middle" }, `1e${power}`));
  }
  chart.append(svg("text", { x: width - 12, y: height - 8, "text-anchor": "end" }, "step [s]"));
  for (const { method, mark, points } of series) {
    const group = svg("g", { class: `method-${mark}` });
    const sorted = [...points].sort((a, b) => a[0] - b[0]);
    const d = sorted.map(([px, py], index) => `${index ? "L" : "M"}${x(px).toFixed(1)} ${y(py).toFixed(1)}`).join("");
    group.append(svg("path", { class: "line thin", d }), svg("title", {}, method));
    for (const [px, py] of sorted) {
      const dot = svg("circle", { class: "row", cx: x(px), cy: y(py), r: 3 });
      dot.append(svg("title", {}, `${method} at ${px} s: ${py}`));
      group.append(dot);
    }
    const [tx, ty] = sorted[0];
    group.append(svg("text", { x: x(tx) + 6, y: y(ty) - 7 }, method));
    chart.append(group);
  }
  for (const { x: px, y: py, mark, name } of seen) {
    const group = svg("g", { class: `method-${mark} own` });
    const mx = x(px);
    const my = y(py);
    group.append(svg("path", { class: "now-mark", d: `M${mx} ${my - 8}L${mx + 8} ${my}L${mx} ${my + 8}L${mx - 8} ${my}Z` }));
    group.append(svg("title", {}, name));
    chart.append(group);
  }
  place.replaceChildren(chart);
}
