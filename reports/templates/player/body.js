// The picture of one body: its faces, its axes I, J and K, the trail of the tip of K, its angular momentum, and the truth's
// body for comparison. On a plane, also the grid and the paths of the bodies.
// Uses vectors.js, view.js and elements.js.

// The direction of the light, with components to the right, up and toward the eye.
const LIGHT = unit([-0.35, 0.8, 0.5]);
// Lengths in units of the body's reach: of an axis outside the body, and of the arrow for the truth's largest angular momentum.
const [AXIS, ARROW] = [0.3, 1.5];

const shaded = (colour, light, tone) => {
  const level = Math.round(16 * light) / 16;
  const channels = [1, 3, 5].map((k) => parseInt(colour.slice(k, k + 2), 16));
  const toned = channels.map((c) => (tone ? c + 0.6 * (255 - c) : c) * (0.35 + 0.8 * level));
  return `rgb(${toned.map((c) => Math.min(255, Math.round(c))).join(" ")})`;
};
const flat = ([x, y]) => [x, y, 0];

// The body is drawn between two layers: the parts that stick out of it are drawn behind it or in front of it.
const bodyPicture = (solid, onPlane) => {
  const picture = svg("svg", { viewBox: `0 0 ${SIZE} ${SIZE}`, role: "img", class: "drawing scene" });
  const layer = () => picture.appendChild(svg("g", {}));
  const [ground, behind, skin, before] = [layer(), layer(), layer(), layer()];
  const grid = addPath(ground, "grid");
  const [course, truthCourse, past] = ["course whole", "course other", "course"].map((kind) => addPath(ground, kind));
  const sides = [behind, before].map((parent) => ({
    axes: addPath(parent, "axes"),
    old: addPath(parent, "trail old"),
    trail: addPath(parent, "trail"),
    arrow: addPath(parent, "momentum"),
  }));
  const [ghost, truthMomentum, offset] = ["ghost", "momentum other", "offset"].map((kind) => addPath(before, kind));
  const letters = [..."IJK"].map((letter) => before.appendChild(svg("text", { class: "letter" }, letter)));

  // Faces of the same colour share a path, and paths are reused for the next picture.
  const paths = [];
  const drawFaces = (view, attitude, world, colour) => {
    const fills = new Map();
    for (const { points, normal, tone, edge } of solid.faces) {
      const outward = rotate(attitude, normal);
      if (!isSeen(view, world(points[0]), outward)) continue;
      const light = 0.5 + 0.5 * dot(LIGHT, [dot(outward, view.right), dot(outward, view.up), dot(outward, view.toward)]);
      const key = `${shaded(colour, light, tone)}|${edge ? "edge" : ""}`;
      fills.set(key, (fills.get(key) ?? "") + path(points.map((p) => project(view, world(p))), true));
    }
    let k = 0;
    for (const [key, d] of fills) {
      const [fill, edge] = key.split("|");
      paths[k] ??= addPath(skin, "");
      assign(paths[k++], { d, fill, class: edge ? "face edge" : "face", stroke: edge ? "" : fill });
    }
    for (; k < paths.length; k++) paths[k].setAttribute("d", "");
  };

  const drawWhatSticksOut = (view, body, centre, world, trail) => {
    const parts = sides.map(() => ({ axes: "", old: "", trail: "", arrow: "" }));
    // In front of the body (1) if the face through which a direction leaves it is visible, else behind it (0).
    const leave = (direction) => {
      const { at, normal } = solid.exit(direction);
      return { at, side: Number(isSeen(view, world(times(at, direction)), rotate(body.attitude, normal))) };
    };
    for (const [k, axis] of AXES.entries()) {
      const { at, side } = leave(axis);
      if (letters[k].parentNode !== [behind, before][side]) [behind, before][side].append(letters[k]);
      parts[side].axes += path([at, at + AXIS].map((far) => project(view, world(times(far, axis)))));
      const [x, y] = project(view, world(times(at + AXIS + 0.13, axis)));
      assign(letters[k], { x: x.toFixed(1), y: (y + 4).toFixed(1), visibility: view.scale > 40 ? "visible" : "hidden" });
    }
    const tips = trail.map((tip) => project(view, add(centre, tip)));
    trail.forEach((tip, k) => {
      if (k) parts[Number(dot(tip, view.toward) > 0)][2 * k < tips.length ? "old" : "trail"] += path([tips[k - 1], tips[k]]);
    });
    const momentum = times(ARROW, body.momentum);
    const size = length(momentum);
    if (size > 0) {
      const { at, side } = leave(rotate(conjugate(body.attitude), times(1 / size, momentum)));
      if (size > at) {
        const from = project(view, add(centre, times(at / size, momentum)));
        parts[side].arrow = arrow(from, project(view, add(centre, momentum)));
      }
    }
    sides.forEach((side, k) => Object.entries(parts[k]).forEach(([name, d]) => side[name].setAttribute("d", d)));
  };

  const drawTruth = (view, body, truth, centre, isTurned) => {
    let [outline, direction, pointer] = ["", "", ""];
    if (truth) {
      const seat = onPlane ? truth.place : centre;
      const there = (v) => add(seat, rotate(truth.attitude, v));
      if (isTurned || (onPlane && length(minus(body.place, truth.place)) > 0.01))
        for (const { points, normal } of solid.outline)
          if (!normal || isSeen(view, there(points[0]), rotate(truth.attitude, normal)))
            outline += path(points.map((p) => project(view, there(p))), true);
      const fixed = times(ARROW, truth.momentum);
      if (length(minus(times(ARROW, body.momentum), fixed)) > 0.01) direction = path([project(view, seat), project(view, add(seat, fixed))]);
      if (!onPlane && length(body.place) > 0.01) pointer = marker(project({ ...view, distance: 1e9 }, times(-1, body.place)));
    }
    assign(ghost, { d: outline });
    assign(truthMomentum, { d: direction });
    assign(offset, { d: pointer });
  };

  // body, truth: states; truth is null in the truth's own picture. extras: the colour of the body, `isTurned` if it differs visibly
  // from the truth's attitude, the trail and, on a plane, the grid, the paths, and past positions of the body.
  const draw = (view, body, truth, extras) => {
    const centre = onPlane ? body.place : [0, 0, 0];
    const world = (v) => add(centre, rotate(body.attitude, v));
    drawFaces(view, body.attitude, world, extras.colour);
    drawWhatSticksOut(view, body, centre, world, extras.trail);
    drawTruth(view, body, truth, centre, extras.isTurned);
    if (onPlane) {
      assign(grid, { d: extras.grid });
      assign(course, { d: extras.course });
      assign(past, { d: path(extras.past.map((p) => project(view, flat(p)))) });
      assign(truthCourse, { d: extras.truthCourse });
    }
    Object.assign(picture.dataset, {
      quaternion: body.attitude.join(","),
      corner: project(view, world(solid.corner)).join(","),
      momentum: body.momentum.join(","),
      place: body.place.join(","),
    });
  };
  return { picture, draw };
};
