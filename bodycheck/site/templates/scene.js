// The page of a scene: loads motions into the player when the reader requests them, and adds buttons that copy texts.
"use strict";
const start = document.getElementById("play");
start?.addEventListener("click", async () => {
  const told = document.getElementById("play-state");
  const figure = document.querySelector("figure.player");
  start.disabled = true;
  told.textContent = "The motion is being read.";
  try {
    await Promise.all([site.load(start.dataset.player), site.load(start.dataset.motion)]);
  } catch (error) {
    told.textContent = `${error.message}.`;
    start.disabled = false;
    return;
  }
  figure.hidden = false;
  window.play(figure, site.motion);
  told.textContent = "";
  start.hidden = true;
  figure.querySelector("button")?.focus();
});
for (const text of document.querySelectorAll("[data-copy]"))
  text.after(site.element("p", {}, site.copier(`Copy ${text.dataset.copy}`, text.textContent)));
