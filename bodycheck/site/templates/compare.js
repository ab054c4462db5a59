// Shows two results of an engine, run by run. The script reads from data/changes/ENGINE.js which runs differ.
"use strict";
(() => {
  const form = document.getElementById("choice");
  const told = document.getElementById("told");
  const found = document.getElementById("found");
  const marks = site.json("marks");
  const opening = site.json("opening"); // the engine that differs most between two of its results; empty if none differs
  const { engine, left, right, all } = form.elements;

  // Returns the results of an engine that can be compared, the newest first; each is a submission, a version and a table.
  const sides = (name) =>
    site.index.submissions
      .flatMap((source) =>
        source.runs
          .filter((runs) => runs.engine === name)
          .map((runs) => ({
            value: `${source.key}:${runs.version}:${runs.table}`,
            text: `${source.date} · ${runs.version} · ${source.machine} · ${runs.rows} ${runs.rows === 1 ? "run" : "runs"}`,
            ...runs,
            source,
          })),
      )
      .reverse();
  const options = (select, offered, chosen) => {
    select.replaceChildren(...offered.map(({ value, text }) => site.element("option", { value }, text)));
    if (offered.some(({ value }) => value === chosen)) select.value = chosen;
  };

  const rowsOf = async (side) => {
    const data = await site.submission(side.source.key);
    const { columns } = data.tables[side.table];
    const rows = new Map();
    columns.engine.forEach((name, place) => {
      if (name.split("@")[0] !== side.engine || columns.version[place] !== side.version) return;
      const get = (column) => columns[column]?.[place] ?? null;
      if (get("case") === null || get("timestep") === null) return;
      const key = JSON.stringify([get("case"), get("integrator"), get("timestep")]);
      const address = `row.html#${side.source.key}/${side.table}/${place}`;
      rows.set(key, { get, address, place });
    });
    return rows;
  };

  /** Resolves to a function from two runs to the column that differs: "status" or a quantity, or "" if neither differs. */
  const differences = async (one, other) => {
    const { results, pairs } = await site.changes(one.engine);
    const [before, after] = [one, other].map((side) =>
      results.findIndex(({ submission, version, table }) => `${submission}:${version}:${table}` === side.value),
    );
    if (before < 0 || after < 0) throw new Error("of a submission with very many versions, only some are compared");
    const listed = (first, second) => pairs.find((pair) => pair.before === first && pair.after === second)?.differences;
    const forwards = listed(before, after);
    // Runs are listed by their indices in the table of the older results.
    const known = Object.entries(forwards ?? listed(after, before) ?? {});
    const what = new Map(known.flatMap(([quantity, places]) => places.map((place) => [place, quantity])));
    return (then, now) => what.get((forwards ? then : now).place) ?? "";
  };
  const inWords = (before, after, kind, what) => {
    if (!after) return "only before";
    if (!before) return "only after";
    if (what === "status") {
      const [then, now] = [before.get("status"), after.get("status")];
      if (now === "ok") return `completes now; ${then} before`;
      return then === "ok" ? `${now} now; completed before` : `${now} now; ${then} before`;
    }
    if (!what) return "no difference";
    const [then, now] = [before.get(kind.quantity), after.get(kind.quantity)];
    const factor = Math.max(then, now) / Math.min(then, now);
    const by = Number.isFinite(factor) ? ` by a factor of ${site.number(factor, 3)}` : "";
    return now > then ? `${marks.worse} worse${by}` : `${marks.better} better${by}`;
  };

  const entry = (row, kind) => {
    if (!row) return site.element("td", {}, "–");
    const value = row.get(kind.quantity);
    const bound = row.get(kind.bound);
    const text = row.get("status") !== "ok" ? row.get("status") : value === null ? "ok" : `${site.number(value)} ${kind.unit}`;
    const title = bound === null ? null : `bound of the truth's own error ${site.number(bound, 2)} ${kind.unit}`;
    return site.element("td", { class: "number", title }, site.element("a", { href: row.address }, text.trim()));
  };
  const line = ({ scene, integrator, timestep, before, after, kind, what }) =>
    site.element(
      "tr",
      {},
      site.element("th", { scope: "row" }, site.element("a", { href: site.index.scenes[scene].page }, scene)),
      site.element("td", {}, `${integrator} at ${site.number(timestep * 1e3, 12)} ms`),
      site.element("td", {}, kind.quantity_title),
      entry(before, kind),
      entry(after, kind),
      site.element("td", {}, inWords(before, after, kind, what)),
    );
  const tabled = (lines, title) => {
    const heads = ["Scene", "Method", "Quantity", "Before", "After", "What changed"];
    return site.element(
      "div",
      { class: "scroll", role: "region", tabindex: "0", "aria-label": title },
      site.element(
        "table",
        {},
        site.element("caption", {}, title),
        site.element("thead", {}, site.element("tr", {}, ...heads.map((text) => site.element("th", { scope: "col" }, text)))),
        site.element("tbody", {}, ...lines.map(line)),
      ),
    );
  };

  const show = async (one, other) => {
    const [before, after, compared] = await Promise.all([rowsOf(one), rowsOf(other), differences(one, other)]);
    const lines = [...new Set([...before.keys(), ...after.keys()])].flatMap((key) => {
      const [scene, integrator, timestep] = JSON.parse(key);
      const known = site.index.scenes[scene];
      if (!known) return [];
      const kind = site.index.kinds[known.kind];
      const pair = { scene, integrator, timestep, kind, before: before.get(key), after: after.get(key) };
      return [{ ...pair, what: pair.before && pair.after ? compared(pair.before, pair.after) : "" }];
    });
    const both = lines.filter((pair) => pair.before && pair.after);
    const differ = both.filter((pair) => pair.what);
    const count = (number, noun) => `${number} ${noun}${number === 1 ? "" : "s"}`;
    const alone = [
      [before.size - both.length, "before"],
      [after.size - both.length, "after"],
    ].filter(([number]) => number > 0);
    told.textContent =
      `${differ.length} of ${count(both.length, "run")} that both have ${differ.length === 1 ? "differs" : "differ"} by more than rounding.` +
      alone.map(([number, side]) => ` ${count(number, "run")} only ${side}.`).join("");
    // What differs comes first, the largest changes of all at the top: those of a status, and then by the ratio of the errors.
    const size = ({ what, kind, before: then, after: now }) => {
      if (!what) return 0;
      if (what === "status") return Infinity;
      const [small, large] = [then, now].map((row) => Math.abs(row.get(kind.quantity))).sort((one, next) => one - next);
      return large / small;
    };
    const listed = (all.checked ? lines : differ)
      .map((pair) => ({ ...pair, size: size(pair) }))
      .sort((pair, next) => (next.size === pair.size ? pair.scene.localeCompare(next.scene) : next.size > pair.size ? 1 : -1));
    found.replaceChildren(...(listed.length ? [tabled(listed, all.checked ? "All runs" : "Runs that differ")] : []));
  };

  /** Resolves to the values of the two results of an engine that differ in most runs, the newer ones first; null if none differ. */
  const pairOf = async (name) => {
    const { results, pairs } = await site.changes(name);
    const amount = ({ differences }) => Object.values(differences).reduce((sum, places) => sum + places.length, 0);
    const most = pairs.reduce((best, pair) => (best && amount(best) > amount(pair) ? best : pair), null);
    const value = ({ submission, version, table }) => `${submission}:${version}:${table}`;
    return most && [most.before, most.after].map((place) => value(results[place]));
  };

  let asked = 0;
  const apply = async () => {
    const state = site.state();
    const names = site.index.engines.map(({ name }) => name).filter((name) => sides(name).length > 0);
    const place = ++asked;
    const first = state.get("engine") ?? (opening || names.find((name) => sides(name).length > 1));
    options(engine, names.map((name) => ({ value: name, text: name })), first);
    const offered = sides(engine.value);
    if (!offered.length) return void (told.textContent = "There are no runs to compare.");
    told.textContent = "The data is read.";
    found.replaceChildren();
    try {
      const pair = await pairOf(engine.value);
      if (place !== asked) return;
      options(left, offered, state.get("left") ?? pair?.[0] ?? offered[1]?.value);
      options(right, offered, state.get("right") ?? pair?.[1] ?? offered[0]?.value);
      all.checked = state.get("all") === "1";
      if (!pair && !state.has("left") && !all.checked) {
        const results = offered.length === 1 ? "There is one set of results" : `None of the ${offered.length} sets of results`;
        const more = offered.length === 1 ? ", and so nothing to compare it with." : " differ by more than rounding in a run that two of them share.";
        return void (told.textContent = `${results} of ${engine.value}${more}`);
      }
      const [one, other] = [left, right].map((select) => offered.find(({ value }) => value === select.value));
      if (!one || !other) return void (told.textContent = "There are no runs to compare.");
      await show(one, other);
    } catch (error) {
      if (place === asked) told.textContent = `The data cannot be read: ${error.message}.`;
    }
  };
  const chosen = () => {
    const state = new URLSearchParams({ engine: engine.value, left: left.value, right: right.value });
    if (all.checked) state.set("all", "1");
    site.keep(state);
    apply();
  };

  engine.addEventListener("input", () => {
    site.keep(new URLSearchParams({ engine: engine.value, ...(all.checked ? { all: "1" } : {}) }));
    apply();
  });
  for (const field of [left, right, all]) field.addEventListener("input", chosen);
  document.getElementById("swap").addEventListener("click", () => {
    [left.value, right.value] = [right.value, left.value];
    chosen();
  });
  form.addEventListener("submit", (event) => event.preventDefault());
  addEventListener("popstate", apply);
  addEventListener("hashchange", apply);
  apply();
})();
