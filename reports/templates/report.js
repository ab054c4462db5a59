"use strict";
(() => {
  const read = (id) => JSON.parse(document.getElementById(id).textContent);
  const specifications = read("charts");
  const hidden = new Set();
  let chosen = ""; // the highlighted method, if the reader followed a link from one of its figures
  const updates = new Set(); // a function for each drawn chart that makes it follow the legend
  const options = {
    mode: "vega-lite",
    renderer: "svg",
    actions: { export: true, source: false, compiled: false, editor: false },
    tooltip: { theme: "report" },
    logLevel: 1, // only errors, since a chart whose methods are all switched off causes warnings
  };

  // Charts are drawn one at a time when the page is idle, so that it responds in between.
  const idle = window.requestIdleCallback ?? ((callback) => setTimeout(callback, 20));
  const pause = () => new Promise((resolve) => idle(resolve, { timeout: 500 }));
  const waiting = new Set();
  let working = false;
  const work = async () => {
    for (const task of waiting) {
      await pause();
      waiting.delete(task);
      await task();
    }
    working = false;
  };
  const soon = (task) => {
    waiting.add(task);
    if (working) return;
    working = true;
    work();
  };

  // The page has one choice of methods for all legends and charts.
  const follow = (view) => {
    if ("chosen" in view.getState().signals) view.signal("chosen", chosen);
    return view.signal("hidden", [...hidden]).runAsync();
  };
  const shown = (button) => button.setAttribute("aria-pressed", String(!hidden.has(button.dataset.method)));
  const choose = (change) => {
    change();
    document.querySelectorAll(".legend [data-method]").forEach(shown);
    updates.forEach(soon);
  };
  document.addEventListener("click", ({ target }) => {
    const button = target.closest?.(".legend button");
    if (!button) return;
    const { method } = button.dataset;
    if (method !== undefined) choose(() => hidden.delete(method) || hidden.add(method));
    else if (hidden.size) choose(() => hidden.clear());
    else choose(() => button.parentElement.querySelectorAll("[data-method]").forEach((own) => hidden.add(own.dataset.method)));
  });

  // A figure links to its curve. The curve is then highlighted, with the command of its run below.
  const how = document.createElement("p");
  how.className = "note how";
  const alike = () => choose(() => { chosen = ""; how.remove(); });
  document.addEventListener("click", ({ target }) => {
    const link = target.closest?.('a[href^="#curve-"]');
    const run = link?.closest("[data-run]")?.dataset.run;
    if (!run) return;
    const made = document.getElementById(run);
    const button = document.createElement("button");
    choose(() => { chosen = made.dataset.method; hidden.delete(chosen); });
    button.type = "button";
    button.textContent = "Show all alike";
    button.addEventListener("click", alike);
    how.replaceChildren(...made.cloneNode(true).childNodes, " ", button);
    document.getElementById(decodeURIComponent(link.hash.slice(1))).querySelector("figcaption").after(how);
  });

  // A legend is filled when it comes near the window, like charts.
  const swatches = document.getElementById("swatches"); // the swatches of all methods, or null if each legend has its own
  const fill = (legend) => {
    if (legend.dataset.filled) return;
    legend.dataset.filled = "yes";
    if (swatches) {
      const { firstElementChild: floor, children } = swatches.content;
      const places = legend.dataset.lines.split(" ").filter(Boolean);
      legend.append(...[floor, ...places.map((place) => children[1 + Number(place)])].map((own) => own.cloneNode(true)));
    }
    legend.querySelectorAll("[data-method]").forEach(shown);
    const everything = document.createElement("button");
    everything.type = "button";
    everything.className = "all";
    everything.textContent = "all / none";
    legend.append(everything);
  };

  // A chart is drawn when it comes near the window, so that a page of many cases opens at once.
  const draw = (box) => {
    if (box.dataset.drawn) return Promise.resolve();
    box.dataset.drawn = "yes";
    const specification = { ...specifications[box.dataset.chart], width: "container" };
    if (box.dataset.data) specification.datasets = read(box.dataset.data);
    const named = { ...options, downloadFileName: box.dataset.file };
    return vegaEmbed(box, specification, named).then(
      ({ view }) => {
        if (!("hidden" in view.getState().signals)) return undefined;
        updates.add(() => follow(view));
        return hidden.size || chosen ? follow(view) : undefined;
      },
      (error) => {
        box.textContent = `This chart cannot be drawn: ${error.message}`;
        console.error(error);
      },
    );
  };
  const boxes = [...document.querySelectorAll(".chart")];
  const observer = new IntersectionObserver(
    (entries) => {
      for (const { isIntersecting, target } of entries) {
        if (!isIntersecting) continue;
        observer.unobserve(target);
        if (target.matches(".legend")) fill(target);
        else soon(() => draw(target));
      }
    },
    { rootMargin: "800px 0px" },
  );
  const legends = document.querySelectorAll(".legend");
  [...legends, ...boxes].forEach((near) => observer.observe(near));

  window.addEventListener("beforeprint", () => {
    legends.forEach(fill);
    boxes.forEach(draw);
  });
})();
