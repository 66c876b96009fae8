// @ts-check
/** The moving pictures of a page: each takes its motion from the page's own data, and buttons change it. */

import { Player } from "./player.js";

/** @typedef {import("./motion.js").Take} Take */

const calm = matchMedia("(prefers-reduced-motion: reduce)");

/** @param {string} name @returns {Take} */
function read(name) {
  const text = document.getElementById(`take-${name}`)?.textContent;
  if (!text) throw new Error(`no take is called ${name}`);
  const take = JSON.parse(text);
  // The page tells of a method how far it is from the truth.
  for (const motion of take.motions) {
    motion.pose = motion.apart.map((/** @type {number|null} */ by, /** @type {number} */ index) =>
      by === null ? null : take.truth.pose[index] + by,
    );
  }
  return take;
}

/** Put another motion into a figure: its drawing, its legend, its data. @param {Player} player @param {string} name */
function change(player, name) {
  const figure = player.figure;
  const picture = figure.parentElement?.querySelector(`template[data-picture="${name}"]`);
  const take = read(name);
  if (picture instanceof HTMLTemplateElement) {
    figure.querySelector(".frame")?.replaceChildren(picture.content.cloneNode(true));
  }
  const legend = figure.querySelector(".legend");
  const entries = take.motions.map((motion, index) => {
    const entry = document.createElement("li");
    entry.className = `method-${index + 1}`;
    const [mark, figureText] = [document.createElement("span"), document.createElement("span")];
    mark.className = "mark";
    mark.setAttribute("aria-hidden", "true");
    figureText.className = "figure";
    entry.append(mark, motion.name, figureText);
    return entry;
  });
  const lost = take.lost.map(({ name: method, why }) => {
    const entry = document.createElement("li");
    entry.className = "lost";
    entry.textContent = `${method}: ${why}`;
    return entry;
  });
  const truth = legend?.querySelector(".truth");
  if (legend && truth) legend.replaceChildren(truth, ...entries, ...lost);
  player.stop();
  player.frame = 0;
  player.load(take);
  if (!calm.matches) player.play();
}

document.documentElement.classList.add("js");
/** @type {Map<string, Player>} */
export const players = new Map();
for (const figure of document.querySelectorAll('figure.moving[data-take]:not([data-take=""])')) {
  if (figure instanceof HTMLElement) players.set(figure.id, new Player(figure, read(figure.dataset.take ?? "")));
}
const front = players.get("front");
if (front && !calm.matches) front.play();
for (const button of document.querySelectorAll("button[data-figure]")) {
  if (!(button instanceof HTMLButtonElement)) continue;
  button.hidden = false;
  button.addEventListener("click", () => {
    const player = players.get(button.dataset.figure ?? "");
    if (player) change(player, button.dataset.take ?? "");
    for (const other of document.querySelectorAll("button[data-figure]")) {
      other.classList.toggle("chosen", other === button);
      other.setAttribute("aria-pressed", String(other === button));
    }
  });
}
