"use strict";
// The index beside the page, and folding of sections.
(() => {
  const folds = [...document.querySelectorAll("details.fold")];
  const index = document.querySelector(".index");
  const foldAll = (open) => folds.forEach((fold) => { fold.open = open; });

  // A link to a place inside a folded section opens the section.
  const reveal = (target) => {
    if (!target) return;
    const section = target.querySelector(":scope > details.fold");
    if (section) section.open = true;
    for (let at = target.parentElement?.closest("details"); at; at = at.parentElement?.closest("details")) at.open = true;
    target.scrollIntoView();
  };
  const named = (hash) => document.getElementById(decodeURIComponent(hash.slice(1)));
  document.addEventListener("click", ({ target }) => {
    const link = target.closest?.('a[href^="#"]');
    if (link && link.hash.length > 1) {
      if (narrow.matches && index.contains(link)) index.open = false;
      setTimeout(() => reveal(named(link.hash))); // also if the address already has this hash
    }
  });
  window.addEventListener("hashchange", () => reveal(named(location.hash)));
  if (location.hash.length > 1) reveal(named(location.hash));

  // The index is always open beside the page; above the page, on narrow screens, it is closed until the reader opens it.
  const narrow = matchMedia("(max-width: 68rem)");
  const fit = () => { index.open = !narrow.matches; };
  narrow.addEventListener("change", fit);
  fit();
  if (folds.length > 1) {
    const line = document.createElement("p");
    for (const [text, open] of [["Open all", true], ["Fold all", false]]) {
      const button = document.createElement("button");
      button.type = "button";
      button.textContent = text;
      button.addEventListener("click", () => foldAll(open));
      line.append(button);
    }
    index.querySelector("nav").append(line);
  }

  // Of many cases the index has no links, but a field that finds them by name, title or tag.
  const [LISTED, FOUND] = [12, 8]; // the most cases with links of their own, as in html_report.py, and the most that are shown
  const cases = [...document.querySelectorAll("section[id^='case-']")];
  if (cases.length > LISTED) {
    const [line, name, field, list] = ["p", "label", "input", "ol"].map((kind) => document.createElement(kind));
    const tags = new Map([...document.querySelectorAll("#matrix tr[data-case]")].map((row) => [row.dataset.case, row.dataset.words]));
    const textOf = (one) => `${one.id.slice(5)} ${one.querySelector("h2").textContent} ${tags.get(one.id.slice(5)) ?? ""}`.toLowerCase();
    const entryOf = (text, target) => {
      const entry = document.createElement("li");
      entry.append(target ? Object.assign(document.createElement("a"), { href: `#${target}`, textContent: text }) : text);
      return entry;
    };
    const find = () => {
      const wanted = field.value.toLowerCase().split(/\s+/).filter(Boolean);
      const found = wanted.length ? cases.filter((one) => wanted.every((word) => textOf(one).includes(word))) : [];
      const more = found.length - FOUND;
      list.replaceChildren(...found.slice(0, FOUND).map(({ id }) => entryOf(id.slice(5), id)));
      if (wanted.length && (more > 0 || !found.length)) list.append(entryOf(found.length ? `and ${more} more` : "no case"));
    };
    line.className = "find";
    name.htmlFor = field.id = "find-case";
    name.textContent = "Find a case";
    field.type = "search";
    list.setAttribute("aria-live", "polite");
    field.addEventListener("input", find);
    field.addEventListener("keydown", (event) => event.key === "Enter" && list.querySelector("a")?.click());
    line.append(name, field);
    index.querySelector("nav").prepend(line, list);
  }

  // Of an engine with many methods, all columns but those of its first and its best method are hidden until the reader opens them.
  for (const note of document.querySelectorAll("[data-folds]")) note.hidden = false;
  const foldable = (head, before) => {
    const columns = head.colSpan;
    const cellsOf = (row, place) => [...row.cells].slice(before + (place > 0), before + columns + (place > 0)); // after that of the case
    const button = document.createElement("button");
    const fold = (folded) => {
      for (const cell of [...head.closest("table").rows].slice(1).flatMap(cellsOf)) cell.classList.toggle("opened", !folded);
      show(folded);
    };
    const show = (folded) => {
      head.colSpan = folded ? head.dataset.shown : columns;
      button.setAttribute("aria-expanded", String(!folded));
      button.textContent = folded ? head.dataset.more : "fewer methods";
    };
    button.type = "button";
    button.addEventListener("click", () => fold(button.getAttribute("aria-expanded") === "true"));
    head.append(" ", button);
    show(true);
  };
  for (const table of document.querySelectorAll(".matrix")) {
    const heads = [...table.rows[0].cells].slice(1);
    const before = heads.map((_, place) => heads.slice(0, place).reduce((sum, other) => sum + other.colSpan, 0));
    heads.forEach((head, place) => head.dataset.more && foldable(head, before[place]));
    table.classList.add("folded");
  }

  // The index marks the section that the reader has reached.
  const links = new Map([...index.querySelectorAll("nav > ol:not([aria-live]) a")].map((link) => [named(link.hash), link]));
  const places = [...links.keys()];
  let current = null;
  let asked = false;
  const mark = () => {
    asked = false;
    const reached = places.filter((place) => place.getBoundingClientRect().top < innerHeight / 3).at(-1) ?? places[0];
    if (reached === current) return;
    links.get(current)?.removeAttribute("aria-current");
    const link = links.get(current = reached);
    link?.setAttribute("aria-current", "location");
    if (link && !narrow.matches) {
      const [box, frame] = [link.getBoundingClientRect(), index.getBoundingClientRect()];
      if (box.top < frame.top || box.bottom > frame.bottom) index.scrollTop += box.top - frame.top - frame.height / 2;
    }
  };
  document.addEventListener("scroll", () => {
    if (!asked) requestAnimationFrame(mark);
    asked = true;
  }, { passive: true });
  mark();

  // For printing, all sections are opened.
  let folded = [];
  window.addEventListener("beforeprint", () => {
    folded = [...document.querySelectorAll("main details:not([open])")].filter((one) => !one.closest(".vega-embed"));
    folded.forEach((one) => { one.open = true; });
  });
  window.addEventListener("afterprint", () => folded.forEach((one) => { one.open = false; }));
})();
