// The bodies of a case in the truth and in the runs, and the state of each at a time.
// Uses vectors.js and tracks.js.
const TRUTH = "#8b939d";

const motionOf = (data) => {
  const { moments, axes } = data.body;
  const read = (run) => ({ ...run, turning: run.turning && readTurning(run.turning), course: run.course && readCourse(run.course) });
  const truth = { ...read(data.truth), label: "the truth", colour: TRUTH };
  // A run without its own rotation turns as the truth does.
  const runs = data.runs.map(read).map((run) => ({ ...run, turnsAlike: !run.turning, turning: run.turning ?? truth.turning }));

  // The angular momentum along the axes of the body, in units of the truth's largest angular momentum.
  const momentumOf = (rate) => {
    const along = rotate(conjugate(axes), rate);
    return times(1 / (data.momentum || Infinity), rotate(axes, along.map((x, i) => x * moments[i])));
  };
  // `place` is the position of the body on the plane or, in flight, its position relative to the truth's body.
  const stateOf = (body, t) => {
    const { attitude, rate } = turningAt(body.turning, t);
    const momentumInBody = momentumOf(rate);
    const place = body.course ? placeAt(body.course, t) : [0, 0, 0];
    return { attitude, rate, momentumInBody, momentum: rotate(attitude, momentumInBody), place };
  };
  const speeds = [truth, ...runs].map(({ turning }) => Math.max(...turning.spans.map(({ start, h }) => length(start) / h)));
  return { truth, runs, momentumOf, stateOf, fastest: Math.max(...speeds) };
};
