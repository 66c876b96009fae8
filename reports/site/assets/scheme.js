// Light or dark: the reader's choice if there is one, else the system's. Runs before the page is drawn.
(() => {
  const root = document.documentElement;
  const read = () => {
    try {
      return localStorage.getItem("scheme");
    } catch {
      return null;
    }
  };
  const chosen = read();
  if (chosen) root.dataset.scheme = chosen;
  const dark = () =>
    root.dataset.scheme ? root.dataset.scheme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
  addEventListener("DOMContentLoaded", () => {
    const button = document.querySelector("button.scheme");
    if (!(button instanceof HTMLButtonElement)) return;
    const name = () => {
      button.textContent = dark() ? "Light" : "Dark";
    };
    button.hidden = false;
    name();
    button.addEventListener("click", () => {
      root.dataset.scheme = dark() ? "light" : "dark";
      try {
        localStorage.setItem("scheme", root.dataset.scheme);
      } catch {
        // Without a store the choice holds for this page.
      }
      name();
    });
  });
})();
