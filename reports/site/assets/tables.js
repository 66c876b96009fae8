// @ts-check
/** Sorting and filtering of tables. */

const SHORT = 6; // a table with fewer rows has no filter

/** Return the sort key of a cell: its first number, else its text. @param {HTMLTableCellElement|undefined} cell */
function key(cell) {
  const text = cell?.textContent?.trim() ?? "";
  const number = /^[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?/i.exec(text);
  return number ? Number(number[0]) : text.toLowerCase();
}

/** @param {HTMLTableElement} table @param {number} column @param {boolean} rising */
function sort(table, column, rising) {
  const body = table.tBodies[0];
  const rows = [...body.rows].map((row) => ({ row, key: key(row.cells[column]) }));
  rows.sort((a, b) => {
    if (typeof a.key !== typeof b.key) return typeof a.key === "number" ? -1 : 1; // numbers come first in both directions
    const order = a.key < b.key ? -1 : a.key > b.key ? 1 : 0;
    return rising ? order : -order;
  });
  body.append(...rows.map(({ row }) => row));
}

/** Add headings that sort the table, and a filter. @param {HTMLTableElement} table */
export function equip(table) {
  const body = table.tBodies[0];
  if (!table.tHead || !body || body.rows.length < 2) return;
  const heads = [...table.tHead.rows[0].cells];
  heads.forEach((head, column) => {
    const button = document.createElement("button");
    button.type = "button";
    button.append(...head.childNodes);
    head.append(button);
    button.addEventListener("click", () => {
      const rising = head.getAttribute("aria-sort") !== "ascending";
      for (const other of heads) other.removeAttribute("aria-sort");
      head.setAttribute("aria-sort", rising ? "ascending" : "descending");
      sort(table, column, rising);
    });
  });
  if (body.rows.length < SHORT) return;
  const label = document.createElement("label");
  label.className = "filter";
  const input = document.createElement("input");
  input.type = "search";
  label.append("Only rows with ", input);
  input.addEventListener("input", () => {
    const words = input.value.toLowerCase().split(/\s+/).filter(Boolean);
    for (const row of body.rows) {
      const text = row.textContent?.toLowerCase() ?? "";
      row.hidden = !words.every((word) => text.includes(word));
    }
  });
  (table.closest(".table-wrapper, .wide") ?? table).before(label);
}

for (const table of document.querySelectorAll("table.docutils")) {
  if (table instanceof HTMLTableElement) equip(table);
}
