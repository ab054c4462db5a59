// Vectors are [x, y, z]. Quaternions are [w, x, y, z] and turn components in the body into components in the world.
// All lengths of the player are in units of the body's reach: the distance of its farthest point from its centre of mass.
const AXES = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];

const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const times = (s, a) => [s * a[0], s * a[1], s * a[2]];
const minus = (a, b) => add(a, times(-1, b));
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const length = (a) => Math.hypot(...a);
const unit = (a) => times(1 / (length(a) || 1), a);

const multiply = (p, q) => {
  const [v, u] = [p.slice(1), q.slice(1)];
  return [p[0] * q[0] - dot(v, u), ...add(add(times(p[0], u), times(q[0], v)), cross(v, u))];
};
const conjugate = (q) => [q[0], -q[1], -q[2], -q[3]];
const rotate = (q, v) => {
  const u = q.slice(1);
  const t = times(2, cross(u, v));
  return add(add(v, times(q[0], t)), cross(u, t));
};
// The quaternion of a rotation vector (rad), and the shortest rotation vector of a quaternion.
const exp = (v) => {
  const angle = length(v);
  return [Math.cos(angle / 2), ...times(angle > 1e-9 ? Math.sin(angle / 2) / angle : 0.5, v)];
};
const log = (q) => {
  const v = times(q[0] < 0 ? -1 : 1, q.slice(1));
  const sine = length(v);
  return times(sine > 1e-9 ? (2 * Math.atan2(sine, Math.abs(q[0]))) / sine : 2, v);
};
const angleBetween = (p, q) => length(log(multiply(conjugate(p), q)));

// Returns the values of a function at n angles that are evenly distributed around a circle.
const around = (n, at) => Array.from({ length: n }, (_, k) => at((2 * Math.PI * k) / n));
