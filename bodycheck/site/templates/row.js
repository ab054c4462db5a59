// Shows the row that the address gives as #KEY/TABLE/PLACE.
"use strict";
(() => {
  const told = document.getElementById("told");
  const place = document.getElementById("row");
  const { element } = site;

  const head = (id, text) => element("h2", { id }, text);
  const fact = (name, ...values) => [element("dt", {}, name), element("dd", {}, ...values)];
  /** Returns a value as text with all significant digits. Small and large numbers have an exponent. */
  const shown = (value) => {
    if (typeof value === "boolean") return value ? "yes" : "no";
    const size = Math.abs(value);
    return typeof value === "number" && size && (size < 1e-4 || size >= 1e16) ? value.toExponential() : String(value);
  };

  const values = (table, row) => {
    const known = Object.entries(site.index.tables[table].columns);
    const empty = known.filter(([name]) => row(name) === null).map(([, column]) => column.title);
    const listed = element(
      "div",
      { class: "scroll", role: "region", tabindex: "0", "aria-labelledby": "columns" },
      element(
        "table",
        { class: "columns", "aria-labelledby": "columns" },
        element(
          "thead",
          {},
          element("tr", {}, ...["Column", "Value with its unit", "Meaning"].map((text) => element("th", { scope: "col" }, text))),
        ),
        element(
          "tbody",
          {},
          ...known
            .filter(([name]) => row(name) !== null)
            .map(([name, column]) =>
              element(
                "tr",
                {},
                element("th", { scope: "row" }, column.title, element("code", {}, name)),
                element("td", { class: "value" }, `${shown(row(name))} ${column.unit}`.trim()),
                element("td", {}, column.meaning),
              ),
            ),
        ),
      ),
    );
    const rest = element("details", { class: "note" }, element("summary", {}, "Columns that are empty in this row"), empty.join(", "));
    return empty.length ? [listed, rest] : [listed];
  };

  const origin = (source, table, position) => {
    const { header } = source;
    const packages = { bodycheck: header.bodycheck, ...header.engines, ...header.packages };
    return element(
      "dl",
      { class: "facts" },
      ...fact("Table", `${table}, line ${position + 2}`),
      ...fact("Started", header.started),
      ...fact("Machine", source.machine),
      ...fact("Versions", Object.entries(packages).map(([name, version]) => `${name} ${version}`).join(", ")),
      ...fact("Command", element("code", {}, header.command.join(" "))),
      ...fact("Data", element("a", { href: `data/${source.key}.json` }, `data/${source.key}.json`)),
    );
  };

  const caseFile = async (source, name) => {
    const text = (await site.cases())[source.cases[name]];
    if (text === undefined) return [];
    const file = `${name}.case.toml`;
    const address = URL.createObjectURL(new Blob([text], { type: "application/toml" }));
    return [
      head("case", "Case file"),
      element("p", {}, element("a", { href: address, download: file }, `Download ${file}`), " ", site.copier("Copy", text)),
      element("pre", { tabindex: "0", role: "region", "aria-labelledby": "case" }, text),
    ];
  };

  /** The columns, apart from engine and version, that identify what a row is about. Rows to compare have equal values there. */
  const SUBJECTS = [
    ...["case", "scene", "model", "integrator", "timestep", "quantity", "subject", "figure", "setting", "property", "batch"],
    ...["from_version", "to_version"],
  ];
  const alike = (columns, row) => {
    const names = SUBJECTS.filter((name) => name in columns || row(name) !== null);
    return columns.engine.flatMap((name, position) => {
      const same = name.split("@")[0] === row("engine").split("@")[0];
      return same && names.every((one) => (columns[one]?.[position] ?? null) === row(one)) ? [position] : [];
    });
  };
  const NUMBERS = ["value", "difference", "total", "order", "q50", "after"];
  const result = (columns, table, position, scene) => {
    const kind = site.index.kinds[site.index.scenes[scene]?.kind];
    const name = [kind?.quantity, ...NUMBERS].find((one) => (columns[one]?.[position] ?? null) !== null);
    if (!name) return columns.status?.[position] ?? "–";
    const value = columns[name][position];
    const { title, unit } = site.index.tables[table].columns[name];
    return `${title} ${typeof value === "number" ? site.number(value) : value} ${unit}`.trim();
  };
  const elsewhere = (key, table, position, row) => {
    const engine = row("engine").split("@")[0];
    const others = site.index.submissions.filter(
      (source) => table in source.tables && Object.keys(source.engines).some((name) => name.split("@")[0] === engine),
    );
    const list = element("div", { role: "status" });
    const fold = element("details", {}, element("summary", {}, `The same row in other results of ${engine}`), list);
    const fill = async () => {
      const found = [];
      for (const source of others) {
        const { columns } = (await site.submission(source.key)).tables[table];
        for (const there of alike(columns, row)) {
          if (source.key === key && there === position) continue;
          const text = `${source.date} · ${engine} ${columns.version?.[there] ?? ""} · ${source.machine}`;
          const number = result(columns, table, there, row("case") ?? row("scene"));
          found.push(element("li", {}, element("a", { href: `#${source.key}/${table}/${there}` }, text), `: ${number}`));
        }
      }
      list.replaceChildren(found.length ? element("ul", {}, ...found) : "There is none.");
    };
    fold.addEventListener("toggle", () => {
      if (fold.open && !list.hasChildNodes()) fill().catch((error) => (list.textContent = `The data cannot be read: ${error.message}.`));
    });
    return fold;
  };

  const title = (table, row) => {
    const version = row("version") ?? row("to_version") ?? "";
    const names = [row("case") ?? row("scene") ?? row("model") ?? row("property"), `${row("engine").split("@")[0]} ${version}`];
    return [...names, row("integrator")].filter(Boolean).join(" · ");
  };

  let asked = 0;
  const show = async () => {
    if (!location.hash) return;
    const mine = ++asked;
    const [key, name, number] = location.hash.slice(1).split("/");
    try {
      const source = await site.submission(key);
      const table = decodeURIComponent(name ?? "");
      const position = Number(number);
      const found = Object.hasOwn(source.tables, table) ? source.tables[table] : null;
      if (!found || !Number.isInteger(position) || position < 0 || position >= found.rows) {
        throw new Error("the address names no row");
      }
      const { columns, commands } = found;
      const row = (column) => columns[column]?.[position] ?? null;
      const subject = row("case") ?? row("scene");
      const scene = subject === null ? null : site.index.scenes[subject];
      const file = subject !== null && subject in source.cases ? await caseFile(source, subject) : [];
      if (mine !== asked) return;
      document.getElementById("title").textContent = title(table, row);
      told.replaceChildren(
        `A row of the table of ${site.index.tables[table].title}, ${source.date}.`,
        ...(scene ? [" The scene: ", element("a", { href: scene.page }, subject), "."] : []),
        ...site.index.engines
          .filter(({ name }) => name === row("engine").split("@")[0])
          .flatMap(({ name, page }) => [" The engine: ", element("a", { href: page }, name), "."]),
      );
      place.replaceChildren(
        head("command", "Command that reproduces it"),
        element("pre", { tabindex: "0", role: "region", "aria-labelledby": "command" }, commands[position]),
        site.copier("Copy the command", commands[position]),
        ...(scene && !scene.shipped ? [element("p", { class: "note" }, "The case does not come with bodycheck: download its file below first.")] : []),
        head("columns", "All columns"),
        ...values(table, row),
        head("origin", "Where it comes from"),
        origin(source, table, position),
        elsewhere(key, table, position, row),
        ...file,
      );
    } catch (error) {
      if (mine !== asked) return;
      place.replaceChildren();
      told.textContent = `The row cannot be shown: ${error.message}.`;
    }
  };
  addEventListener("hashchange", show);
  show();
})();
