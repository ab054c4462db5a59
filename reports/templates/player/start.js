// Makes a player when it comes near the window, so that a page of many cases opens at once, and all players before printing.
// Uses player.js.
const ready = (figure) => {
  if (!figure.dataset.ready) build(figure, JSON.parse(document.getElementById(figure.dataset.player).textContent));
  figure.dataset.ready = "yes";
};
const figures = [...document.querySelectorAll(".player")];
const observer = new IntersectionObserver(
  (entries) => {
    for (const { isIntersecting, target } of entries) {
      if (!isIntersecting) continue;
      observer.unobserve(target);
      ready(target);
    }
  },
  { rootMargin: "600px 0px" },
);
figures.forEach((figure) => observer.observe(figure));
window.addEventListener("beforeprint", () => figures.forEach(ready));
