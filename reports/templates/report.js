"use strict";
(() => {
  const read = (id) => JSON.parse(document.getElementById(id).textContent);
  let specifications = null; // of all charts, by name
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

  // Long arrays of datasets are stored by reports/runs/charts/packing.py as 16-bit integers.
  const unpacked = ([least, largest, codes], log) => {
    const bytes = Uint8Array.from(atob(codes), (character) => character.charCodeAt(0));
    const levels = new DataView(bytes.buffer);
    return Array.from({ length: bytes.length / 2 }, (_, k) => {
      const level = levels.getUint16(2 * k, true);
      const number = least + ((level - 1) / 65534) * (largest - least);
      return level ? (log ? 10 ** number : number) : null;
    });
  };
  const datasetsOf = (id) => {
    const datasets = read(id);
    for (const [name, rows] of Object.entries(datasets))
      for (const row of rows)
        for (const [key, value] of Object.entries(row))
          if (Array.isArray(value) && typeof value[2] === "string") row[key] = unpacked(value, name === "series" || name === "floor");
    return datasets;
  };

  // The library and the specifications are stored compressed, and are read when the page is idle or the first chart is drawn.
  const inflated = (id) => {
    const bytes = Uint8Array.from(atob(document.getElementById(id).textContent), (character) => character.charCodeAt(0));
    return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw"))).text();
  };
  let loading = null;
  const load = () => loading ??= (async () => {
    specifications = JSON.parse(await inflated("charts"));
    new Function(await inflated("library"))();
  })();

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

  // The page has one choice of methods for all legends and charts. A legend with many methods shows only the first at first, and
  // so do its charts, until the reader wants all of them or follows a link to another.
  const folded = new Map(); // the methods that each legend does not show
  const legendOf = (box) => box.closest(".group")?.querySelector(".legend");
  const foldedBy = (legend) => {
    if (legend) fill(legend);
    return folded.get(legend) ?? new Set();
  };
  const unfoldedBy = (legend) => {
    const own = folded.get(legend);
    legend.querySelectorAll("[data-method]").forEach((button) => { button.hidden = own.has(button.dataset.method); });
    const more = legend.querySelector(".rest");
    more.hidden = !own.size;
    more.textContent = `${own.size} more method${own.size > 1 ? "s" : ""}`;
  };
  const follow = (view, box) => {
    if ("chosen" in view.getState().signals) view.signal("chosen", chosen);
    return view.signal("hidden", [...hidden, ...foldedBy(legendOf(box))]).runAsync();
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
    if (button.matches(".rest")) return void choose(() => { folded.get(button.parentElement).clear(); unfoldedBy(button.parentElement); });
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
    const legend = legendOf(document.getElementById(decodeURIComponent(link.hash.slice(1))));
    const method = made.firstChild.data.replace(/: $/, "");
    if (legend && foldedBy(legend).delete(method)) unfoldedBy(legend);
    const button = document.createElement("button");
    choose(() => { chosen = method; hidden.delete(chosen); });
    button.type = "button";
    button.textContent = "Show all alike";
    button.addEventListener("click", alike);
    how.replaceChildren(...made.cloneNode(true).childNodes, " ", button);
    document.getElementById(decodeURIComponent(link.hash.slice(1))).querySelector("figcaption").after(how);
  });

  // A legend is filled when it comes near the window, like charts.
  const swatches = document.getElementById("swatches"); // the swatches of legends that name their methods by position
  const fill = (legend) => {
    if (legend.dataset.filled) return;
    legend.dataset.filled = "yes";
    const own = legend.querySelector("template"); // without scripts, buttons would do nothing
    if (own) legend.append(own.content.cloneNode(true));
    if (legend.dataset.lines) {
      const { firstElementChild: floor, children } = swatches.content;
      const places = legend.dataset.lines.split(" ").filter(Boolean);
      legend.append(...[floor, ...places.map((place) => children[1 + Number(place)])].map((own) => own.cloneNode(true)));
    }
    legend.querySelectorAll("[data-method]").forEach(shown);
    for (const [name, text] of [["rest", ""], ["all", "all / none"]]) {
      const button = document.createElement("button");
      button.type = "button";
      button.className = name;
      button.textContent = text;
      button.hidden = !text;
      legend.append(button);
    }
    const others = [...legend.querySelectorAll("[data-method]")].slice(Number(legend.dataset.first ?? Infinity));
    folded.set(legend, new Set(others.map((button) => button.dataset.method)));
    unfoldedBy(legend);
  };

  // A chart is drawn when it comes near the window, so that a page of many cases opens at once.
  const draw = async (box) => {
    if (box.dataset.drawn) return;
    box.dataset.drawn = "yes";
    if (!window.vegaEmbed) await load();
    const specification = { ...specifications[box.dataset.chart], width: "container" };
    if (box.dataset.data) specification.datasets = datasetsOf(box.dataset.data);
    const named = { ...options, downloadFileName: box.parentElement.id.replace(/^curve-/, "") };
    await vegaEmbed(box, specification, named).then(
      ({ view }) => {
        box.querySelector("summary")?.setAttribute("aria-label", "Save this chart");
        if (!("hidden" in view.getState().signals)) return undefined;
        updates.add(() => follow(view, box));
        return hidden.size || chosen || foldedBy(legendOf(box)).size ? follow(view, box) : undefined;
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

  if (boxes.length) idle(load, { timeout: 2000 }); // also for a reader who prints the page before any chart was drawn
  window.addEventListener("beforeprint", () => {
    legends.forEach(fill);
    boxes.forEach(draw);
  });
})();
