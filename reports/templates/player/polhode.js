// The picture of the polhodes: the paths of the angular momentum along the axes of the body, on the sphere whose radius is the
// magnitude of the truth's angular momentum.
// Uses vectors.js, tracks.js, view.js, elements.js and motion.js.
const polhodePicture = ({ moments, axes }, { truth, momentumOf }) => {
  const name = "Polhodes: the angular momentum along the axes of the body";
  const picture = svg("svg", { viewBox: `0 0 ${SIZE} ${SIZE}`, role: "img", class: "drawing scene", "aria-label": name });
  const polhode = ({ instants, spans }) =>
    spans.flatMap(({ h }, k) =>
      Array.from({ length: 9 }, (_, part) => momentumOf(turningAt({ instants, spans }, instants[k] + (h * part) / 8).rate)),
    );

  // The direction of view is the one in which the truth's polhode encloses the largest area and begins on the near side.
  const truthPath = polhode(truth.turning);
  const area = truthPath.reduce((sum, p, k) => (k ? add(sum, cross(truthPath[k - 1], p)) : sum), [0, 0, 0]);
  const corners = [[1, 0.75, 0.7], [-1, 0.75, 0.7], [1, -0.75, 0.7], [-1, -0.75, 0.7]].map(unit);
  const open = corners.reduce((best, corner) => (Math.abs(dot(area, corner)) > Math.abs(dot(area, best)) + 1e-6 ? corner : best));
  const toward = times(dot(truthPath[0], open) < 0 ? -1 : 1, open);
  const right = unit(cross([0, 0, 1], toward));
  const view = { right, up: cross(toward, right), toward, focus: [0, 0, 0], scale: 88, distance: 1e6 };

  // Returns the SVG paths through the points on the far side and on the near side of the sphere.
  const halves = (points) => {
    const d = ["", ""];
    points.forEach((p, k) => k && (d[Number(dot(p, toward) > 0)] += path([project(view, points[k - 1]), project(view, p)])));
    return d;
  };
  const addCurve = (parent, points, kind, attributes) =>
    halves(points).forEach((d, near) => addPath(parent, `${kind}${near ? "" : " back"}`, { d, ...attributes }));

  picture.append(svg("circle", { class: "ball", cx: MIDDLE, cy: MIDDLE, r: view.scale }));
  // Two circles through the axis of the intermediate moment separate the polhodes about the other two axes.
  const [low, middle, high] = [0, 1, 2].sort((i, j) => moments[i] - moments[j]);
  const [below, above] = [1 / moments[low] - 1 / moments[middle], 1 / moments[middle] - 1 / moments[high]];
  const hasSeparatrices = Math.min(below, above) * moments[middle] > 0.01;
  if (hasSeparatrices)
    for (const side of [1, -1]) {
      const other = unit(add(times(side * Math.sqrt(above), AXES[low]), times(Math.sqrt(below), AXES[high])));
      const points = around(120, (angle) => rotate(axes, add(times(Math.cos(angle), AXES[middle]), times(Math.sin(angle), other))));
      addCurve(picture, [...points, points[0]], "separatrix", {});
    }
  AXES.forEach((axis, k) => {
    const isNear = dot(axis, toward) > 0;
    addPath(picture, `axes${isNear ? "" : " back"}`, { d: path([axis, times(1.18, axis)].map((p) => project(view, p))) });
    const [x, y] = project(view, times(1.27, axis));
    picture.append(svg("text", { class: "letter", x, y: y + 4, "fill-opacity": isNear ? 1 : 0.45 }, "IJK"[k]));
  });

  const curves = picture.appendChild(svg("g", {}));
  const dots = picture.appendChild(svg("g", {}));
  // Draws the polhodes of bodies, with a dot for each body; the truth is the first body.
  const choose = (bodies) => {
    curves.replaceChildren();
    dots.replaceChildren();
    for (const { turning, colour, turnsAlike } of bodies) {
      const isTruth = colour === TRUTH;
      if (!turnsAlike) addCurve(curves, polhode(turning), `polhode${isTruth ? " truth" : ""}`, { stroke: colour });
      dots.append(svg("circle", { class: "dot", fill: colour, r: isTruth ? 6 : 4.5 }));
    }
  };
  // Moves the dots to the angular momenta of the bodies.
  const draw = (momenta) => {
    momenta.forEach((momentum, k) => {
      const [x, y] = project(view, momentum);
      assign(dots.children[k], { cx: x.toFixed(1), cy: y.toFixed(1), "fill-opacity": dot(momentum, toward) > 0 ? 1 : 0.35 });
    });
    picture.dataset.truth = momenta[0].join(",");
  };
  return { picture, choose, draw, hasSeparatrices };
};
