// Light or dark: the choice of the reader, else that of the system. It runs before the page is drawn.
(() => {
  const root = document.documentElement;
  /** Without access to the storage the choice holds for this page. @param {(store: Storage) => void} use */
  const kept = (use) => {
    try {
      use(localStorage);
    } catch {}
  };
  // The documents of the site store the choice under this name, "auto" without one.
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
