// Functions that all pages share. Pages show the same results without scripts, which add filters, comparisons and raw rows.
"use strict";
document.documentElement.classList.add("scripts");

// The link that skips to the content does not change the address, since the address has the state of the page.
addEventListener("click", (event) => {
  if (!event.target.closest?.(".skip")) return;
  event.preventDefault();
  document.getElementById("main").focus();
});

const site = {
  /** The data of submissions by key, added by the files data/KEY.js. */
  data: {},

  /** The lists of submissions, engines, scenes and tables, set by the file data/index.js. */
  index: null,

  /** Loads a script once and resolves when it has run. A page opened from disk cannot fetch files, but can run scripts. */
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

  /** Resolves to the differing runs of all pairs of results of an engine. */
  async changes(engine) {
    const { changes } = site.index.engines.find(({ name }) => name === engine);
    await site.load(`${changes}.js`);
    return site.differences[engine];
  },

  /** The differences between results by engine, added by the files data/changes/ENGINE.js. */
  differences: {},

  /** Resolves to the case files of all submissions, by their SHA-256. */
  async cases() {
    await site.load("data/cases.js");
    return site.texts;
  },

  /** Returns the value of the JSON in an element, given by its id. */
  json(id) {
    return JSON.parse(document.getElementById(id).textContent);
  },

  /** Returns the state in the address: the part after #, as NAME=VALUE pairs joined by &. */
  state() {
    return new URLSearchParams(location.hash.includes("=") ? location.hash.slice(1) : "");
  },

  /** Writes a state into the address, as a new step in the browser history unless `replace` is true. */
  keep(state, replace = false) {
    const text = String(state);
    const now = location.hash.includes("=") ? location.hash.slice(1) : "";
    if (text === now) return;
    const address = text ? `#${text}` : location.pathname + location.search;
    if (replace) history.replaceState(null, "", address);
    else history.pushState(null, "", address);
  },

  /** Returns an element with attributes and children, which are elements or texts. */
  element(name, attributes = {}, ...children) {
    const made = document.createElement(name);
    for (const [key, value] of Object.entries(attributes)) if (value !== null) made.setAttribute(key, value);
    made.append(...children.filter((child) => child !== null && child !== ""));
    return made;
  },

  /** Returns a number as text with `digits` significant digits, without an exponent from 1e-4 to 1e4, as bodycheck writes it. */
  number(value, digits = 4) {
    if (value === null || value === undefined || Number.isNaN(value)) return "–";
    if (value === 0) return "0";
    const [mantissa, exponent] = value.toExponential(digits - 1).split("e").map(Number);
    if (exponent < -4 || exponent >= Math.max(4, digits)) return `${mantissa}e${exponent}`;
    return String(Number(`${mantissa}e${exponent}`));
  },

  /** Returns a button that copies a text and then says so. */
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
