// @ts-check
/** The stored rows as a chart and a table; the address stores the choice of the reader. */

import { equip } from "./tables.js";

const Plot = /** @type {any} */ (window).Plot;
const form = /** @type {HTMLFormElement} */ (document.getElementById("choice"));
const chart = /** @type {HTMLElement} */ (document.getElementById("chart"));
const body = /** @type {HTMLTableSectionElement} */ (document.querySelector("#rows tbody"));
const count = /** @type {HTMLElement} */ (document.getElementById("count"));
const MOST = 400; // largest number of rows in the table

/** @typedef {Record<string, string|number|null>} Row */

/** The role of each engine's colour, and whether the engine is an exact solver. @type {Record<string, {role: string, exact: boolean}>} */
let looks = {};
// The colour of a line depends on the engine, its dashes on the variant.
const DASHES = /** @type {Record<string, string>} */ ({ default: "2 3", tuned: "7 4", extended: "" });
/** @type {Record<string, string>} */
let headings = {};

/** @param {string} name */
const field = (name) => /** @type {HTMLSelectElement & HTMLInputElement} */ (form.elements.namedItem(name));

/** @param {Row[]} rows */
function draw(rows) {
  const [scene, engine, x, y, words] = ["scene", "engine", "x", "y", "filter"].map((name) => field(name).value);
  const all = field("all").checked;
  const wanted = words.toLowerCase().split(/\s+/).filter(Boolean);
  const kept = rows.filter(
    (row) =>
      row.scene === scene && (!engine || row.engine === engine) && (all || usual(row)) &&
      wanted.every((word) => `${row.engine} ${row.variant} ${row.outcome}`.toLowerCase().includes(word)),
  );
  /** @type {Row[]} */
  const points = kept
    .filter((row) => Number(row[x]) > 0 && Number(row[y]) > 0)
    .map((row) => ({ ...row, method: nameOf(row) }));
  const engines = [...new Set(points.map((row) => String(row.engine)))];
  const names = (/** @type {boolean} */ ofDefaults, /** @type {(options: object) => object} */ select, /** @type {string} */ textAnchor, /** @type {number} */ dx) =>
    Plot.text(points.filter(({ variant }) => (variant === "default") === ofDefaults),
      select({ x, y, z: "method", text: "method", fill: "engine", textAnchor, dx, dy: -7 }));
  const [across, error] = ["x", "y"].map((name) => field(name).selectedOptions[0].text);
  chart.replaceChildren(
    points.length
      ? Plot.plot({
          width: Math.min(960, chart.clientWidth), height: 474, marginTop: 36, marginLeft: 60, marginBottom: 44, grid: true,
          style: { background: "transparent", color: "var(--ink)", fontSize: "12px" },
          x: { type: "log", label: across, tickFormat: ".0e", ticks: 5 },
          y: { type: "log", label: `error: ${error}`, tickFormat: ".0e", ticks: 5 },
          color: { legend: true, domain: engines, range: engines.map((name) => `var(--${looks[name].role})`) },
          marks: [
            ...[...new Set(points.map((row) => String(row.variant)))].map((variant) =>
              Plot.line(points.filter((row) => row.variant === variant), { x, y, z: "method", stroke: "engine", sort: x, strokeDasharray: DASHES[variant] ?? "1 2 6 2" })),
            // Default methods have nearly equal errors at short steps, other methods at long steps. Labels are at the other end.
            names(false, Plot.selectMinX, "start", 6),
            names(true, Plot.selectMaxX, "end", -6),
            Plot.dot(points, {
              x, y, fill: "engine", tip: true, r: 3.5,
              channels: {
                method: "method", scene: "scene", step: { value: "step", label: "step [s]" }, outcome: "outcome", settings: "settings",
              },
            }),
          ],
          ariaLabel: `Error of ${scene} against ${across}`,
        })
      : "No row has both numbers.",
  );
  separate([...chart.querySelectorAll("[aria-label=text] text")]);
  body.replaceChildren(
    ...kept.slice(0, MOST).map((row) => {
      const line = document.createElement("tr");
      for (const name of ["engine", "variant", "step", "outcome", "position", "angle", "velocity", "gap", "energy", "reaction", "cpu"]) {
        const value = row[name];
        line.insertCell().textContent = name === "variant" ? (headings[String(value)] ?? String(value)) : value === null ? "–" : typeof value === "number" ? rounded(value) : value;
      }
      return line;
    }),
  );
  const shown = kept.length > MOST ? `, the first ${MOST} of them in the table` : "";
  count.textContent = `${kept.length} rows${shown}.`;
}

/** Move labels into the chart, and above those that they would overlap. @param {Element[]} labels */
function separate(labels) {
  const { right: edge } = chart.getBoundingClientRect();
  const boxes = labels.map((label) => ({ label, box: label.getBoundingClientRect() })).sort((a, b) => b.box.bottom - a.box.bottom);
  /** @type {{left: number, right: number, top: number}[]} */
  const placed = [];
  for (const { label, box } of boxes) {
    const aside = Math.min(0, edge - box.right);
    const [left, right] = [box.left + aside, box.right + aside];
    const near = placed.filter((other) => other.left < right && left < other.right && other.top < box.bottom);
    const up = Math.min(0, ...near.map(({ top }) => top - box.bottom));
    /** @type {SVGElement} */ (label).style.translate = `${aside}px ${up}px`;
    placed.push({ left, right, top: box.top + up });
  }
}

/** Return whether a row is of one of the three variants of an engine. @param {Row} row */
const usual = ({ engine, variant }) => String(variant) in headings && !looks[String(engine)].exact;

/** Return a number with three digits; a small number is written with an exponent. @param {number} value */
const rounded = (value) => (value && Math.abs(value) < 1e-3 ? value.toExponential(2) : String(Number(value.toPrecision(3))));

/** Return the name of a method. @param {Row} row */
const nameOf = ({ engine, variant }) => `${engine} ${headings[String(variant)] ?? variant}`;

/** Store the choice of the reader in the address. */
function keep() {
  const state = [...new FormData(form)].filter(([, value]) => value).map(([name, value]) => `${name}=${encodeURIComponent(String(value))}`);
  history.replaceState(history.state, "", `#${state.join("&")}`);
}

async function begin() {
  const stored = await (await fetch("rows.json")).json();
  ({ looks, headings } = stored);
  /** @type {Row[]} */
  const rows = stored.rows.map((/** @type {unknown[]} */ row) => Object.fromEntries(stored.columns.map((/** @type {string} */ name, /** @type {number} */ i) => [name, row[i]])));
  for (const name of ["scene", "engine"]) field(name).append(...[...new Set(rows.map((row) => String(row[name])))].sort().map((word) => new Option(word)));
  field("engine").prepend(new Option("all", "", true, true));
  field("scene").value = "free_four_bar";
  const restore = () => {
    for (const [name, value] of new URLSearchParams(location.hash.slice(1))) {
      const element = form.elements.namedItem(name);
      if (element instanceof HTMLSelectElement && [...element.options].some((option) => option.value === value)) element.value = value;
      if (element instanceof HTMLInputElement) Object.assign(element, element.type === "search" ? { value } : { checked: true });
    }
  };
  restore();
  addEventListener("hashchange", () => {
    restore();
    draw(rows);
  });
  form.addEventListener("input", () => {
    draw(rows);
    keep();
  });
  form.addEventListener("submit", (event) => event.preventDefault());
  addEventListener("resize", () => draw(rows));
  form.hidden = false;
  draw(rows);
  equip(/** @type {HTMLTableElement} */ (body.parentElement));
  document.documentElement.dataset.ready = "yes";
}

begin();
