// The panels of the truth and of the shown runs, side by side, each with its name, its picture and its readings.
// Uses elements.js.

// shown: the shown runs. When the reader chooses another run, the list is changed in place, and `chosen` is called.
// made: makes the picture of a panel.
const panelsOf = ({ truth, runs }, shown, made, chosen) =>
  [truth, ...shown].map((body, k) => {
    const { picture, draw } = made();
    picture.setAttribute("aria-label", body.label); // until the picture is described
    const words = html("p", { class: "reading" });
    const swatch = html("i", { class: "swatch" });
    const head = html("div", { class: "head" }, swatch);
    if (k) {
      const select = html("select", { "aria-label": `Body ${k + 1} of ${shown.length + 1}` });
      runs.forEach((run, place) => select.append(html("option", { value: place }, run.label)));
      select.value = runs.indexOf(body);
      select.addEventListener("change", () => {
        shown[k - 1] = runs[select.value];
        chosen();
      });
      head.append(select);
    } else head.append(html("span", {}, body.label));
    return { element: html("div", { class: "panel" }, head, picture, words), picture, draw, words, swatch };
  });

const polhodePanel = ({ picture }) =>
  html("div", { class: "panel wide" }, html("div", { class: "head" }, "Polhodes"), picture, html("p", { class: "reading" }, "angular momentum\nin the body"));
