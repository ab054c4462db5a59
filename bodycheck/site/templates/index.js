// The filters of the front page, whose state is kept in the address, and moving from cell to cell with keys.
"use strict";
(() => {
  const form = document.getElementById("filters");
  const table = document.getElementById("matrix");
  const details = document.getElementById("details");
  const heads = [...table.tHead.rows[0].cells].slice(1);
  const engines = [...form.querySelectorAll("[name=engines]")].map((box) => box.value);
  const bodies = [...table.tBodies];
  const lines = bodies.flatMap((body) =>
    [...body.rows].slice(1).map((row) => ({ row, body, head: row.cells[0], cells: [...row.cells].slice(1) })),
  );
  const others = site.json("others"); // the cells of other methods that differ from those of the default methods
  const usual = lines.map(() => ({})); // the cells of the default methods that other methods have replaced
  let method = "";

  // Returns the state: the choices of the reader by name. An empty choice means everything.
  const read = () => {
    const state = site.state();
    const list = (name) => new Set((state.get(name) ?? "").split(",").filter(Boolean));
    return {
      q: state.get("q") ?? "",
      kind: state.get("kind") ?? "",
      method: Object.hasOwn(others, state.get("method") ?? "") ? state.get("method") : "",
      changed: state.get("changed") === "1",
      engines: list("engines"),
      verdicts: list("verdicts"),
    };
  };
  const write = (replace) => {
    const state = new URLSearchParams();
    const chosen = (name) => [...form.querySelectorAll(`[name=${name}]:checked`)].map((box) => box.value).join(",");
    const values = {
      q: form.elements.q.value.trim(),
      kind: form.elements.kind.value,
      method: form.elements.method.value,
      changed: form.elements.changed.checked ? "1" : "",
      engines: chosen("engines"),
      verdicts: chosen("verdicts"),
    };
    for (const [name, value] of Object.entries(values)) if (value) state.set(name, value);
    site.keep(state, replace);
  };
  const fill = (state) => {
    if (form.elements.q.value.trim() !== state.q) form.elements.q.value = state.q;
    form.elements.kind.value = state.kind;
    form.elements.method.value = state.method;
    form.elements.changed.checked = state.changed;
    for (const name of ["engines", "verdicts"])
      for (const box of form.querySelectorAll(`[name=${name}]`)) box.checked = state[name].has(box.value);
  };

  // The content of a cell: text, verdict in words, sign of a change, classes, explanation, address.
  const fields = (cell) => {
    const link = cell.firstElementChild;
    const word = link.querySelector(".unseen")?.textContent.trim() ?? "";
    const mark = link.querySelector("b")?.textContent ?? "";
    return [link.firstChild?.nodeValue ?? "", word, mark, cell.className, link.title, link.getAttribute("href") ?? ""];
  };
  const put = (cell, [text, word, mark, style, told, address]) => {
    const link = site.element(
      address ? "a" : "span",
      { title: told, href: address || null, tabindex: address ? "-1" : null },
      text,
      word ? site.element("span", { class: "unseen" }, ` ${word}`) : null,
      mark ? site.element("b", { "aria-hidden": "true" }, mark) : null,
    );
    cell.className = style;
    cell.replaceChildren(link);
  };
  const change = (wanted) => {
    if (wanted === method) return;
    lines.forEach(({ cells }, place) => {
      for (const column of Object.keys(others[method]?.[place] ?? {})) put(cells[column], usual[place][column]);
      for (const [column, content] of Object.entries(others[wanted]?.[place] ?? {})) {
        usual[place][column] ??= fields(cells[column]);
        put(cells[column], content);
      }
    });
    method = wanted;
  };

  // On a narrow screen, where the engines of a scene stand below its name, the scenes of a kind are folded until the reader opens
  // the kind or asks for some scenes.
  const stacked = table.closest(".scroll") ? { matches: false } : matchMedia("(max-width: 72rem)");
  const opened = new Set();
  const buttons = bodies.map((body) => {
    const button = site.element("button", { type: "button", class: "unfold" });
    button.addEventListener("click", () => {
      if (!opened.delete(body)) opened.add(body);
      apply();
    });
    body.rows[0].cells[0].append(button);
    return button;
  });
  const foldKinds = (isAsked) =>
    bodies.forEach((body, place) => {
      const found = [...body.rows].slice(1).filter((row) => !row.hidden);
      const isFolded = stacked.matches && !isAsked && !opened.has(body);
      buttons[place].hidden = !stacked.matches || isAsked;
      buttons[place].textContent = isFolded ? `Show ${found.length} ${found.length === 1 ? "scene" : "scenes"}` : "Fold";
      buttons[place].setAttribute("aria-expanded", String(!isFolded));
      if (isFolded) for (const row of found) row.hidden = true;
    });

  const apply = () => {
    const state = read();
    fill(state);
    change(state.method);
    const words = state.q.toLowerCase().split(/\s+/).filter(Boolean);
    const seen = engines.map((name) => !state.engines.size || state.engines.has(name));
    heads.forEach((head, column) => (head.hidden = !seen[column]));
    const asks = state.verdicts.size > 0 || state.changed;
    let count = 0;
    for (const body of bodies) body.hidden = true;
    for (const { row, body, cells } of lines) {
      let any = !asks;
      cells.forEach((cell, column) => {
        const verdict = cell.className.split(" ", 1)[0];
        const fits =
          (!state.verdicts.size || state.verdicts.has(verdict)) && (!state.changed || cell.classList.contains("changed"));
        cell.hidden = !seen[column];
        cell.classList.toggle("off", asks && !fits);
        any ||= fits && seen[column];
      });
      const named = words.every((word) => row.dataset.words.includes(word));
      row.hidden = !(any && named && (!state.kind || body.dataset.kind === state.kind));
      if (!row.hidden) {
        body.hidden = false;
        count += 1;
      }
    }
    foldKinds(asks || words.length > 0 || Boolean(state.kind) || state.engines.size > 0);
    const columns = seen.filter(Boolean).length;
    for (const body of bodies) body.rows[0].cells[0].colSpan = columns + 1;
    document.getElementById("shown").textContent =
      `${count} of ${lines.length} scenes, ${columns} of ${engines.length} engines`;
    document.getElementById("engines").textContent = `Engines: ${state.engines.size ? engines.filter((_, column) => seen[column]).join(", ") : "all"}`;
    if (!usable(current)) enter(lines.find((line) => !line.row.hidden)?.head ?? null);
  };

  // The whole matrix is one stop of the Tab key, at the current cell. Arrow keys move the current cell.
  let current = null;
  const target = (cell) => cell.querySelector("a") ?? cell;
  const usable = (cell) => cell !== null && !cell.hidden && !cell.parentElement.hidden && !cell.parentElement.parentElement.hidden;
  const enter = (cell) => {
    if (current) target(current).tabIndex = -1;
    current = cell;
    if (current) target(current).tabIndex = 0;
  };
  const rows = () => [table.tHead.rows[0], ...lines.map((line) => line.row)].filter((row) => !row.hidden && !row.parentElement.hidden);
  const columns = (row) => [...row.cells].filter((cell) => !cell.hidden);
  const moved = (key, ctrl, cell) => {
    const all = rows();
    const place = all.indexOf(cell.parentElement);
    const own = columns(cell.parentElement);
    const column = own.indexOf(cell);
    const at = (row, position) => columns(all[Math.max(0, Math.min(all.length - 1, row))])[position];
    switch (key) {
      case "ArrowRight": return own[column + 1];
      case "ArrowLeft": return own[column - 1];
      case "ArrowDown": return at(place + 1, column);
      case "ArrowUp": return at(place - 1, column);
      case "PageDown": return at(place + 10, column);
      case "PageUp": return at(place - 10, column);
      case "Home": return ctrl ? at(0, 0) : own[0];
      case "End": return ctrl ? at(all.length - 1, own.length - 1) : own[own.length - 1];
      default: return undefined;
    }
  };

  const tell = (cell) => {
    const line = lines.find((one) => one.row === cell?.parentElement);
    const column = line ? line.cells.indexOf(cell) : -1;
    details.hidden = column < 0;
    if (column < 0) return;
    const told = cell.firstElementChild.title || cell.innerText;
    details.replaceChildren(
      site.element("strong", {}, `${line.head.innerText} · ${engines[column]}`),
      ` ${told}`,
    );
  };

  // On a narrow screen, filters that are seldom used are folded, so that the matrix comes first.
  const narrow = matchMedia("(max-width: 40rem)");
  const more = document.getElementById("more");
  const fold = () => (more.open = !narrow.matches || read().verdicts.size + read().engines.size > 0);
  narrow.addEventListener("change", fold);
  fold();

  table.setAttribute("role", "grid");
  table.setAttribute("aria-readonly", "true");
  for (const link of table.querySelectorAll("a")) link.tabIndex = -1;
  table.closest(".matrix").removeAttribute("tabindex"); // not needed, since a cell in the region can be focused
  table.addEventListener("keydown", (event) => {
    const cell = event.target.closest("th, td");
    if (!cell || event.altKey || event.metaKey) return;
    const to = moved(event.key, event.ctrlKey, cell);
    if (to === undefined) return;
    event.preventDefault();
    enter(to);
    target(to).focus();
  });
  table.addEventListener("focusin", (event) => {
    const cell = event.target.closest("th, td");
    if (cell && cell !== current) enter(cell);
    tell(cell);
  });
  table.addEventListener("pointerover", (event) => tell(event.target.closest("td")));

  form.addEventListener("input", (event) => {
    write(event.target.name === "q");
    apply();
  });
  form.addEventListener("submit", (event) => event.preventDefault());
  form.addEventListener("reset", (event) => {
    event.preventDefault();
    site.keep(new URLSearchParams());
    apply();
  });
  stacked.addEventListener?.("change", apply);
  addEventListener("popstate", apply);
  addEventListener("hashchange", apply);
  apply();
})();
