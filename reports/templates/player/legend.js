// The legend under the pictures: what their lines mean.
// Uses view.js and elements.js.

// trail: its length (s), or 0. squares: an element that says what the grid shows.
const legendOf = ({ momentum, plane, within }, trail, polhode, squares) => {
  const legend = html("p", { class: "note key" });
  const explain = (kind, d, ...words) => {
    const sign = svg("svg", { viewBox: "0 0 26 12", class: "drawing sign", "aria-hidden": "true" }, svg("path", { class: kind, d }));
    legend.append(html("span", {}, sign, html("span", {}, ...words)));
  };
  if (momentum) explain("momentum", arrow([1, 6], [25, 6]), "angular momentum, its direction in space (dotted: the truth’s)");
  if (trail) explain("trail", "M1 6H25", `where the tip of K has been, for ${number(trail, 2)} s`);
  explain("ghost", "M3 2H23V10H3Z", "the truth’s body");
  if (plane) explain("course", "M1 6H25", "where the centre of mass has been; ", squares);
  else explain("offset", "M9 2 17 10M17 2 9 10", "the truth’s centre of mass; at the rim, if farther away: each body is drawn about its own");
  if (polhode) explain("polhode truth", "M1 6H25", `the truth’s polhode${polhode.hasSeparatrices ? "; broken lines: the separatrices" : ""}`);
  legend.append(html("span", {}, `Drawn within ${within} rad of the samples; a method that is nearer to the truth is drawn as the truth.`));
  return legend;
};
