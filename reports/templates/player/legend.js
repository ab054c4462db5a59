// The legend under the pictures, which explains their lines.
// Uses view.js and elements.js.

// trail: the length of the trail (s), or 0. squares: an element that explains the grid.
const legendOf = ({ momentum, plane, within }, trail, polhode, squares) => {
  const legend = html("p", { class: "note key" });
  const explain = (kind, d, ...words) => {
    const sign = svg("svg", { viewBox: "0 0 26 12", class: "drawing sign", "aria-hidden": "true" }, svg("path", { class: kind, d }));
    legend.append(html("span", {}, sign, html("span", {}, ...words)));
  };
  if (momentum) explain("momentum", arrow([1, 6], [25, 6]), "angular momentum in space (dotted: that of the truth)");
  if (trail) explain("trail", "M1 6H25", `path of the tip of K during the last ${number(trail, 2)} s`);
  explain("ghost", "M3 2H23V10H3Z", "body of the truth");
  if (plane) explain("course", "M1 6H25", "path of the centre of mass; ", squares);
  else explain("offset", "M9 2 17 10M17 2 9 10", "centre of mass of the truth, relative to that of the body; at the rim if it is farther away");
  if (polhode) explain("polhode truth", "M1 6H25", `polhode of the truth${polhode.hasSeparatrices ? " (dashed: the separatrices)" : ""}`);
  legend.append(html("span", {}, `Attitudes are drawn to within ${within} rad. A method that is closer to the truth than this is drawn like the truth.`));
  return legend;
};
