// Convex solids. Each has `faces` (points, outward normal, tone: 0 plain or 1 pale), an `outline` of loops for drawing it as
// a ghost, a `corner` that the tests follow, and `exit`, which returns where a ray from the centre leaves the solid.
// Uses vectors.js.

const brick = (half) => {
  const faces = [];
  for (const [axis, normal] of AXES.entries())
    for (const sign of [1, -1]) {
      const [u, v] = [AXES[(axis + 1) % 3], AXES[(axis + 2) % 3]];
      const corner = (share) => ([s, r]) => AXES.map((_, i) => half[i] * (sign * normal[i] + share * (s * u[i] + r * v[i])));
      const square = [[1, 1], [-1, 1], [-1, -1], [1, -1]];
      const loop = sign > 0 ? square : [...square].reverse();
      faces.push({ points: loop.map(corner(1)), normal: times(sign, normal), tone: 0, edge: true });
      // A pale panel marks the face through which K leaves the brick.
      if (sign > 0 && axis === 2) faces.push({ points: loop.map(corner(0.5)), normal, tone: 1, edge: false });
    }
  const exit = (d) => {
    const shares = half.map((size, i) => size / Math.abs(d[i]));
    const axis = shares.indexOf(Math.min(...shares));
    return { at: shares[axis], normal: times(Math.sign(d[axis]), AXES[axis]) };
  };
  return { faces, outline: faces.filter(({ edge }) => edge), exit, corner: half };
};

// A cylinder about K. Its quarters have alternating tones, so that its spin is visible.
const cylinder = ([radius, , half]) => {
  const n = 32;
  const rim = (z) => (angle) => [radius * Math.cos(angle), radius * Math.sin(angle), z];
  const [top, bottom] = [around(n, rim(half)), around(n, rim(-half))];
  const quarter = (k) => Math.floor((4 * k) / n) % 2;
  const faces = top.map((_, k) => {
    const next = (k + 1) % n;
    const middle = (2 * Math.PI * (k + 0.5)) / n;
    return { points: [bottom[k], bottom[next], top[next], top[k]], normal: [Math.cos(middle), Math.sin(middle), 0], tone: quarter(k) };
  });
  for (const [loop, sign] of [[top, 1], [bottom, -1]])
    for (let q = 0; q < 4; q++) {
      const arc = Array.from({ length: n / 4 + 1 }, (_, k) => loop[((q * n) / 4 + k) % n]);
      faces.push({ points: [[0, 0, sign * half], ...arc], normal: [0, 0, sign], tone: (q + (sign < 0)) % 2 });
    }
  const exit = (d) => {
    const [side, end] = [radius / Math.hypot(d[0], d[1]), half / Math.abs(d[2])];
    return side < end ? { at: side, normal: unit([d[0], d[1], 0]) } : { at: end, normal: [0, 0, Math.sign(d[2])] };
  };
  return { faces, outline: [{ points: top }, { points: bottom }], exit, corner: [radius, 0, half] };
};

// An ellipsoid. Its eighths have alternating tones.
const ellipsoid = (semi) => {
  const [n, m] = [24, 12];
  const on = (u, v) => [semi[0] * Math.cos(v) * Math.cos(u), semi[1] * Math.cos(v) * Math.sin(u), semi[2] * Math.sin(v)];
  const normalAt = (p) => unit(p.map((x, i) => x / semi[i] ** 2));
  const faces = [];
  for (let i = 0; i < n; i++)
    for (let j = 0; j < m; j++) {
      const [u, v] = [(2 * Math.PI * i) / n, -Math.PI / 2 + (Math.PI * j) / m];
      const [du, dv] = [(2 * Math.PI) / n, Math.PI / m];
      const tone = (Math.floor((4 * i) / n) + (2 * j < m)) % 2;
      const points = [on(u, v), on(u + du, v), on(u + du, v + dv), on(u, v + dv)];
      faces.push({ points, normal: normalAt(on(u + du / 2, v + dv / 2)), tone });
    }
  const ring = (axis) =>
    around(48, (angle) => AXES.map((_, i) => semi[i] * (i === axis ? 0 : i === (axis + 1) % 3 ? Math.cos(angle) : Math.sin(angle))));
  const exit = (d) => {
    const at = 1 / Math.hypot(...d.map((x, i) => x / semi[i]));
    return { at, normal: normalAt(times(at, d)) };
  };
  return { faces, outline: [0, 1, 2].map((axis) => ({ points: ring(axis) })), exit, corner: [0, 0, semi[2]] };
};

const SOLIDS = { brick, cylinder, ellipsoid };

// Returns the solid of a body. The quaternion `turned` turns components along the axes of the solid into components in the body.
const solidOf = ({ kind, semi_axes, turned }) => {
  const solid = SOLIDS[kind](semi_axes);
  const turn = (v) => rotate(turned, v);
  const moved = (face) => ({ ...face, points: face.points.map(turn), normal: face.normal && turn(face.normal) });
  return {
    faces: solid.faces.map(moved),
    outline: solid.outline.map(moved),
    corner: turn(solid.corner),
    exit: (d) => {
      const { at, normal } = solid.exit(rotate(conjugate(turned), d));
      return { at, normal: turn(normal) };
    },
  };
};
