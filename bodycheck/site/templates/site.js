// What all pages share. Pages without scripts show the same results; scripts add filters, comparisons and raw rows.
"use strict";
document.documentElement.classList.add("scripts");

// The link that skips to the content leaves the address as it is, since the address has the state of the page.
addEventListener("click", (event) => {
  if (!event.target.closest?.(".skip")) return;
  event.preventDefault();
  document.getElementById("main").focus();
});

const site = {
  /** Data of submissions by key, which the files data/KEY.js add. */
  data: {},

  /** The list of submissions, engines, scenes and tables, which the file data/index.js sets. */
  index: null,

  /** Loads a script of the site once. From disk a page may not fetch a file, but it may run one. Resolves when it has run. */
  load(address) {
    site.loading[address] ??= new Promise((done, fail) => {
      const script = document.createElement("script");
      script.src = address;
      script.onload = () => done();
      script.onerror = () => fail(new Error(`${address} cannot be read`));
      document.head.append(script);
    });
    return site.loading[address];
  },
  loading: {},

  /** Resolves to the data of a submission. */
  async submission(key) {
    if (!/^[0-9a-f]+$/.test(key)) throw new Error("the address names no submission");
    await site.load(`data/${key}.js`);
    return site.data[key];
  },

  /** Resolves to which runs of two results of an engine differ, of all pairs of its results. */
  async changes(engine) {
    const { changes } = site.index.engines.find(({ name }) => name === engine);
    await site.load(`${changes}.js`);
    return site.differences[engine];
  },

  /** Differences between results by engine, which the files data/changes/ENGINE.js add. */
  differences: {},

  /** Resolves to the case files of all submissions, by their SHA-256. */
  async cases() {
    await site.load("data/cases.js");
    return site.texts;
  },

  /** The JSON of an element. */
  json(id) {
    return JSON.parse(document.getElementById(id).textContent);
  },

  /** The state in the address: what follows # as NAME=VALUE, joined by &. */
  state() {
    return new URLSearchParams(location.hash.includes("=") ? location.hash.slice(1) : "");
  },

  /** Puts a state into the address. A step in the history is made unless `replace` says otherwise. */
  keep(state, replace = false) {
    const text = String(state);
    const now = location.hash.includes("=") ? location.hash.slice(1) : "";
    if (text === now) return;
    const address = text ? `#${text}` : location.pathname + location.search;
    if (replace) history.replaceState(null, "", address);
    else history.pushState(null, "", address);
  },

  /** An element with attributes and children, which are elements or texts. */
  element(name, attributes = {}, ...children) {
    const made = document.createElement(name);
    for (const [key, value] of Object.entries(attributes)) if (value !== null) made.setAttribute(key, value);
    made.append(...children.filter((child) => child !== null && child !== ""));
    return made;
  },

  /** A number with so many significant digits, as bodycheck writes it: without an exponent from 1e-4 to 1e4. */
  number(value, digits = 4) {
    if (value === null || value === undefined || Number.isNaN(value)) return "–";
    if (value === 0) return "0";
    const [mantissa, exponent] = value.toExponential(digits - 1).split("e").map(Number);
    if (exponent < -4 || exponent >= Math.max(4, digits)) return `${mantissa}e${exponent}`;
    return String(Number(`${mantissa}e${exponent}`));
  },

  /** A button that copies a text, and says so. */
  copier(title, text) {
    const button = site.element("button", { type: "button" }, title);
    const told = site.element("span", { role: "status", class: "note" });
    button.addEventListener("click", async () => {
      try {
        await navigator.clipboard.writeText(text);
        told.textContent = " copied";
      } catch {
        told.textContent = " the browser does not allow it; select the text";
      }
    });
    return site.element("span", {}, button, told);
  },
};
