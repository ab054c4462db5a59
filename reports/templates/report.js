"use strict";
(() => {
  const read = (id) => JSON.parse(document.getElementById(id).textContent);
  const specifications = read("charts");
  const hidden = new Set();
  const views = new Set();
  const buttons = [];
  const options = {
    mode: "vega-lite",
    renderer: "svg",
    actions: { export: true, source: false, compiled: false, editor: false },
    tooltip: { theme: "report" },
    logLevel: 1, // errors: a chart whose methods are all switched off is no reason to warn
  };

  // One choice of methods for the whole page: every legend shows it and every chart follows it.
  const follow = (view) => {
    if ("hidden" in view.getState().signals) view.signal("hidden", [...hidden]).runAsync();
  };
  const choose = (change) => {
    change();
    for (const button of buttons) button.setAttribute("aria-pressed", String(!hidden.has(button.dataset.method)));
    views.forEach(follow);
  };
  const swatches = document.getElementById("swatches"); // one legend for all cases, or none where each has its own
  for (const legend of document.querySelectorAll(".legend")) {
    if (swatches) legend.append(swatches.content.cloneNode(true));
    const own = [...legend.querySelectorAll("button")];
    for (const button of own) {
      const { method } = button.dataset;
      button.addEventListener("click", () => choose(() => hidden.delete(method) || hidden.add(method)));
    }
    const everything = document.createElement("button");
    everything.type = "button";
    everything.className = "all";
    everything.textContent = "all / none";
    everything.addEventListener("click", () =>
      choose(() => (hidden.size ? hidden.clear() : own.forEach((button) => hidden.add(button.dataset.method)))),
    );
    legend.append(everything);
    buttons.push(...own);
  }

  // A chart is drawn when it comes near the window: a page of many cases opens at once.
  const draw = (box) => {
    if (box.dataset.drawn) return Promise.resolve();
    box.dataset.drawn = "yes";
    const specification = { ...specifications[box.dataset.chart], width: "container" };
    if (box.dataset.data) specification.datasets = read(box.dataset.data);
    const named = { ...options, downloadFileName: box.dataset.file };
    return vegaEmbed(box, specification, named).then(
      ({ view }) => {
        views.add(view);
        if (hidden.size) follow(view);
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
        draw(target);
      }
    },
    { rootMargin: "800px 0px" },
  );
  boxes.forEach((box) => observer.observe(box));

  // A page of few charts draws the others when it has nothing else to do, so that it prints whole.
  const few = 120;
  const idle = window.requestIdleCallback || ((callback) => setTimeout(callback, 50));
  const rest = () => {
    const next = boxes.find((box) => !box.dataset.drawn);
    if (next) draw(next).then(() => idle(rest));
  };
  if (boxes.length <= few) idle(rest);
  window.addEventListener("beforeprint", () => boxes.forEach(draw));
})();
