// The plane under sliding bodies: the part of it that pictures show, its grid of squares, and the paths of the bodies.
// Uses vectors.js, view.js, elements.js and body.js.

// Half the width, in reaches, of the largest part that is shown whole, and of the part that a picture following its body shows.
const [WIDEST_WHOLE, FOLLOWING] = [8, 5];

// All pictures show the same part of the plane, which contains the paths of all bodies, unless the bodies would look too small:
// then `follows` is true, and each picture follows its body. step: the side of a square of the grid.
const groundFrame = (view, bodies, reach) => {
  const places = bodies.flatMap((body) => body.course.places);
  const [[left, right], [low, high]] = [view.right, view.up].map((axis) => {
    const along = places.map((p) => dot(p, axis));
    return [Math.min(...along) - 1.02, Math.max(...along) + 1.02];
  });
  const half = Math.max(right - left, high - low) / 2;
  const middle = add(times((left + right) / 2, view.right), times((low + high) / 2, view.up));
  const focus = add(middle, times(-middle[2] / view.toward[2], view.toward)); // where the eye's ray through the middle meets the plane
  const follows = half > WIDEST_WHOLE;
  const extent = follows ? FOLLOWING : half;
  return { follows, step: nice((extent * reach) / 6) / reach, view: { ...view, focus, scale: 114 / extent, distance: 9 * extent } };
};

const groundPaths = (view, bodies, step) => {
  const courses = bodies.map((body) => path(body.course.places.map((p) => project(view, flat(p)))));
  const [x, y] = view.focus.map((at) => Math.round(at / step) * step);
  const lines = Array.from({ length: 21 }, (_, k) => [(k - 10) * step, 10 * step]);
  const ends = lines.flatMap(([d, e]) => [[[x + d, y - e, 0], [x + d, y + e, 0]], [[x - e, y + d, 0], [x + e, y + d, 0]]]);
  return { view, courses, grid: ends.map((line) => path(line.map((p) => project(view, p)))).join("") };
};
