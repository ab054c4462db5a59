"use strict";
// Sorting and filtering of tables.
(() => {
  const LONG = 8; // the least number of rows of a table that gets a filter field
  const [MOST, FEW] = [30, 10]; // the rows of which a table shows the first until the reader wants all, as in report.css
  const words = new Intl.Collator("en", { numeric: true });
  const textOf = (cell) => cell.textContent.trim();
  const isEmpty = (text) => text === "" || text === "–";

  // A cell is sorted by the number in data-value, the number at the beginning of its text (2 ms), or its text.
  const keyOf = (cell) => {
    const text = cell ? textOf(cell) : "";
    const number = Number.parseFloat(cell?.dataset.value ?? text);
    return { text, number, empty: isEmpty(text) };
  };
  const compare = (a, b) => {
    const [left, right] = [Number.isNaN(a.number), Number.isNaN(b.number)];
    if (!left && !right) return a.number - b.number;
    return left === right ? words.compare(a.text, b.text) : left - right;
  };

  // A table that is too wide for the page is divided into pieces, whose rows are sorted and filtered together. `beside` maps each
  // row to its initial index, and each table to a map from initial indices to rows.
  const beside = new Map();
  const piecesOf = (table) => [...(table.closest(".pieces")?.querySelectorAll("table") ?? [table])];
  for (const table of document.querySelectorAll(".pieces table")) {
    const rows = [...table.tBodies[0].rows];
    rows.forEach((row, place) => beside.set(row, place));
    beside.set(table, new Map(rows.map((row, place) => [place, row])));
  }

  // Empty cells come last in both directions, and equal rows keep their order.
  const sort = (head) => {
    const table = head.closest("table");
    const direction = head.getAttribute("aria-sort") === "ascending" ? -1 : 1;
    const body = table.tBodies[0];
    const keyed = [...body.rows].map((row) => ({ row, key: keyOf(row.cells[head.cellIndex]) }));
    keyed.sort((a, b) => a.key.empty - b.key.empty || (a.key.empty ? 0 : direction * compare(a.key, b.key)));
    body.append(...keyed.map(({ row }) => row));
    for (const other of piecesOf(table)) {
      if (other !== table) other.tBodies[0].append(...keyed.map(({ row }) => beside.get(other).get(beside.get(row))));
      for (const cell of other.tHead.rows[0].cells) cell.removeAttribute("aria-sort");
    }
    head.setAttribute("aria-sort", direction > 0 ? "ascending" : "descending");
  };

  // Returns the items that a field filters: rows, together with their rows in other pieces or with the picture of their case.
  const itemsOf = (scope) => {
    const others = scope.matches("table") ? piecesOf(scope).filter((table) => table !== scope) : [];
    const rows = [...scope.querySelectorAll(scope.matches("table") ? "tbody > tr" : "tbody > tr[data-words]")];
    const cards = new Map([...scope.querySelectorAll("li[data-case]")].map((card) => [card.dataset.case, card]));
    const cardOf = (row) => [cards.get(row.dataset.case)].filter(Boolean);
    return rows.map((row) => [row, ...others.map((table) => beside.get(table).get(beside.get(row))), ...cardOf(row)]);
  };

  // Shows all rows of a table of which only the first are shown.
  const showAll = (table) => {
    piecesOf(table).forEach((piece) => piece.classList.remove("shortened"));
    document.querySelector(`.whole-table[data-table="${table.id}"]`)?.remove();
  };

  // Shows only the items that contain all words of the field.
  const filter = (field) => {
    const wanted = field.value.toLowerCase().split(/\s+/).filter(Boolean);
    const scope = document.getElementById(field.dataset.scope);
    const items = itemsOf(scope);
    let shown = 0;
    for (const whole of items) {
      const text = (whole[0].dataset.words ?? whole.map((piece) => piece.textContent).join(" ")).toLowerCase();
      const hidden = !wanted.every((word) => text.includes(word));
      whole.forEach((piece) => { piece.hidden = hidden; });
      shown += !hidden;
    }
    for (const part of scope.querySelectorAll("[data-part]")) part.hidden = !part.querySelector("[data-words]:not([hidden])");
    if (scope.matches(".shortened") && wanted.length) showAll(scope);
    field.nextElementSibling.textContent = wanted.length ? `${shown} of ${items.length}` : "";
  };

  const searchable = (scope, label, before) => {
    const line = document.createElement("p");
    const name = document.createElement("label");
    const field = document.createElement("input");
    const count = document.createElement("output");
    line.className = "search";
    field.type = "search";
    field.id = `search-${scope.id}`;
    field.dataset.scope = scope.id;
    name.htmlFor = count.htmlFor = field.id;
    name.textContent = label;
    line.append(name, " ", field, " ", count);
    before.before(line);
  };

  for (const [place, table] of [...document.querySelectorAll("table.sortable")].entries()) {
    if (table.tBodies[0].rows.length > 1) {
      for (const head of table.tHead.rows[0].cells) {
        const button = document.createElement("button");
        button.type = "button";
        button.append(...head.childNodes);
        head.append(button);
      }
    }
    if (table.tBodies[0].rows.length >= LONG && piecesOf(table)[0] === table) {
      table.id ||= `table-${place}`;
      searchable(table, "Filter rows", table.parentElement);
    }
    const rows = table.tBodies[0].rows.length;
    if (rows > (table.closest(".few") ? FEW : MOST)) table.classList.add("shortened");
    if (table.matches(".shortened") && piecesOf(table).at(-1) === table) {
      const button = document.createElement("button");
      button.type = "button";
      button.className = "whole-table";
      button.dataset.table = piecesOf(table)[0].id;
      button.textContent = `Show all ${rows} rows`;
      button.addEventListener("click", () => showAll(piecesOf(table)[0]));
      table.parentElement.after(button);
    }
  }
  for (const scope of document.querySelectorAll("[data-search]")) {
    searchable(scope, scope.dataset.search, scope.querySelector("[data-part]"));
  }

  document.addEventListener("click", (event) => {
    const head = event.target.closest("table.sortable thead button")?.closest("th");
    if (head) sort(head);
  });
  document.addEventListener("input", (event) => {
    if (event.target.dataset?.scope) filter(event.target);
  });
})();
