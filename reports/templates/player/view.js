// Views and the projection of points: a view has the directions `right`, `up` and `toward` the eye, the point in the middle of
// the picture (`focus`), its `scale` (pixels for each unit of length at the focus) and the `distance` of the eye from the focus.
// Uses vectors.js.

// The width and height of a picture, and the coordinates of its middle, in pixels.
const [SIZE, MIDDLE] = [240, 120];

const viewFrom = (azimuth, elevation) => {
  const [c, s] = [Math.cos(elevation), Math.sin(elevation)];
  const toward = [c * Math.cos(azimuth), c * Math.sin(azimuth), s];
  const right = [-Math.sin(azimuth), Math.cos(azimuth), 0];
  return { right, up: cross(toward, right), toward, focus: [0, 0, 0], scale: 70, distance: 9 };
};
const project = (view, p) => {
  const d = minus(p, view.focus);
  const near = view.distance / (view.distance - dot(d, view.toward));
  return [MIDDLE + view.scale * near * dot(d, view.right), MIDDLE - view.scale * near * dot(d, view.up)];
};
// Returns whether the eye is on the outer side of a face. at: a point of the face.
const isSeen = (view, at, normal) => dot(normal, minus(add(view.focus, times(view.distance, view.toward)), at)) > 0;

// SVG paths through points of the picture.
const coordinates = ([x, y]) => `${x.toFixed(1)} ${y.toFixed(1)}`;
const path = (points, closed = false) => (points.length ? `M${points.map(coordinates).join("L")}${closed ? "Z" : ""}` : "");
const arrow = (from, to) => {
  const [dx, dy] = [to[0] - from[0], to[1] - from[1]];
  const size = Math.hypot(dx, dy);
  const head = Math.min(11, 0.6 * size);
  const [ux, uy] = [dx / (size || 1), dy / (size || 1)];
  const [bx, by] = [to[0] - head * ux, to[1] - head * uy];
  const wing = (side) => [bx - side * 0.45 * head * uy, by + side * 0.45 * head * ux];
  return path([from, [bx, by]]) + path([to, wing(1), wing(-1)], true);
};
// Returns the mark of a centre of mass: a cross or, if it is outside the picture, a tip at the edge that points to it.
const marker = ([x, y]) => {
  if (Math.hypot(x - MIDDLE, y - MIDDLE) < 108)
    return [[[x - 4, y - 4], [x + 4, y + 4]], [[x + 4, y - 4], [x - 4, y + 4]], [[MIDDLE, MIDDLE], [x, y]]].map((ends) => path(ends)).join("");
  const angle = Math.atan2(y - MIDDLE, x - MIDDLE);
  return path([[104, 0.06], [114, 0], [104, -0.06]].map(([r, a]) => [MIDDLE + r * Math.cos(angle + a), MIDDLE + r * Math.sin(angle + a)]));
};
