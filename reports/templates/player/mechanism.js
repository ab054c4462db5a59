// The player of a mechanism: pictures of all its bodies in motion, with the truth (or, where there is none, the motion that the
// label of `truth` in the data names) and the runs side by side. It is made in a
// `figure` from the data that reports/runs/motions/several_bodies.py stores. Lengths are in units of the extent of the pictures.
// Uses all other files of this folder except player.js.

// The distance, in extents, at which places differ visibly.
const APART = 0.01;
// The thickness of capsules, as a share of their length, and its limits in pixels.
const [THICKNESS, THINNEST, THICKEST] = [0.22, 3.5, 12];

const statesAt = (parts, t) => parts.map(({ turning, course }) => ({ ...turningAt(turning, t), place: placeAt(course, t) }));
const partsOf = (entry) => entry.parts?.map(({ turning, course }) => ({ turning: readTurning(turning), course: readCourse(course) }));
const largestOf = (values) => Math.max(0, ...values);

// Returns the largest difference between the bodies of two motions: in attitude (rad) and in place.
const mechanismDifference = (states, exact) => ({
  angle: largestOf(states.map(({ attitude }, k) => angleBetween(attitude, exact[k].attitude))),
  shift: largestOf(states.map(({ place }, k) => length(minus(place, exact[k].place)))),
});

// The picture of a mechanism: solids, or capsules for bodies without a shape, the farthest first; joints; and the truth as a ghost.
const mechanismPicture = (data) => {
  const picture = svg("svg", { viewBox: `0 0 ${SIZE} ${SIZE}`, role: "img", class: "drawing scene" });
  const [below, skin, over] = [0, 1, 2].map(() => picture.appendChild(svg("g", {})));
  const grid = addPath(below, "grid");
  const solids = data.bodies.map(({ solid }) => solid && solidOf(solid));
  const wanted = addPath(below, "target");
  const [outlines, marks, ghost] = ["target outline", "stop", "ghost"].map((kind) => addPath(over, kind));
  const [pins, fixed] = ["pin", "pin fixed"].map((kind) => addPath(over, kind));
  const dot0 = (point) => `${path([point])}h0`;
  const paths = [];

  const facesOf = (view, solid, { attitude, place }, colour) => {
    const fills = new Map();
    const world = (v) => add(place, rotate(attitude, v));
    for (const { points, normal, tone, edge } of solid.faces) {
      const outward = rotate(attitude, normal);
      if (!isSeen(view, world(points[0]), outward)) continue;
      const light = 0.5 + 0.5 * dot(LIGHT, [dot(outward, view.right), dot(outward, view.up), dot(outward, view.toward)]);
      const key = `${shaded(colour, light, tone)}|${edge ? "edge" : ""}`;
      fills.set(key, (fills.get(key) ?? "") + path(points.map((p) => project(view, world(p))), true));
    }
    return [...fills].map(([key, d]) => {
      const [fill, edge] = key.split("|");
      return { d, fill, class: edge ? "face edge" : "face", stroke: edge ? "" : fill };
    });
  };
  const sticksOf = (view, sticks, { attitude, place }) =>
    sticks.map((ends) => path(ends.map((p) => project(view, add(place, rotate(attitude, p)))))).join("");

  // Seen from any side, a capsule looks like a broad line with round ends; it has a dark edge and a pale middle.
  const capsulesOf = (view, sticks, state, colour) => {
    const d = sticksOf(view, sticks, state);
    const width = Math.min(THICKEST, Math.max(THINNEST, THICKNESS * view.scale * largestOf(sticks.map(([a, b]) => length(minus(a, b))))));
    const strokes = [[shaded(colour, 0.1, 0), width], [colour, width - 1.6], [shaded(colour, 0.8, 1), 0.22 * width]];
    return sticks.length ? strokes.map(([stroke, size]) => ({ d, class: "stick", stroke, fill: "none", "stroke-width": size.toFixed(1) })) : [];
  };

  const edgesOf = (view, k, { attitude, place }) => {
    const there = (v) => add(place, rotate(attitude, v));
    const seen = ({ points, normal }) => !normal || isSeen(view, there(points[0]), rotate(attitude, normal));
    return (solids[k]?.outline ?? []).filter(seen).map(({ points }) => path(points.map((p) => project(view, there(p))), true)).join("");
  };

  // states, truth: the states of all bodies at the time `now`; truth is null in the truth's own picture and if it looks the same.
  const draw = (view, states, truth, colour, now) => {
    assign(grid, { d: (data.ground ?? []).map((line) => path(line.map((p) => project(view, p)))).join("") });
    const order = states.map((_, k) => k).sort((a, b) => dot(states[a].place, view.toward) - dot(states[b].place, view.toward));
    const drawn = order.flatMap((k) => [
      ...(solids[k] ? facesOf(view, solids[k], states[k], colour) : []),
      ...capsulesOf(view, data.bodies[k].sticks, states[k], colour),
    ]);
    drawn.forEach((attributes, k) => assign((paths[k] ??= addPath(skin, "")), attributes));
    for (let k = drawn.length; k < paths.length; k++) paths[k].setAttribute("d", "");
    const joints = states.flatMap(({ attitude, place }, k) => data.bodies[k].joints.map((p) => add(place, rotate(attitude, p))));
    assign(pins, { d: joints.map((p) => dot0(project(view, p))).join("") });
    assign(fixed, { d: data.fixed.map((p) => dot0(project(view, p))).join("") });
    assign(ghost, { d: (truth ?? []).map((state, k) => sticksOf(view, data.bodies[k].sticks, state) + edgesOf(view, k, state)).join("") });
    const targets = targetsAt(data.driven, states, now);
    assign(wanted, { d: [...targets].map(([k, pose]) => sticksOf(view, data.bodies[k].sticks, pose)).join("") });
    assign(outlines, { d: [...targets].map(([k, pose]) => edgesOf(view, k, pose)).join("") });
    assign(marks, { d: stopsOf(data.driven, states).map((ends) => path(ends.map((p) => project(view, p)))).join("") });
    picture.dataset.targets = [...targets.values()].map(({ place }) => place.join(",")).join(";");
    picture.dataset.places = states.map(({ place }) => place.join(",")).join(";");
  };
  return { picture, draw };
};

const labelOf = ({ label }) => label ?? "the truth";

const mechanismLegend = ({ within, bodies, driven, follows, known, end, truth }) => {
  const exact = labelOf(truth);
  const legend = html("p", { class: "note key" });
  const explain = (kind, d, words) =>
    legend.append(html("span", {}, svg("svg", { viewBox: "0 0 26 12", class: "drawing sign", "aria-hidden": "true" }, svg("path", { class: kind, d })), html("span", {}, words)));
  if (bodies.some(({ sticks }) => sticks.length)) explain("stick sample", "M2 9 13 3 24 9", "body without a shape, along its links");
  if (bodies.some(({ joints }) => joints.length)) explain("pin", "M13 6h0", "joint");
  explain("ghost", "M3 2H23V10H3Z", `bodies of ${exact}`);
  if (driven.some(({ target }) => target)) explain("target", "M2 9 13 3 24 9", "bodies at the targets of their joints");
  if (driven.some(({ stops }) => stops)) explain("stop", "M9 1V11M17 1V11", "stops of joints");
  if (known < end) legend.append(html("span", {}, `Mechanics gives no motion ${known < 0 ? "" : `after ${number(known, 3)} s`}, and no body of the truth is drawn then.`));
  if (follows) legend.append(html("span", {}, `Pictures follow the centre of mass of ${exact}.`));
  legend.append(html("span", {}, `Attitudes are drawn to within ${within} rad. A method that is closer to ${exact} than this is drawn like it.`));
  return legend;
};

const buildMechanism = (figure, data) => {
  const truth = { label: labelOf(data.truth), colour: TRUTH, parts: partsOf(data.truth) };
  // A run without its own parts moves as the truth does.
  const runs = data.runs.map((run) => ({ ...run, isAlike: !run.parts, parts: partsOf(run) ?? truth.parts }));
  const shown = shownIn(figure, data).map((k) => runs[k]);
  const all = () => [truth, ...shown];
  const speeds = [truth, ...runs].flatMap(({ parts }) => parts.flatMap(({ turning }) => turning.spans.map(({ start, h }) => length(start) / h)));
  const fastest = largestOf(speeds);

  const panels = panelsOf({ truth, runs }, shown, () => mechanismPicture(data), () => choose());
  const controls = controlsOf(data.end, fastest);
  const status = html("p", { class: "unseen", role: "status" });
  const stage = html("div", { class: "stage" }, ...panels.map(({ element }) => element));

  const isKnown = (t) => t <= (data.known ?? data.end);
  const errorsOf = (t) => {
    const exact = isKnown(t) ? statesAt(truth.parts, t) : null;
    return shown.map(({ isAlike, parts }) => {
      if (!exact || isAlike) return { angle: 0, shift: 0 };
      const { angle, shift } = mechanismDifference(statesAt(parts, t), exact);
      return { angle, shift: shift * data.extent };
    });
  };
  const trace = traceOf(data.end, errorsOf, indistinct(data.within), (t) => shownNow.move(t));
  figure.prepend(stage, trace.element, controls.element, mechanismLegend(data), status);

  const differenceAt = (t) => largestOf(errorsOf(t).map(({ angle, shift }) => angle + shift / data.extent));
  const instants = Array.from({ length: 101 }, (_, k) => (data.end * k) / 100);
  const worst = instants.reduce((best, t) => (differenceAt(t) > differenceAt(best) + 1e-6 ? t : best), 0);
  let view = null;
  const look = (azimuth, elevation) => (view = { ...viewFrom(azimuth, elevation), scale: 96, distance: 7 });

  const wordsOf = (run, { angle, shift }) => {
    const least = indistinct(data.within);
    const turned = run.isAlike ? atMost(run.attitude_error) : angle < least ? `< ${least}` : number(angle);
    const unsure = run.isAlike ? Infinity : 2 * largestOf(run.parts.map(({ course }) => course.within)) * data.extent;
    const shifted = shift * data.extent > 3 * unsure ? number(shift * data.extent, 2) : atMost(Math.min(run.position_error, shift * data.extent + unsure));
    return `off by ${turned} rad\nand ${shifted} m`;
  };
  const paint = (now) => {
    trace.at(now);
    const exact = statesAt(truth.parts, now);
    all().forEach((body, k) => {
      panels[k].picture.dataset.time = now;
      if (!isKnown(now)) {
        panels[k].draw(view, k ? statesAt(body.parts, now) : [], null, body.colour, now);
        panels[k].words.textContent = k ? "nothing to\ncompare with" : "mechanics gives\nno motion";
        return;
      }
      const states = k && !body.isAlike ? statesAt(body.parts, now) : exact;
      const difference = mechanismDifference(states, exact);
      const isApart = k > 0 && (difference.angle > indistinct(data.within) || difference.shift > APART);
      panels[k].draw(view, states, isApart ? exact : null, body.colour, now);
      panels[k].words.textContent = k ? wordsOf(body, difference) : `fastest body turning at\n${number(largestOf(states.map(({ rate }) => length(rate))))} rad/s`;
    });
  };
  const describe = () => {
    const time = controls.clock.textContent;
    const descriptions = panels.map(({ words }, k) => `${all()[k].label}: ${words.textContent}`);
    panels.forEach(({ picture }, k) => picture.setAttribute("aria-label", `At ${time}, ${descriptions[k]}`));
    if (status.textContent || document.activeElement?.closest(".player") === figure) status.textContent = `At ${time}: ${descriptions.join("; ")}.`;
  };
  const choose = () => {
    all().forEach(({ colour, label }, k) => {
      panels[k].swatch.style.background = colour;
      panels[k].picture.dataset.body = label;
    });
    trace.choose(shown);
    shownNow.again();
  };
  const shownNow = staged({
    ...{ figure, panels, controls, look, paint, describe, end: data.end, changeSpeed: () => {}, now: worst },
    ...{ azimuth: data.azimuth + 0.3, elevation: 0.2, lowest: -1.4 },
  });
  choose();
};
