"use strict";
(() => {
  // Vectors are [x, y, z], quaternions [w, x, y, z], body to world; lengths in units of the body's reach.
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
  const AXES = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];

  // The tracks of reports/tracks.py, and what lies between their instants, by the same formulas.
  const SMALL = 1e-2;
  const bytes = (text) => Uint8Array.from(atob(text), (character) => character.charCodeAt(0)).buffer;
  const rows = (text, scale) => {
    const values = new Int16Array(bytes(text));
    return Array.from({ length: values.length / 3 }, (_, k) => AXES.map((_, i) => (values[3 * k + i] / 32767) * scale));
  };
  const derivative = (vector, rate) => {
    const angle = length(vector);
    const factor = angle > SMALL ? (1 - angle / 2 / Math.tan(angle / 2)) / angle ** 2 : 1 / 12 + angle ** 2 / 720;
    const turned = cross(vector, rate);
    return add(add(rate, times(0.5, turned)), times(factor, cross(vector, turned)));
  };
  const rateOf = (vector, change) => {
    const angle = length(vector);
    const first = angle > SMALL ? (1 - Math.cos(angle)) / angle ** 2 : 0.5 - angle ** 2 / 24;
    const second = angle > SMALL ? (angle - Math.sin(angle)) / angle ** 3 : 1 / 6 - angle ** 2 / 120;
    const turned = cross(vector, change);
    return add(minus(change, times(first, turned)), times(second, cross(vector, turned)));
  };
  const readTurning = ({ t, turn, rate, fastest }) => {
    const [instants, rates] = [new Float64Array(bytes(t)), rows(rate, fastest)];
    const knots = rows(turn, Math.PI).map(exp);
    const spans = knots.slice(1).map((next, k) => {
      const h = instants[k + 1] - instants[k];
      const whole = log(multiply(conjugate(knots[k]), next));
      return { h, from: knots[k], whole, start: times(h, rates[k]), stop: times(h, derivative(whole, rates[k + 1])) };
    });
    return { instants, spans };
  };
  const readCourse = ({ t, place, farthest, within }) => ({ instants: new Float64Array(bytes(t)), places: rows(place, farthest), within });
  const spanAt = (instants, t) => {
    let [low, high] = [0, instants.length - 2];
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (instants[middle] <= t) low = middle;
      else high = middle - 1;
    }
    return low;
  };
  const turningAt = ({ instants, spans }, t) => {
    const k = spanAt(instants, t);
    const { h, from, whole, start, stop } = spans[k];
    const s = (t - instants[k]) / h;
    const join = (a, b, c) => add(add(times(a, start), times(b, whole)), times(c, stop));
    const vector = join(s - 2 * s ** 2 + s ** 3, 3 * s ** 2 - 2 * s ** 3, s ** 3 - s ** 2);
    const change = join(1 - 4 * s + 3 * s ** 2, 6 * s - 6 * s ** 2, 3 * s ** 2 - 2 * s);
    return { attitude: multiply(from, exp(vector)), rate: rateOf(vector, times(1 / h, change)) };
  };
  const placeAt = ({ instants, places }, t) => {
    const k = spanAt(instants, t);
    const s = (t - instants[k]) / (instants[k + 1] - instants[k]);
    return add(times(1 - s, places[k]), times(s, places[k + 1]));
  };

  // Convex solids: faces, lines that outline them, and where a ray from the centre comes out.
  const around = (n, at) => Array.from({ length: n }, (_, k) => at((2 * Math.PI * k) / n));
  const SOLIDS = {
    brick: (half) => {
      const faces = [];
      for (const [axis, normal] of AXES.entries())
        for (const sign of [1, -1]) {
          const [u, v] = [AXES[(axis + 1) % 3], AXES[(axis + 2) % 3]];
          const corner = (share) => ([s, r]) => AXES.map((_, i) => half[i] * (sign * normal[i] + share * (s * u[i] + r * v[i])));
          const square = [[1, 1], [-1, 1], [-1, -1], [1, -1]];
          const loop = sign > 0 ? square : [...square].reverse();
          faces.push({ points: loop.map(corner(1)), normal: times(sign, normal), tone: 0, edge: true });
          if (sign > 0 && axis === 2) faces.push({ points: loop.map(corner(0.5)), normal, tone: 1, edge: false });
        }
      const exit = (d) => {
        const shares = half.map((size, i) => size / Math.abs(d[i]));
        const axis = shares.indexOf(Math.min(...shares));
        return { at: shares[axis], normal: times(Math.sign(d[axis]), AXES[axis]) };
      };
      return { faces, outline: faces.filter(({ edge }) => edge), exit, corner: half };
    },
    cylinder: ([radius, , half]) => {
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
    },
    ellipsoid: (semi) => {
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
    },
  };
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

  // A view: where from, what is in its middle, pixels a length, how far the eye is.
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
  const faces = (view, at, normal) => dot(normal, minus(add(view.focus, times(view.distance, view.toward)), at)) > 0;
  const text = ([x, y]) => `${x.toFixed(1)} ${y.toFixed(1)}`;
  const path = (points, closed = false) => (points.length ? `M${points.map(text).join("L")}${closed ? "Z" : ""}` : "");
  const arrow = (from, to) => {
    const [dx, dy] = [to[0] - from[0], to[1] - from[1]];
    const size = Math.hypot(dx, dy);
    const head = Math.min(11, 0.6 * size);
    const [ux, uy] = [dx / (size || 1), dy / (size || 1)];
    const [bx, by] = [to[0] - head * ux, to[1] - head * uy];
    const wing = (side) => [bx - side * 0.45 * head * uy, by + side * 0.45 * head * ux];
    return path([from, [bx, by]]) + path([to, wing(1), wing(-1)], true);
  };

  const SVG = "http://www.w3.org/2000/svg";
  const assign = (element, attributes) => {
    for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
    return element;
  };
  const drawn = (name, attributes, ...children) => {
    const element = assign(document.createElementNS(SVG, name), attributes);
    element.append(...children);
    return element;
  };
  const made = (name, attributes, ...children) => {
    const element = assign(document.createElement(name), attributes);
    element.append(...children);
    return element;
  };
  const line = (parent, kind, attributes = {}) => parent.appendChild(drawn("path", { class: kind, ...attributes }));
  const number = (value, digits = 3) => String(Number(value.toPrecision(digits)));
  const atMost = (value) => (value ? `≤ ${number(value, 2)}` : "0");
  const second = (t, end) => `${t.toFixed(Math.max(0, 3 - Math.ceil(Math.log10(end))))} s`;

  const LIGHT = unit([-0.35, 0.8, 0.5]); // to the right, up and toward the eye
  const shaded = (colour, light, tone) => {
    const level = Math.round(16 * light) / 16;
    const channels = [1, 3, 5].map((k) => parseInt(colour.slice(k, k + 2), 16));
    const toned = channels.map((c) => (tone ? c + 0.6 * (255 - c) : c) * (0.35 + 0.8 * level));
    return `rgb(${toned.map((c) => Math.min(255, Math.round(c))).join(" ")})`;
  };
  const TRUTH = "#8b939d";
  const [FAR, NEAR] = [8, 5]; // half of the widest piece of a plane shown whole, and of one that goes along
  const [AXIS, ARROW] = [0.3, 1.5];
  const [TRAIL, STEPS] = [16, 120]; // rad that the body turns by at its fastest, and how finely they are drawn

  const bodyPicture = (solid, plane) => {
    const svg = drawn("svg", { viewBox: `0 0 ${SIZE} ${SIZE}`, role: "img", class: "drawing scene" });
    const layer = () => svg.appendChild(drawn("g", {}));
    const [ground, behind, skin, before] = [layer(), layer(), layer(), layer()];
    const grid = line(ground, "grid");
    const [whole, other, gone] = [line(ground, "course whole"), line(ground, "course other"), line(ground, "course")];
    const sides = [behind, before].map((parent) => ({
      axes: line(parent, "axes"),
      old: line(parent, "trail old"),
      trail: line(parent, "trail"),
      arrow: line(parent, "momentum"),
    }));
    const [ghost, reference, offset] = [line(before, "ghost"), line(before, "momentum other"), line(before, "offset")];
    const letters = [..."IJK"].map((letter) => before.appendChild(drawn("text", { class: "letter" }, letter)));
    const pool = [];
    const paint = (fills) => {
      let k = 0;
      for (const [key, d] of fills) {
        const [fill, edge] = key.split("|");
        pool[k] ??= line(skin, "");
        assign(pool[k++], { d, fill, class: edge ? "face edge" : "face", stroke: edge ? "" : fill });
      }
      for (; k < pool.length; k++) pool[k].setAttribute("d", "");
    };

    const draw = (view, body, truth, shown) => {
      const centre = plane ? body.place : [0, 0, 0];
      const world = (v) => add(centre, rotate(body.attitude, v));
      const fills = new Map();
      for (const { points, normal, tone, edge } of solid.faces) {
        const outward = rotate(body.attitude, normal);
        if (!faces(view, world(points[0]), outward)) continue;
        const light = 0.5 + 0.5 * dot(LIGHT, [dot(outward, view.right), dot(outward, view.up), dot(outward, view.toward)]);
        const key = `${shaded(shown.colour, light, tone)}|${edge ? "edge" : ""}`;
        fills.set(key, (fills.get(key) ?? "") + path(points.map((p) => project(view, world(p))), true));
      }
      paint(fills);

      // What stands out of the body lies before it where the face that it leaves by is seen, else behind it.
      const parts = sides.map(() => ({ axes: "", old: "", trail: "", arrow: "" }));
      const out = (direction) => {
        const { at, normal } = solid.exit(direction);
        return { at, side: Number(faces(view, world(times(at, direction)), rotate(body.attitude, normal))) };
      };
      for (const [k, axis] of AXES.entries()) {
        const { at, side } = out(axis);
        if (letters[k].parentNode !== [behind, before][side]) [behind, before][side].append(letters[k]);
        parts[side].axes += path([at, at + AXIS].map((far) => project(view, world(times(far, axis)))));
        const [x, y] = project(view, world(times(at + AXIS + 0.13, axis)));
        assign(letters[k], { x: x.toFixed(1), y: (y + 4).toFixed(1), visibility: view.scale > 40 ? "visible" : "hidden" });
      }
      const tips = shown.trail.map((tip) => project(view, add(centre, tip)));
      shown.trail.forEach((tip, k) => {
        if (k) parts[Number(dot(tip, view.toward) > 0)][2 * k < tips.length ? "old" : "trail"] += path([tips[k - 1], tips[k]]);
      });
      const momentum = times(ARROW, body.momentum);
      const size = length(momentum);
      if (size > 0) {
        const { at, side } = out(rotate(conjugate(body.attitude), times(1 / size, momentum)));
        if (size > at) {
          const from = project(view, add(centre, times(at / size, momentum)));
          parts[side].arrow = arrow(from, project(view, add(centre, momentum)));
        }
      }
      sides.forEach((side, k) => Object.entries(parts[k]).forEach(([name, d]) => side[name].setAttribute("d", d)));

      let [outline, apart, pointer] = ["", "", ""];
      if (truth) {
        const seat = plane ? truth.place : centre;
        const there = (v) => add(seat, rotate(truth.attitude, v));
        if (shown.apart || (plane && length(minus(body.place, truth.place)) > 0.01))
          for (const { points, normal } of solid.outline)
            if (!normal || faces(view, there(points[0]), rotate(truth.attitude, normal)))
              outline += path(points.map((p) => project(view, there(p))), true);
        const fixed = times(ARROW, truth.momentum);
        if (length(minus(momentum, fixed)) > 0.01) apart = path([project(view, seat), project(view, add(seat, fixed))]);
        if (!plane && length(body.place) > 0.01) pointer = marker(project({ ...view, distance: 1e9 }, times(-1, body.place)));
      }
      assign(ghost, { d: outline });
      assign(reference, { d: apart });
      assign(offset, { d: pointer });
      if (plane) {
        assign(grid, { d: shown.grid });
        assign(whole, { d: shown.course });
        assign(gone, { d: path(shown.gone.map((p) => project(view, flat(p)))) });
        assign(other, { d: shown.other });
      }
      Object.assign(svg.dataset, {
        quaternion: body.attitude.join(","),
        corner: project(view, world(solid.corner)).join(","),
        momentum: body.momentum.join(","),
        place: body.place.join(","),
      });
    };
    return { svg, draw };
  };
  const flat = ([x, y]) => [x, y, 0];
  // The truth's centre: a cross, or where it is farther a tip at the rim that points to it.
  const marker = ([x, y]) => {
    if (Math.hypot(x - MIDDLE, y - MIDDLE) < 108)
      return [[[x - 4, y - 4], [x + 4, y + 4]], [[x + 4, y - 4], [x - 4, y + 4]], [[MIDDLE, MIDDLE], [x, y]]].map((ends) => path(ends)).join("");
    const angle = Math.atan2(y - MIDDLE, x - MIDDLE);
    return path([[104, 0.06], [114, 0], [104, -0.06]].map(([r, a]) => [MIDDLE + r * Math.cos(angle + a), MIDDLE + r * Math.sin(angle + a)]));
  };

  // The polhodes: the angular momentum along the axes of the body, on the sphere of the size that the truth's begins with.
  const polhodePicture = (data, momentumOf) => {
    const svg = drawn("svg", { viewBox: `0 0 ${SIZE} ${SIZE}`, role: "img", class: "drawing scene", "aria-label": "Polhodes: the angular momentum along the axes of the body" });
    const way = ({ instants, spans }) =>
      spans.flatMap(({ h }, k) =>
        Array.from({ length: 9 }, (_, part) => momentumOf(turningAt({ instants, spans }, instants[k] + (h * part) / 8).rate)),
      );
    // Seen from where the truth's polhode is widest open, and begins on the near side.
    const truth = way(data.truth.turning);
    const area = truth.reduce((sum, p, k) => (k ? add(sum, cross(truth[k - 1], p)) : sum), [0, 0, 0]);
    const corners = [[1, 0.75, 0.7], [-1, 0.75, 0.7], [1, -0.75, 0.7], [-1, -0.75, 0.7]].map(unit);
    const open = corners.reduce((best, corner) => (Math.abs(dot(area, corner)) > Math.abs(dot(area, best)) + 1e-6 ? corner : best));
    const toward = times(dot(truth[0], open) < 0 ? -1 : 1, open);
    const right = unit(cross([0, 0, 1], toward));
    const view = { right, up: cross(toward, right), toward, focus: [0, 0, 0], scale: 88, distance: 1e6 };
    const halves = (points) => {
      const d = ["", ""];
      points.forEach((p, k) => k && (d[Number(dot(p, toward) > 0)] += path([project(view, points[k - 1]), project(view, p)])));
      return d;
    };
    svg.append(drawn("circle", { class: "ball", cx: MIDDLE, cy: MIDDLE, r: view.scale }));
    const curve = (points, kind, attributes) =>
      halves(points).forEach((d, front) => line(svg, `${kind}${front ? "" : " back"}`, { d, ...attributes }));
    const { moments, axes } = data.body;
    const [low, middle, high] = [0, 1, 2].sort((i, j) => moments[i] - moments[j]);
    const [near, far] = [1 / moments[low] - 1 / moments[middle], 1 / moments[middle] - 1 / moments[high]];
    const split = Math.min(near, far) * moments[middle] > 0.01;
    if (split)
      for (const side of [1, -1]) {
        const other = unit(add(times(side * Math.sqrt(far), AXES[low]), times(Math.sqrt(near), AXES[high])));
        const points = around(120, (angle) => rotate(axes, add(times(Math.cos(angle), AXES[middle]), times(Math.sin(angle), other))));
        curve([...points, points[0]], "separatrix", {});
      }
    AXES.forEach((axis, k) => {
      const shown = dot(axis, toward) > 0;
      line(svg, `axes${shown ? "" : " back"}`, { d: path([axis, times(1.18, axis)].map((p) => project(view, p))) });
      const [x, y] = project(view, times(1.27, axis));
      svg.append(drawn("text", { class: "letter", x, y: y + 4, "fill-opacity": shown ? 1 : 0.45 }, "IJK"[k]));
    });
    const curves = svg.appendChild(drawn("g", {}));
    const dots = svg.appendChild(drawn("g", {}));
    const choose = (bodies) => {
      curves.replaceChildren();
      dots.replaceChildren();
      for (const { turning, colour, like } of bodies) {
        if (!like)
          halves(way(turning)).forEach((d, front) =>
            line(curves, `polhode${colour === TRUTH ? " truth" : ""}${front ? "" : " back"}`, { d, stroke: colour }),
          );
        dots.append(drawn("circle", { class: "dot", fill: colour, r: colour === TRUTH ? 6 : 4.5 }));
      }
    };
    const draw = (momenta) => {
      momenta.forEach((momentum, k) => {
        const [x, y] = project(view, momentum);
        assign(dots.children[k], { cx: x.toFixed(1), cy: y.toFixed(1), "fill-opacity": dot(momentum, toward) > 0 ? 1 : 0.35 });
      });
      svg.dataset.truth = momenta[0].join(",");
    };
    return { svg, choose, draw, split };
  };

  // The least of 1, 2, 5, 10, ... that is not below a value.
  const nice = (value) => {
    const power = Math.floor(Math.log10(value) + 1e-9);
    return Number(`${[1, 2, 5, 10].find((digit) => digit * 10 ** power >= value * (1 - 1e-9))}e${power}`);
  };
  const FRAME = 1 / 60;
  const ICONS = { play: "M3 1.5 13 8 3 14.5z", pause: "M3 2h3.5v12H3zM9.5 2H13v12H9.5z" };
  const others = new Set();

  const build = (figure) => {
    const data = JSON.parse(document.getElementById(figure.dataset.player).textContent);
    const solid = solidOf(data.body);
    const { reach, moments, axes } = data.body;
    const read = (run) => ({ ...run, turning: run.turning && readTurning(run.turning), course: run.course && readCourse(run.course) });
    data.truth = { ...read(data.truth), label: "the truth", colour: TRUTH };
    data.runs = data.runs.map(read).map((run) => ({ ...run, like: !run.turning, turning: run.turning ?? data.truth.turning }));
    const size = data.momentum || Infinity;
    const ties = 2.5 * data.within; // rad: bodies that are nearer, each drawn within so much, cannot be told apart
    const momentumOf = (rate) => {
      const along = rotate(conjugate(axes), rate);
      return times(1 / size, rotate(axes, along.map((x, i) => x * moments[i])));
    };
    const stateOf = (body, t) => {
      const { attitude, rate } = turningAt(body.turning, t);
      const inBody = momentumOf(rate);
      return { attitude, rate, inBody, momentum: rotate(attitude, inBody), place: body.course ? placeAt(body.course, t) : [0, 0, 0] };
    };
    const fastest = Math.max(...[data.truth, ...data.runs].map(({ turning }) => Math.max(...turning.spans.map(({ start, h }) => length(start) / h))));
    const long = data.plane || !fastest ? 0 : Math.min(data.end, TRAIL / fastest);
    const tip = times(solid.exit(AXES[2]).at + AXIS, AXES[2]);

    const shown = data.shown.map((k) => data.runs[k]);
    let [now, playing, before, azimuth, elevation] = [0, false, 0, -1, data.plane ? 0.75 : 0.4];
    const start = stateOf(data.truth, 0).momentum;
    if (data.plane) {
      const [from, to] = [placeAt(data.truth.course, 0), placeAt(data.truth.course, data.end)];
      azimuth = Math.atan2(to[1] - from[1], to[0] - from[0]) - Math.PI / 2 + 0.4;
    } else if (Math.hypot(start[0], start[1]) > 0.35 * length(start)) azimuth = Math.atan2(start[1], start[0]) - 1.1;

    const panels = [data.truth, ...shown].map((body, k) => {
      const { svg, draw } = bodyPicture(solid, data.plane);
      const told = made("p", { class: "told" });
      const swatch = made("i", { class: "swatch" });
      const head = made("div", { class: "head" }, swatch);
      if (k) {
        const select = made("select", { "aria-label": `Body ${k + 1} of ${shown.length + 1}` });
        data.runs.forEach((run, place) => select.append(made("option", { value: place }, run.label)));
        select.value = data.runs.indexOf(body);
        select.addEventListener("change", () => {
          shown[k - 1] = data.runs[select.value];
          choose();
        });
        head.append(select);
      } else head.append(made("span", {}, body.label));
      return { element: made("div", { class: "panel" }, head, svg, told), svg, draw, told, swatch };
    });
    const polhode = !data.plane && data.momentum ? polhodePicture(data, momentumOf) : null;
    const slider = made("input", { type: "range", min: 0, max: data.end, step: "any", value: 0, "aria-label": "Time" });
    const clock = made("span", { class: "clock" });
    const icon = drawn("path", { d: ICONS.play });
    const word = made("span", {}, "Play");
    const button = made("button", { type: "button" }, drawn("svg", { viewBox: "0 0 16 16", "aria-hidden": "true" }, icon), word);
    const speed = made("select", { "aria-label": "Speed" });
    const side = made("input", { type: "range", min: -180, max: 180, step: 5, "aria-label": "Seen from" });
    const status = made("p", { class: "unseen", role: "status" });
    const warning = made("p", { class: "note", hidden: "" });
    const rates = [];
    for (let rate = nice(data.end / 2000); rate <= data.end; rate = nice(1.5 * rate)) rates.push(rate);
    const steady = rates.filter((rate) => rate <= 1 && fastest * rate * FRAME < 0.3);
    speed.append(...rates.map((rate) => made("option", { value: rate }, rate === 1 ? "real time" : `${number(rate)} × real time`)));
    speed.value = steady.filter((rate) => data.end / rate >= 6).pop() ?? steady[0] ?? rates[0];
    const stage = made("div", { class: "stage" }, ...panels.map(({ element }) => element));
    if (polhode) stage.append(made("div", { class: "panel wide" }, made("div", { class: "head" }, "Polhodes"), polhode.svg, made("p", { class: "told" }, "angular momentum\nin the body")));
    const controls = made("div", { class: "controls", role: "group", "aria-label": "Playback" }, button, slider, clock, speed, made("label", { class: "side" }, "seen from ", side));
    const key = made("p", { class: "note key" });
    const squares = made("span", {});
    const explain = (kind, d, ...words) =>
      key.append(made("span", {}, drawn("svg", { viewBox: "0 0 26 12", class: "drawing sign", "aria-hidden": "true" }, drawn("path", { class: kind, d })), made("span", {}, ...words)));
    if (data.momentum) explain("momentum", arrow([1, 6], [25, 6]), "angular momentum, its direction in space (dotted: the truth’s)");
    if (long) explain("trail", "M1 6H25", `where the tip of K has been, for ${number(long, 2)} s`);
    explain("ghost", "M3 2H23V10H3Z", "the truth’s body");
    if (!data.plane) explain("offset", "M9 2 17 10M17 2 9 10", "the truth’s centre of mass; at the rim, if farther away: each body is drawn about its own");
    else explain("course", "M1 6H25", "where the centre of mass has been; ", squares);
    if (polhode) explain("polhode truth", "M1 6H25", `the truth’s polhode${polhode.split ? "; broken lines: the separatrices" : ""}`);
    key.append(made("span", {}, `Drawn within ${data.within} rad of the samples; a method that is nearer to the truth is drawn as the truth.`));
    figure.prepend(stage, controls, warning, key, status);

    let view = null;
    let [still, far, step] = [null, false, 1];
    const look = () => {
      view = viewFrom(azimuth, elevation);
      side.value = Math.round((Math.atan2(Math.sin(azimuth), Math.cos(azimuth)) * 180) / Math.PI);
      side.setAttribute("aria-valuetext", `${side.value}° about the vertical`);
      still = data.plane ? frame() : { view };
    };
    // On the plane all pictures show the same piece of it, in which all bodies stay, unless they would be too small there.
    const frame = () => {
      const points = [data.truth, ...shown].flatMap((body) => body.course.places);
      const [[left, right], [low, high]] = [view.right, view.up].map((axis) => {
        const along = points.map((p) => dot(p, axis));
        return [Math.min(...along) - 1.02, Math.max(...along) + 1.02];
      });
      const half = Math.max(right - left, high - low) / 2;
      const middle = add(times((left + right) / 2, view.right), times((low + high) / 2, view.up));
      view.focus = add(middle, times(-middle[2] / view.toward[2], view.toward)); // on the ground
      far = half > FAR;
      const extent = far ? NEAR : half;
      Object.assign(view, { scale: 114 / extent, distance: 9 * extent });
      step = nice((extent * reach) / 6) / reach;
      squares.textContent = `${far ? "each picture goes with its body" : "all on the same piece of the plane"}, in squares of ${number(step * reach)} m`;
      return ground(view);
    };
    const ground = (view) => {
      const courses = [data.truth, ...shown].map((body) => path(body.course.places.map((p) => project(view, flat(p)))));
      const [x, y] = view.focus.map((at) => Math.round(at / step) * step);
      const lines = Array.from({ length: 21 }, (_, k) => [(k - 10) * step, 10 * step]);
      const ends = lines.flatMap(([d, e]) => [[[x + d, y - e, 0], [x + d, y + e, 0]], [[x - e, y + d, 0], [x + e, y + d, 0]]]);
      return { view, courses, grid: ends.map((line) => path(line.map((p) => project(view, p)))).join("") };
    };
    const off = (body, state, truth) => {
      const angle = angleBetween(state.attitude, truth.attitude);
      const turned = body.like ? atMost(body.attitude_error) : angle < ties ? `< ${ties}` : number(angle);
      const shift = length(data.plane ? minus(state.place, truth.place) : state.place) * reach;
      const unsure = body.course ? 2 * body.course.within * reach : Infinity;
      const gone = shift > 3 * unsure ? number(shift, 2) : atMost(Math.min(body.position_error, shift + unsure));
      return { angle, told: `off by ${turned} rad\nand ${gone} m` };
    };
    const draw = () => {
      const bodies = [data.truth, ...shown];
      const states = bodies.map((body) => stateOf(body, now));
      panels.forEach(({ svg, draw, told }, k) => {
        const { angle, told: words } = k ? off(bodies[k], states[k], states[0]) : { angle: 0, told: `turning at\n${number(length(states[0].rate))} rad/s` };
        const trail = Array.from({ length: long ? STEPS + 1 : 0 }, (_, i) => now - long * (1 - i / STEPS))
          .filter((t) => t >= 0)
          .map((t) => rotate(turningAt(bodies[k].turning, t).attitude, tip));
        const gone = data.plane ? Array.from({ length: 41 }, (_, i) => placeAt(bodies[k].course, (now * i) / 40)) : [];
        const { view: own, grid, courses } = far ? ground({ ...view, focus: flat(states[k].place) }) : still;
        const { colour } = bodies[k];
        draw(own, states[k], k ? states[0] : null, { colour, apart: angle > ties, trail, grid, course: courses?.[k], other: k ? courses?.[0] : "", gone });
        told.textContent = words;
        Object.assign(svg.dataset, { time: now, view: JSON.stringify(own) });
      });
      polhode?.draw(states.map(({ inBody }) => inBody));
      slider.value = now;
      clock.textContent = second(now, data.end);
      slider.setAttribute("aria-valuetext", `${second(now, data.end)} of ${second(data.end, data.end)}`);
      if (!playing) settle();
    };
    // What is said of it, once it stands still.
    let pending = 0;
    const settle = () => {
      clearTimeout(pending);
      pending = setTimeout(say, 500);
    };
    const say = () => {
      const axis = rotate(panels[0].svg.dataset.quaternion.split(",").map(Number), AXES[2]).map((x) => number(x, 2));
      const sayings = panels.map(({ told }, k) => `${k ? shown[k - 1].label : `the truth, its axis K along (${axis.join(", ")})`}: ${told.textContent}`);
      panels.forEach(({ svg }, k) => svg.setAttribute("aria-label", `At ${clock.textContent}, ${sayings[k]}`));
      if (status.textContent || document.activeElement?.closest(".player") === figure) status.textContent = `At ${clock.textContent}: ${sayings.join("; ")}.`;
    };
    const choose = () => {
      panels.forEach(({ swatch, svg }, k) => {
        const { colour, label } = k ? shown[k - 1] : data.truth;
        swatch.style.background = colour;
        svg.dataset.body = label;
      });
      polhode?.choose([data.truth, ...shown]);
      look();
      draw();
    };

    const move = (t) => {
      now = Math.min(data.end, Math.max(0, t));
      draw();
    };
    const warn = () => {
      const turn = fastest * speed.value * FRAME;
      warning.hidden = turn < 1;
      warning.textContent = `At this speed the body turns by up to ${number(turn, 2)} rad from one picture to the next, more than eyes can follow.`;
    };
    const tick = (stamp) => {
      if (!playing) return;
      const gone = Math.min(0.5, (stamp - before) / 1000) * speed.value; // a page that was not seen goes on where it was
      before = stamp;
      move(now + gone > data.end ? 0 : now + gone);
      requestAnimationFrame(tick);
    };
    const play = (wanted) => {
      playing = wanted;
      icon.setAttribute("d", playing ? ICONS.pause : ICONS.play);
      word.textContent = playing ? "Pause" : "Play";
      if (!playing) return draw();
      others.forEach((pause) => pause !== stop && pause());
      before = performance.now();
      requestAnimationFrame(tick);
    };
    const stop = () => playing && play(false);
    others.add(stop);
    button.addEventListener("click", () => play(!playing));
    slider.addEventListener("input", () => move(Number(slider.value)));
    slider.addEventListener("keydown", (event) => {
      const step = data.end / 200;
      const steps = { ArrowRight: step, ArrowUp: step, ArrowLeft: -step, ArrowDown: -step, PageUp: 10 * step, PageDown: -10 * step };
      if (event.key === " ") play(!playing);
      else if (event.key in steps) move(now + steps[event.key]);
      else return;
      event.preventDefault();
    });
    speed.addEventListener("change", warn);
    side.addEventListener("input", () => turn((side.value * Math.PI) / 180, elevation));
    const turn = (about, above) => {
      [azimuth, elevation] = [about, Math.min(1.4, Math.max(data.plane ? 0.2 : -1.4, above))];
      look();
      draw();
    };
    panels.forEach(({ svg }) =>
      svg.addEventListener("pointermove", (event) => {
        if (event.buttons & 1) turn(azimuth - event.movementX / 100, elevation + event.movementY / 100);
      }),
    );
    new IntersectionObserver(([{ isIntersecting }]) => isIntersecting || stop()).observe(figure);

    // It opens where the runs shown are farthest from the truth.
    const apart = (t) => {
      const truth = stateOf(data.truth, t);
      return Math.max(0, ...shown.map((body) => {
        const state = stateOf(body, t);
        return (body.like ? 0 : angleBetween(state.attitude, truth.attitude)) + (data.plane ? length(minus(state.place, truth.place)) : 0);
      }));
    };
    const instants = Array.from({ length: 201 }, (_, k) => (data.end * k) / 200);
    const worst = instants.reduce((best, t) => (apart(t) > apart(best) + 1e-6 ? t : best), 0);
    if (apart(worst) > 4 * ties) now = worst;
    choose();
    warn();
  };

  // A player is made when it comes near the window: a page of many cases opens at once.
  const ready = (figure) => {
    if (!figure.dataset.ready) build(figure);
    figure.dataset.ready = "yes";
  };
  const figures = [...document.querySelectorAll(".player")];
  const observer = new IntersectionObserver(
    (entries) => {
      for (const { isIntersecting, target } of entries) {
        if (!isIntersecting) continue;
        observer.unobserve(target);
        ready(target);
      }
    },
    { rootMargin: "600px 0px" },
  );
  figures.forEach((figure) => observer.observe(figure));
  window.addEventListener("beforeprint", () => figures.forEach(ready));
})();
