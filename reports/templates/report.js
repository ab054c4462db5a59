"use strict";
(() => {
  const read = (id) => JSON.parse(document.getElementById(id).textContent);
  const specifications = read("charts");
  const hidden = new Set();
  const updates = new Set(); // one a drawn chart, that makes it follow the legend
  const options = {
    mode: "vega-lite",
    renderer: "svg",
    actions: { export: true, source: false, compiled: false, editor: false },
    tooltip: { theme: "report" },
    logLevel: 1, // errors: a chart whose methods are all switched off is no reason to warn
  };

  // One chart at a time, when there is nothing else to do: the page answers in between.
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

  // One choice of methods for the whole page: every legend shows it and every chart follows it.
  const follow = (view) => view.signal("hidden", [...hidden]).runAsync();
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

  // A legend is filled when it comes near the window, as a chart is drawn.
  const swatches = document.getElementById("swatches"); // of all methods, or none where each legend has its own
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

  // A chart is drawn when it comes near the window: a page of many cases opens at once.
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
        return hidden.size ? follow(view) : undefined;
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
