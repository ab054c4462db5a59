"""The rotation of a round body in its phases, from its angular velocity along axes that do not turn.

With the angular velocity w along fixed axes the quaternion obeys dQ/dt = w Q / 2. A power series of w in a parameter gives a
power series of Q. As the equation is linear, the rotations of all steps are computed at once, and multiplied one after another.
"""

from collections.abc import Callable

import numpy as np

from bodycheck.reference.contact.round.ball import Ball, slip
from bodycheck.reference.contact.round.hodograph import Hodograph, elapsed, parameters
from bodycheck.reference.contact.round.phases import Course, Phase
from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.exact.numbers import Wide
from bodycheck.reference.kinematics import about, cross, dot, multiply, normalise
from bodycheck.reference.witness import WideArray

#: A function from parameters (k,) to the coefficients (k, j, 3) of the series of the angular velocity about them, times the
#: rate of time.
Coefficients = Callable[[WideArray], WideArray]

#: The largest angle (rad) of a step, which includes a growth of the angular velocity within it.
STEP = 4.0

#: The number of terms of the series. If a is the part of the angle of a step from the angular velocity at its start, and the
#: growth adds the rest, the series of exp(a x/2 + (STEP - a) x^2/4) bounds the series of Q; its omitted terms are below 1e-21.
TERMS = 46

#: The largest number of steps; these take some seconds.
MAX_STEPS = 100_000

#: The number of steps that are computed at once, which limits the memory.
CHUNK = 8192

#: The size of a coefficient, relative to the first coefficient, below which it does not count.
LEAST_TERM = Wide(1e-24)


def about_axis(spin: WideArray, angle: WideArray) -> WideArray:
    """The quaternions (n, 4) of rotations by angles (n,), rad, about the direction of vectors (n, 3) or (3,)."""
    size = np.sqrt(dot(spin, spin))
    axis = spin / np.where(size > 0, size, 1)[..., None]
    return about(axis, angle)


def series(rates: WideArray, lengths: WideArray) -> WideArray:
    """The rotations (n, 4) in each of n steps.

    Parameters
    ----------
    rates
        (n, j, 3) the first j coefficients of the power series of the angular velocity in the parameter, times the rate of time.
    lengths
        (n,) lengths of the steps in the parameter.
    """
    count = len(lengths)
    count_of_rates = min(rates.shape[1], TERMS)
    scaled = np.zeros((count, count_of_rates, 4), Wide)
    power = lengths.copy()
    for order in range(count_of_rates):
        scaled[:, order, 1:] = rates[:, order] * power[:, None] / 2
        power = power * lengths
    terms = np.zeros((TERMS, count, 4), Wide)
    terms[0, :, 0] = 1
    for order in range(TERMS - 1):
        for back in range(min(order + 1, count_of_rates)):
            terms[order + 1] += multiply(scaled[:, back], terms[order - back])
        terms[order + 1] /= order + 1
    return normalise(terms[::-1].sum(axis=0))


def chained(turns: WideArray) -> WideArray:
    """The n + 1 products (n + 1, 4) of the first 0, 1, ... n of n successive rotations (n, 4), given along fixed axes."""
    chain = np.concatenate([np.array([[1, 0, 0, 0]], Wide), turns])
    reach = 1
    while reach < len(chain):
        chain[reach:] = multiply(chain[reach:], chain[:-reach])
        reach *= 2
    return normalise(chain)


def accelerated(spin: WideArray, rate: WideArray, times: WideArray) -> WideArray:
    """The rotations (n, 4) within times (n,) >= 0 (s), with the angular velocity spin + rate t, vectors (3,).

    Raises `OutOfReach` if the axis turns and there are too many steps.
    """
    if not np.any(cross(spin, rate)):
        axis = spin if np.any(spin) else rate
        size = np.sqrt(dot(axis, axis))
        if not size:
            return about_axis(axis, np.zeros_like(times))
        along = axis / size
        return about_axis(along, times * (dot(spin, along) + times / 2 * dot(rate, along)))
    end = times.max(initial=Wide(0))
    growth = np.sqrt(dot(rate, rate))
    fastest = np.sqrt(dot(spin, spin)) + growth * end
    begins = grid(end, fastest / Wide(STEP))

    def coefficients(begun: WideArray) -> WideArray:
        return np.stack([spin + rate * begun[:, None], np.broadcast_to(rate, (len(begun), 3))], axis=1)

    return stepped(begins, times, coefficients)


def grid(end: Wide, density: Wide) -> WideArray:
    """The ends (m + 1,) of equal steps from 0 to `end`, at least `density` steps per unit. Raises `OutOfReach` for too many."""
    count = np.ceil(end * density)
    if count > MAX_STEPS:
        raise OutOfReach(f"the rotation of a body whose axis turns needs {float(count):.3g} steps; allowed: {MAX_STEPS}")
    return np.linspace(Wide(0), end, int(count) + 1, dtype=Wide)


def stepped(begins: WideArray, places: WideArray, coefficients: Coefficients) -> WideArray:
    """The rotations (n, 4) from 0 to places (n,) of the parameter, by steps between ascending `begins` (m + 1,) from 0 on.

    coefficients: function from parameters (k,) to the rates for `series` about them.
    """
    lengths = np.diff(begins)
    parts = range(0, len(lengths), CHUNK)
    steps = [series(coefficients(begins[:-1][k : k + CHUNK]), lengths[k : k + CHUNK]) for k in parts]
    whole = chained(np.concatenate([np.zeros((0, 4), Wide), *steps]))
    at = np.clip(np.searchsorted(begins, places, side="right") - 1, 0, max(len(begins) - 2, 0))
    return multiply(series(coefficients(begins[at]), places - begins[at]), whole[at])


def turns_between(ball: Ball, course: Course, starts: WideArray) -> WideArray:
    """The rotations (m, 4) until the starts of the m phases, along the axes of the plane. starts: (m,) times of the starts."""
    phases = course.phases[:-1]
    lasting = np.diff(starts)
    spins = np.array([phase.start.spin for phase in phases]).reshape(-1, 3)
    turns = about_axis(spins, lasting * np.sqrt(dot(spins, spins)))
    for index, phase in enumerate(phases):
        if phase.slips:
            turns[index] = turned(ball, phase, lasting[index : index + 1])[0]
    return chained(turns)


def turned(ball: Ball, phase: Phase, lasting: WideArray) -> WideArray:
    """The rotations (n, 4), quaternions w, x, y, z, within times (n,), s, from the start of a phase.

    Raises `OutOfReach` if they need too many steps.
    """
    if phase.hodograph is None:
        return accelerated(phase.start.spin, phase.spin_rate, lasting)
    places = parameters(phase.hodograph, lasting)
    end = places.max(initial=Wide(0))
    begins = _grid(ball, phase, phase.hodograph, end)
    orders = _orders(2 * phase.hodograph.rates[1] * np.diff(begins).max(initial=Wide(0)))  # for the product of two exponentials
    return stepped(begins, places, lambda begun: _coefficients(ball, phase, begun, orders))


def _grid(ball: Ball, phase: Phase, slipping: Hodograph, end: Wide) -> WideArray:
    """The ends (m + 1,) of steps from 0 to `end` in the parameter of a hodograph, halved until the series holds in each."""
    less, more = slipping.rates

    def pace(q: WideArray) -> WideArray:
        return np.asarray(slipping.along * np.exp(-less * q) + slipping.against * np.exp(-more * q))

    ends = np.array([Wide(0), end])
    lasting = elapsed(slipping, ends)[1]
    gained = (slipping.downhill * lasting + pace(ends).sum()) / (ball.radius * (1 + ball.ratio))
    fastest = np.sqrt(dot(phase.start.spin, phase.start.spin)) + gained
    while True:
        lengths = np.diff(ends)
        sizes = lengths * (more + fastest / Wide(STEP) * np.maximum(pace(ends[:-1]), pace(ends[1:])))
        long = np.flatnonzero(sizes > 1)
        if not len(long):
            return ends
        if len(ends) + len(long) > MAX_STEPS:
            raise OutOfReach(f"the rotation of a body that slips needs more than {MAX_STEPS} steps")
        ends = np.insert(ends, long + 1, ends[long] + lengths[long] / 2)


def _orders(exponent: Wide) -> int:
    """Return the number of series coefficients of an exponential function that count for exponents up to `exponent`."""
    term, orders = Wide(1), 1
    while term > LEAST_TERM and orders < TERMS:
        term, orders = term * exponent / orders, orders + 1
    return orders


def _coefficients(ball: Ball, phase: Phase, begun: WideArray, orders: int) -> WideArray:
    """The first coefficients (n, orders, 3) of the angular velocity times the rate of time about parameters (n,)."""
    slipping = phase.hodograph
    assert slipping is not None  # the caller has checked this
    less, more = slipping.rates
    shape = len(begun), orders
    along, against, across = np.zeros(shape, Wide), np.zeros(shape, Wide), np.zeros(shape, Wide)
    along[:, 0], against[:, 0] = slipping.along * np.exp(-less * begun), slipping.against * np.exp(-more * begun)
    across[:, 0] = slipping.across * np.exp(-slipping.slowing * begun)
    for n in range(1, orders):
        along[:, n] = along[:, n - 1] * -less / n
        against[:, n] = against[:, n - 1] * -more / n
        across[:, n] = across[:, n - 1] * -slipping.slowing / n
    pace = along + against
    time = np.zeros(shape, Wide)
    time[:, 0] = elapsed(slipping, begun)
    time[:, 1:] = pace[:, :-1] / np.arange(1, orders)
    first = slip(ball, phase.start.velocity, phase.start.spin)
    change = np.zeros((*shape, 3), Wide)
    scale = ball.radius * (1 + ball.ratio)
    change[..., 0] = across / scale
    change[..., 1] = (slipping.downhill * time - (along - against)) / scale
    change[:, 0] += phase.start.spin + np.array([-first[1], first[0], Wide(0)]) / scale
    coefficients = np.zeros_like(change)
    for n in range(orders):
        for back in range(n + 1):
            coefficients[:, n] += pace[:, back, None] * change[:, n - back]
    return coefficients
