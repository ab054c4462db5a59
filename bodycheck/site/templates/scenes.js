// The search of the list of scenes, whose words are kept in the address.
"use strict";
(() => {
  const form = document.getElementById("search");
  const { q } = form.elements;
  const cards = [...document.querySelectorAll(".cards li")];

  const apply = () => {
    const asked = site.state().get("q") ?? "";
    if (q.value.trim() !== asked) q.value = asked;
    const words = asked.toLowerCase().split(/\s+/).filter(Boolean);
    for (const card of cards) card.hidden = !words.every((word) => card.dataset.words.includes(word));
    for (const section of document.querySelectorAll("main section")) section.hidden = !section.querySelector("li:not([hidden])");
    const count = cards.filter((card) => !card.hidden).length;
    document.getElementById("shown").textContent = words.length ? `${count} of ${cards.length} scenes` : "";
  };
  q.addEventListener("input", () => {
    site.keep(new URLSearchParams(q.value.trim() ? { q: q.value.trim() } : {}), true);
    apply();
  });
  form.addEventListener("submit", (event) => event.preventDefault());
  addEventListener("popstate", apply);
  addEventListener("hashchange", apply);
  apply();
})();
