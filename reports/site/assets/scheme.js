// The colour scheme that the reader or the system has selected. This script runs before the page is drawn.
(() => {
  const root = document.documentElement;
  root.classList.add("scripts"); // without this class, the style sheet hides controls
  // The first frame has the picture, the second one its legend, the third one the texts: all at once would block a slow phone.
  const frame = (/** @type {() => void} */ then) => requestAnimationFrame(() => setTimeout(then));
  frame(() => {
    root.classList.add("drawn");
    frame(() => root.classList.add("written"));
  });
  /** Use the storage; without access to it the choice is valid for this page only. @param {(store: Storage) => void} use */
  const kept = (use) => {
    try {
      use(localStorage);
    } catch {}
  };
  // Furo stores the choice under the name "theme"; its third value is "auto".
  kept(({ theme }) => Object.assign(root.dataset, /^(light|dark)$/.test(theme) && { scheme: theme }));
  const dark = () => (root.dataset.scheme ?? (matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "")) === "dark";
  addEventListener("DOMContentLoaded", () => {
    const button = document.querySelector("button.scheme");
    if (!(button instanceof HTMLButtonElement)) return;
    const name = () => (button.textContent = dark() ? "Light" : "Dark");
    button.hidden = false;
    name();
    button.addEventListener("click", () => {
      const scheme = (root.dataset.scheme = dark() ? "light" : "dark");
      kept((store) => store.setItem("theme", scheme));
      name();
    });
  });
})();
