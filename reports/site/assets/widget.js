// @ts-check
/** What the drawings that a reader changes have in common: a state for the page's address. */

/** Call `begin` for each widget of a kind. @param {string} kind @param {(place: HTMLElement) => void} begin */
export function beginAll(kind, begin) {
  if (typeof document === "undefined") return; // a test without a browser
  for (const place of /** @type {NodeListOf<HTMLElement>} */ (document.querySelectorAll(`.widget.${kind}`))) begin(place);
}

/** Return a function that stores the numbers of a widget in the address; `restore` gets them from a link, with four decimals.
 * @param {HTMLElement} place @param {(numbers: number[]) => void} restore @returns {(numbers: number[]) => void} */
export function remembered(place, restore) {
  const again = () => {
    const numbers = (place.dataset.state ?? "").split(",").map(Number);
    if (place.dataset.state && numbers.every(Number.isFinite)) restore(numbers);
  };
  place.addEventListener("restore", again);
  again();
  return (numbers) => {
    place.dataset.state = numbers.map((value) => Number(value.toFixed(4))).join(",");
    place.dispatchEvent(new Event("stored", { bubbles: true }));
  };
}
