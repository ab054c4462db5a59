// A player: the moving pictures of a case, with their controls. It is made in a `figure` from the data that
// reports/runs/motions/single_body.py stores.
// Uses all other files of this folder.

// The trail of the tip of K: the angle (rad) by which the body turns along it at the largest speed, and its number of pieces.
const [TRAIL, PIECES] = [16, 120];

const firstAzimuth = (data, { truth, stateOf }) => {
  if (data.plane) {
    const [from, to] = [placeAt(truth.course, 0), placeAt(truth.course, data.end)];
    return Math.atan2(to[1] - from[1], to[0] - from[0]) - Math.PI / 2 + 0.4;
  }
  const { momentum } = stateOf(truth, 0);
  return Math.hypot(momentum[0], momentum[1]) > 0.35 * length(momentum) ? Math.atan2(momentum[1], momentum[0]) - 1.1 : -1;
};

// Returns the first time at which the shown runs are farthest from the truth, or 0 if they cannot be distinguished from it.
const firstTime = (data, { truth, stateOf }, shown) => {
  const apart = (t) => {
    const exact = stateOf(truth, t);
    return Math.max(0, ...shown.map((run) => {
      const state = stateOf(run, t);
      return (run.turnsAlike ? 0 : angleBetween(state.attitude, exact.attitude)) + (data.plane ? length(minus(state.place, exact.place)) : 0);
    }));
  };
  const instants = Array.from({ length: 201 }, (_, k) => (data.end * k) / 200);
  const worst = instants.reduce((best, t) => (apart(t) > apart(best) + 1e-6 ? t : best), 0);
  return apart(worst) > 4 * indistinct(data.within) ? worst : 0;
};

// Return the positions of the tip of K in the last `trail` seconds, and the past positions of the centre of mass on the plane.
const trailOf = (body, now, trail, tip) =>
  Array.from({ length: trail ? PIECES + 1 : 0 }, (_, i) => now - trail * (1 - i / PIECES))
    .filter((t) => t >= 0)
    .map((t) => rotate(turningAt(body.turning, t).attitude, tip));
const pastOf = (body, now) => Array.from({ length: 41 }, (_, i) => placeAt(body.course, (now * i) / 40));

// The positions of the runs that are shown first: those that the page names, or those of the data.
const shownIn = (figure, data) => figure.dataset.shown?.split(" ").map(Number) ?? data.shown;

const build = (figure, data) => {
  if (data.bodies) return void buildMechanism(figure, data);
  const motion = motionOf(data);
  const { truth, runs, stateOf, fastest } = motion;
  const solid = solidOf(data.body);
  const shown = shownIn(figure, data).map((k) => runs[k]);
  const bodies = () => [truth, ...shown];
  const tip = times(solid.exit(AXES[2]).at + AXIS, AXES[2]);
  const trail = data.plane || !fastest ? 0 : Math.min(data.end, TRAIL / fastest); // s

  const panels = panelsOf(motion, shown, () => bodyPicture(solid, data.plane), () => choose());
  const polhode = !data.plane && data.momentum ? polhodePicture(data.body, motion) : null;
  const controls = controlsOf(data.end, fastest);
  const squares = html("span", {});
  const status = html("p", { class: "unseen", role: "status" });
  const warning = html("p", { class: "note", hidden: "" });
  const stage = html("div", { class: "stage" }, ...panels.map(({ element }) => element));
  if (polhode) stage.append(polhodePanel(polhode));
  const errorsOf = (t) => {
    const exact = stateOf(truth, t);
    return shown.map((run) => {
      const { attitude, place } = stateOf(run, t);
      const shift = length(data.plane ? minus(place, exact.place) : place) * data.body.reach;
      return { angle: run.turnsAlike ? 0 : angleBetween(attitude, exact.attitude), shift };
    });
  };
  const trace = traceOf(data.end, errorsOf, indistinct(data.within), (t) => shownNow.move(t));
  figure.prepend(stage, trace.element, controls.element, warning, legendOf(data, trail, polhode, squares), status);

  // The common part of all pictures, and the frame in which they show the plane.
  let [common, frame] = [null, null];
  const look = (azimuth, elevation) => {
    const view = viewFrom(azimuth, elevation);
    if (!data.plane) return void (common = { view });
    frame = groundFrame(view, bodies(), data.body.reach);
    const how = frame.follows ? "each picture follows its body" : "all pictures show the same part of the plane";
    squares.textContent = `${how}, in squares of ${number(frame.step * data.body.reach)} m`;
    common = groundPaths(frame.view, bodies(), frame.step);
  };

  const paint = (now) => {
    const states = bodies().map((body) => stateOf(body, now));
    bodies().forEach((body, k) => {
      const { picture, words } = panels[k];
      const difference = k ? differenceOf(body, states[k], states[0], data) : { angle: 0, words: turningWords(states[0]) };
      const { view, grid, courses } = frame?.follows ? groundPaths({ ...frame.view, focus: flat(states[k].place) }, bodies(), frame.step) : common;
      panels[k].draw(view, states[k], k ? states[0] : null, {
        colour: body.colour,
        isTurned: difference.angle > indistinct(data.within),
        trail: trailOf(body, now, trail, tip),
        ...(data.plane && { grid, course: courses[k], truthCourse: k ? courses[0] : "", past: pastOf(body, now) }),
      });
      words.textContent = difference.words;
      Object.assign(picture.dataset, { time: now, view: JSON.stringify(view) });
    });
    trace.at(now);
    polhode?.draw(states.map(({ momentumInBody }) => momentumInBody));
  };
  const choose = () => {
    bodies().forEach(({ colour, label }, k) => {
      panels[k].swatch.style.background = colour;
      panels[k].picture.dataset.body = label;
    });
    polhode?.choose(bodies());
    trace.choose(shown);
    shownNow.again();
  };
  const warn = () => {
    const angle = fastest * controls.speed.value * FRAME;
    warning.hidden = angle < 1;
    warning.textContent = `At this speed the body turns by up to ${number(angle, 2)} rad between two pictures, which is more than the eye can follow.`;
  };
  const shownNow = staged({
    ...{ figure, panels, controls, look, paint, end: data.end, changeSpeed: warn, now: firstTime(data, motion, shown) },
    ...{ azimuth: firstAzimuth(data, motion), elevation: data.plane ? 0.75 : 0.4, lowest: data.plane ? 0.2 : -1.4 },
    describe: () => announce(figure, panels, shown, controls.clock.textContent, status),
  });
  choose();
  warn();
};
