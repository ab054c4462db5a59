// Sorts the rows of tables of class "sortable" by the column whose head is pressed: numbers by data-value, others as text.
"use strict";
for (const table of document.querySelectorAll("table.sortable")) {
  const heads = [...table.tHead.rows[0].cells];
  const body = table.tBodies[0];
  heads.forEach((head, column) => {
    if (head.classList.contains("unsorted")) return;
    const button = site.element("button", { type: "button", class: "sort" }, ...head.childNodes);
    head.append(button);
    button.addEventListener("click", () => {
      const descends = head.getAttribute("aria-sort") === "ascending";
      heads.forEach((other) => other.removeAttribute("aria-sort"));
      head.setAttribute("aria-sort", descends ? "descending" : "ascending");
      const keyed = [...body.rows].map((row) => ({ row, ...keyOf(row.cells[column]) }));
      // Cells without a number come last in both directions.
      keyed.sort((a, b) => a.lacks - b.lacks || (descends ? -1 : 1) * compare(a.key, b.key));
      body.append(...keyed.map(({ row }) => row));
    });
  });
}

function keyOf(cell) {
  const value = cell.dataset.value;
  if (value === undefined) return { key: cell.textContent, lacks: 0 };
  return value === "" ? { key: 0, lacks: 1 } : { key: Number(value), lacks: 0 };
}

function compare(one, other) {
  return typeof one === "number" ? one - other : one.localeCompare(other, "en", { numeric: true });
}
