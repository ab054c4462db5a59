// The bodies of one case, the truth's and those of the runs, and the state that each has at a time.
// Uses vectors.js and tracks.js.
const TRUTH = "#8b939d";

const motionOf = (data) => {
  const { moments, axes } = data.body;
  const read = (run) => ({ ...run, turning: run.turning && readTurning(run.turning), course: run.course && readCourse(run.course) });
  const truth = { ...read(data.truth), label: "the truth", colour: TRUTH };
  // A run without a turning of its own turns as the truth does.
  const runs = data.runs.map(read).map((run) => ({ ...run, turnsAlike: !run.turning, turning: run.turning ?? truth.turning }));

  // The angular momentum along the axes of the body, in units of the size that the truth's has at the beginning.
  const momentumOf = (rate) => {
    const along = rotate(conjugate(axes), rate);
    return times(1 / (data.momentum || Infinity), rotate(axes, along.map((x, i) => x * moments[i])));
  };
  // `place` is where the body is on the plane; in flight, where it is relative to the truth's body.
  const stateOf = (body, t) => {
    const { attitude, rate } = turningAt(body.turning, t);
    const momentumInBody = momentumOf(rate);
    const place = body.course ? placeAt(body.course, t) : [0, 0, 0];
    return { attitude, rate, momentumInBody, momentum: rotate(attitude, momentumInBody), place };
  };
  const speeds = [truth, ...runs].map(({ turning }) => Math.max(...turning.spans.map(({ start, h }) => length(start) / h)));
  return { truth, runs, momentumOf, stateOf, fastest: Math.max(...speeds) };
};
