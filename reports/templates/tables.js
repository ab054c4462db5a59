"use strict";
// Sorting and filtering of tables.
(() => {
  const LONG = 8; // tables of at least so many rows get a field to filter them
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

  // Empty cells come last in both directions, and equal rows keep their order.
  const sort = (head) => {
    const table = head.closest("table");
    const direction = head.getAttribute("aria-sort") === "ascending" ? -1 : 1;
    const body = table.tBodies[0];
    const keyed = [...body.rows].map((row) => ({ row, key: keyOf(row.cells[head.cellIndex]) }));
    keyed.sort((a, b) => a.key.empty - b.key.empty || (a.key.empty ? 0 : direction * compare(a.key, b.key)));
    body.append(...keyed.map(({ row }) => row));
    for (const other of table.tHead.rows[0].cells) other.removeAttribute("aria-sort");
    head.setAttribute("aria-sort", direction > 0 ? "ascending" : "descending");
  };

  // Show the rows that contain all words of the field.
  const filter = (field) => {
    const wanted = field.value.toLowerCase().split(/\s+/).filter(Boolean);
    const scope = document.getElementById(field.dataset.scope);
    const rows = scope.querySelectorAll("tbody > tr");
    let shown = 0;
    for (const row of rows) {
      const text = (row.dataset.words ?? row.textContent).toLowerCase();
      row.hidden = !wanted.every((word) => text.includes(word));
      shown += !row.hidden;
    }
    for (const part of scope.querySelectorAll("[data-part]")) part.hidden = !part.querySelector("tbody > tr:not([hidden])");
    field.nextElementSibling.textContent = wanted.length ? `${shown} of ${rows.length}` : "";
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
    if (table.tBodies[0].rows.length >= LONG) {
      table.id ||= `table-${place}`;
      searchable(table, "Filter rows", table.parentElement);
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
