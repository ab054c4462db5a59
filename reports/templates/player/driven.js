// The targets and the stops of joints, from the data that reports/runs/motions/driven.py stores.
// Uses vectors.js and tracks.js.

// Returns the value of a target at a time, on straight lines between its points.
const valueAt = ({ t, value }, now) => {
  const k = spanAt(t, now);
  return value[k] + (value[k + 1] - value[k]) * Math.min(1, (now - t[k]) / (t[k + 1] - t[k]));
};
// Returns the joint's origin and the pose of its body, from the pose of the parent and the coordinate of the joint.
const poseAt = ({ at, turn, axis, slides, centre }, parent, value) => {
  const frame = multiply(parent.attitude, turn);
  const attitude = slides ? frame : multiply(frame, exp(times(value, axis)));
  const origin = add(add(parent.place, rotate(parent.attitude, at)), slides ? rotate(frame, times(value, axis)) : [0, 0, 0]);
  return { attitude, origin, place: add(origin, rotate(attitude, centre)) };
};
const FIXED = { attitude: [1, 0, 0, 0], place: [0, 0, 0] };

// Returns the poses of bodies with all joints at their targets, by the index of the body. Joints without one are as they are.
const targetsAt = (driven, states, now) => {
  const poses = new Map();
  for (const joint of driven)
    if (joint.target) poses.set(joint.body, poseAt(joint, poses.get(joint.parent) ?? states[joint.parent] ?? FIXED, valueAt(joint.target, now)));
  return poses;
};
// Returns the ends of the lines that show stops.
const stopsOf = (driven, states) =>
  driven.flatMap((joint) =>
    (joint.stops ?? []).flatMap((stop) => {
      const { attitude, origin } = poseAt(joint, states[joint.parent] ?? FIXED, stop);
      return joint.lines.map((ends) => ends.map((end) => add(origin, rotate(attitude, end))));
    }),
  );
