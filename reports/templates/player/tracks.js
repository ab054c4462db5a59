// Reads the motions that reports/runs/motions/tracks.py stores, and interpolates between their instants by the same formulas.
// Uses vectors.js.

// The angle (rad) below which a series replaces a quotient of two small numbers.
const SMALL = 1e-2;

const bytes = (text) => Uint8Array.from(atob(text), (character) => character.charCodeAt(0)).buffer;
const rows = (text, scale) => {
  const values = new Int16Array(bytes(text));
  return Array.from({ length: values.length / 3 }, (_, k) => AXES.map((_, i) => (values[3 * k + i] / 32767) * scale));
};

// The derivative of a rotation vector for a given body rate, and its inverse: the body rate for a given derivative.
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

// Returns the index of the span between two instants that contains a time, by bisection.
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
