// @ts-check
/** The stored rows as a chart with hover and a table; what is chosen stands in the link. */

const Plot = /** @type {any} */ (window).Plot;
const form = /** @type {HTMLFormElement} */ (document.getElementById("choice"));
const chart = /** @type {HTMLElement} */ (document.getElementById("chart"));
const body = /** @type {HTMLTableSectionElement} */ (document.querySelector("#rows tbody"));
const count = /** @type {HTMLElement} */ (document.getElementById("count"));
const MOST = 400; // rows in the table at once

/** What is measured, with its unit. @type {Record<string, string>} */
const UNITS = {
  position: "error of a place [m]", angle: "error of an angle [rad]", velocity: "error of a velocity [m/s]",
  gap: "gap [m] or slip [m/s]", energy: "drift of energy, relative [1]", reaction: "error of a reaction, relative [1]",
};

/** @typedef {Record<string, string|number|null>} Row */

/** @returns {Promise<Row[]>} */
async function read() {
  const { columns, rows } = await (await fetch("rows.json")).json();
  return rows.map((/** @type {(string|number|null)[]} */ row) =>
    Object.fromEntries(columns.map((/** @type {string} */ name, /** @type {number} */ i) => [name, row[i]])),
  );
}

/** @param {string} name */
const chosen = (name) => /** @type {HTMLSelectElement|HTMLInputElement} */ (form.elements.namedItem(name)).value;

/** @param {HTMLSelectElement} select @param {string[]} words */
function fill(select, words) {
  select.replaceChildren(...words.map((word) => new Option(word || "all", word)));
}

/** @param {Row[]} rows */
function draw(rows) {
  const [scene, engine, x, y, words] = ["scene", "engine", "x", "y", "filter"].map(chosen);
  const wanted = words.toLowerCase().split(/\s+/).filter(Boolean);
  const kept = rows.filter(
    (row) =>
      row.scene === scene && (!engine || row.engine === engine) &&
      wanted.every((word) => `${row.engine} ${row.variant} ${row.outcome}`.toLowerCase().includes(word)),
  );
  const points = kept
    .filter((row) => Number(row[x]) > 0 && Number(row[y]) > 0)
    .map((row) => ({ ...row, method: `${row.engine} ${row.variant}` }));
  const unit = { step: "step [s]", cpu: "CPU time per simulated second [s]" }[x];
  chart.replaceChildren(
    points.length
      ? Plot.plot({
          width: Math.min(960, chart.clientWidth), height: 460, marginLeft: 60, grid: true,
          style: { background: "transparent", color: "var(--ink)", fontSize: "12px" },
          x: { type: "log", label: unit, tickFormat: ".0e", ticks: 5 },
          y: { type: "log", label: UNITS[y] ?? y, tickFormat: ".0e" },
          color: { legend: true, scheme: "Tableau10" }, symbol: { legend: true },
          marks: [
            Plot.line(points, { x, y, z: "method", stroke: "method", sort: x, strokeOpacity: 0.6 }),
            Plot.dot(points, {
              x, y, stroke: "method", symbol: "engine", tip: true, r: 4,
              channels: {
                scene: "scene", step: { value: "step", label: "step [s]" }, outcome: "outcome", settings: "settings",
              },
            }),
          ],
          ariaLabel: `Error of ${scene} against ${unit}`,
        })
      : "No row has both numbers.",
  );
  body.replaceChildren(
    ...kept.slice(0, MOST).map((row) => {
      const line = document.createElement("tr");
      for (const name of ["engine", "variant", "step", "outcome", "position", "angle", "velocity", "gap", "energy", "reaction", "cpu"]) {
        const value = row[name];
        line.insertCell().textContent = value === null ? "–" : typeof value === "number" ? String(Number(value.toPrecision(3))) : value;
      }
      return line;
    }),
  );
  const shown = kept.length > MOST ? `, the first ${MOST} of them in the table` : "";
  count.textContent = `${kept.length} rows${shown}.`;
  const state = ["scene", "engine", "x", "y", "filter"].map((name) => `${name}=${encodeURIComponent(chosen(name))}`);
  history.replaceState(null, "", `#${state.join("&")}`);
}

async function begin() {
  const rows = await read();
  const unique = (/** @type {string} */ name) => [...new Set(rows.map((row) => String(row[name])))].sort();
  fill(/** @type {HTMLSelectElement} */ (form.elements.namedItem("scene")), unique("scene"));
  fill(/** @type {HTMLSelectElement} */ (form.elements.namedItem("engine")), ["", ...unique("engine")]);
  /** @type {HTMLSelectElement} */ (form.elements.namedItem("scene")).value = "free_four_bar";
  for (const part of location.hash.slice(1).split("&")) {
    const [name, value] = part.split("=").map(decodeURIComponent);
    const element = name ? form.elements.namedItem(name) : null;
    if (element instanceof HTMLSelectElement && [...element.options].some((option) => option.value === value)) element.value = value;
    if (element instanceof HTMLInputElement) element.value = value ?? "";
  }
  form.addEventListener("input", () => draw(rows));
  form.addEventListener("submit", (event) => event.preventDefault());
  addEventListener("resize", () => draw(rows));
  form.hidden = false;
  draw(rows);
  document.documentElement.dataset.ready = "yes";
}

begin();
