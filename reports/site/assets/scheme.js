// The colour scheme that the reader or the system has selected. This script runs before the page is drawn.
(() => {
  const root = document.documentElement;
  root.classList.add("scripts"); // without this class, the style sheet hides controls
  // The first frame has the picture; the texts follow, since the layout of all of it at once would block a slow phone.
  requestAnimationFrame(() => setTimeout(() => root.classList.add("drawn")));
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
