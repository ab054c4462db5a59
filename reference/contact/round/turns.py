"""The rotation of a round body in its phases."""

import numpy as np

from bodycheck.reference.contact.round.ball import Ball, slip
from bodycheck.reference.contact.round.hodograph import Hodograph, elapsed, parameters
from bodycheck.reference.contact.round.phases import Course, Phase
from bodycheck.reference.contact.round.turning import MAX_STEPS, STEP, TERMS, about_axis, accelerated, chained, stepped
from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.exact.numbers import Wide
from bodycheck.reference.kinematics import dot
from bodycheck.reference.witness import WideArray

#: The size of a coefficient beside the first one below which it does not count.
LEAST_TERM = Wide(1e-24)


def turns_between(ball: Ball, course: Course, starts: WideArray) -> WideArray:
    """The rotations (m, 4) until the begin of each of the m phases, along the axes of the plane. starts: (m,) their times."""
    phases = course.phases[:-1]
    lasting = np.diff(starts)
    spins = np.array([phase.start.spin for phase in phases]).reshape(-1, 3)
    turns = about_axis(spins, lasting * np.sqrt(dot(spins, spins)))
    for index, phase in enumerate(phases):
        if phase.slips:
            turns[index] = turned(ball, phase, lasting[index : index + 1])[0]
    return chained(turns)


def turned(ball: Ball, phase: Phase, lasting: WideArray) -> WideArray:
    """The rotations (n, 4) by times (n,) from the start of a phase. Raises `OutOfReach` for too many steps."""
    if phase.hodograph is None:
        return accelerated(phase.start.spin, phase.spin_rate, lasting)
    places = parameters(phase.hodograph, lasting)
    end = places.max(initial=Wide(0))
    begins = _grid(ball, phase, phase.hodograph, end)
    orders = _orders(2 * phase.hodograph.rates[1] * np.diff(begins).max(initial=Wide(0)))  # of a product of two
    return stepped(begins, places, lambda begun: _coefficients(ball, phase, begun, orders))


def _grid(ball: Ball, phase: Phase, slipping: Hodograph, end: Wide) -> WideArray:
    """Steps (m + 1,) from 0 to the end in the parameter of a hodograph: halves until each is short enough for the series."""
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
            raise OutOfReach(f"the attitude of a body that slips takes more than {MAX_STEPS} steps")
        ends = np.insert(ends, long + 1, ends[long] + lengths[long] / 2)


def _orders(exponent: Wide) -> int:
    """Return the number of coefficients of an exponential function that matter for the largest exponent."""
    term, orders = Wide(1), 1
    while term > LEAST_TERM and orders < TERMS:
        term, orders = term * exponent / orders, orders + 1
    return orders


def _coefficients(ball: Ball, phase: Phase, begun: WideArray, orders: int) -> WideArray:
    """The first coefficients (n, orders, 3) of the angular velocity times the rate of time about parameters (n,)."""
    slipping = phase.hodograph
    assert slipping is not None  # the caller has asked
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
