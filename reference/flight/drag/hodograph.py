"""Translation with quadratic drag along a curved path: quadratures over the slope of the path.

The quantities are without dimension, as in `straight`. With the horizontal speed u and the slope sinh(sigma) of the path, the
speed is w = u cosh(sigma), and

    d sigma / dt = -1/w,     1/u^2 = 1/u0^2 + F(sigma0) - F(sigma),     F(sigma) = sinh(sigma) cosh(sigma) + sigma.

With delta = sigma0 - sigma >= 0 and the sine s and the cosine c of the elevation of the initial velocity w0, which are
tanh(sigma0) and 1 / cosh(sigma0), this is written without cancellation or large numbers:

    N = cosh(sigma) / cosh(sigma0) = exp(-delta) + (1 - s) sinh(delta),
    D = 1/w0^2 + c^2 delta + sinh(delta) ((1 + s^2) exp(-delta) + (1 - s)^2 sinh(delta)),
    w = N / sqrt(D),   u = c / sqrt(D),   upward velocity (s exp(-delta) - (1 - s) sinh(delta)) / sqrt(D),
    length of the path ln(D w0^2) / 2.

Time, distance and height are the integrals of w, w u and w times the upward velocity over delta. Near a fast start, D is
1/w0^2 + 2 delta, which varies over a delta of 1/w0^2. There the variable of integration is y with
delta = (exp(2 y) - 1) / (2 w0^2), which is about the length of the path; further on it is delta itself up to a constant.
"""

from dataclasses import dataclass

import numpy as np

from bodycheck.reference.exact.numbers import Wide
from bodycheck.reference.flight.drag.antiderivative import integrals, invert, panels, places
from bodycheck.reference.flight.drag.straight import continued
from bodycheck.reference.flight.elliptic import WideArray

#: The value of delta up to which y is the variable of integration.
START_DELTA = Wide(0.5)

#: Length of a panel in y and in delta. The nearest singularities of the integrands are about 0.5 away from a panel's edge (at
#: complex values of delta where D is zero), more than two panel lengths from the middle of the panel.
PANEL_LENGTH = Wide(0.25)

#: The motion has relaxed where 4 (1/u0^2 + F(sigma0) + |sigma|) exp(-2 |sigma|), which is |w^2 - 1|, is below exp(-50) = 2e-22.
RELAXED_EXPONENT = 25


@dataclass(frozen=True, eq=False)
class Start:
    """The initial velocity, dimensionless.

    Attributes
    ----------
    speed
        Its size w0.
    sine, cosine
        Sine and cosine of its elevation.
    deficit
        1 - sine, to all digits.
    """

    speed: Wide
    sine: Wide
    cosine: Wide
    deficit: Wide


def curved(along: Wide, climb: Wide, times: WideArray) -> WideArray:
    """The course (5, n), as in `straight`, at times (n,) >= 0.

    along, climb: horizontal speed and upward velocity at the start. The accuracy is that of the wide type for speeds up to 1e11
    and a horizontal speed of at least 1e-11 times the larger of 1 and the speed.
    """
    speed = np.hypot(along, climb)
    sine, cosine = climb / speed, along / speed
    start = Start(speed, sine, cosine, cosine**2 / (1 + sine) if sine > 0 else 1 - sine)
    turn = np.log1p(2 * START_DELTA * speed**2) / 2
    edges = _edges(start, turn)
    y = places(edges)
    u, climbing, w, _, stretch = _state(start, turn, y)
    antiderivatives = panels(edges, w * stretch * np.stack([np.ones_like(u), u, climbing]))

    end_time = antiderivatives.sums[0, -1]
    u, _, _, path, _ = _state(start, turn, edges[-1:])
    end = np.stack([antiderivatives.sums[1, -1:], antiderivatives.sums[2, -1:], path, u, -np.ones_like(u)])
    relaxed = _relaxed(u, np.maximum(times - end_time, 0))
    course = continued(relaxed, end, relaxed, times > end_time)

    bending = times <= end_time
    panel, r = invert(antiderivatives, times[bending])
    _, distance, height = integrals(antiderivatives, panel, r)
    u, climbing, _, path, _ = _state(start, turn, edges[panel] + np.diff(edges)[panel] * r)
    course[:, bending] = np.stack([distance, height, path, u, climbing])
    return course


def _edges(start: Start, turn: Wide) -> WideArray:
    """Edges of panels from the start until the motion has relaxed to the terminal velocity."""
    first = np.arcsinh(start.sine / start.cosine)
    size = 1 / (start.cosine * start.speed) ** 2 + 1 / start.cosine**2 + abs(first) + 100
    last = first + RELAXED_EXPONENT + np.log(4 * size) / 2
    fast, slow = (int(np.ceil(length / PANEL_LENGTH)) for length in (turn, last - START_DELTA))
    return np.append(np.linspace(Wide(0), turn, fast + 1), turn + PANEL_LENGTH * np.arange(1, slow + 1))


def _state(start: Start, turn: Wide, y: WideArray) -> tuple[WideArray, WideArray, WideArray, WideArray, WideArray]:
    """Horizontal speed, upward velocity, speed, path and d delta / dy at values (n,) of the variable of integration.

    turn: the value of y beyond which delta - y is constant.
    """
    inverse = 1 / start.speed**2
    early = np.minimum(y, turn)
    delta = inverse * np.expm1(2 * early) / 2 + np.maximum(y - turn, 0)
    stretch = np.where(y < turn, inverse * np.exp(2 * early), 1)
    grown = np.expm1(delta)
    decay = 1 / (1 + grown)
    sinh = (grown + grown * decay) / 2
    added = start.cosine**2 * delta + sinh * ((1 + start.sine**2) * decay + start.deficit**2 * sinh)
    root = np.sqrt(inverse + added)
    speed = (decay + start.deficit * sinh) / root
    climb = (start.sine * decay - start.deficit * sinh) / root
    return start.cosine / root, climb, speed, np.log1p(added * start.speed**2) / 2, stretch


def _relaxed(along: WideArray, times: WideArray) -> WideArray:
    """The course (5, n) from the terminal velocity, with a small horizontal speed (1,) that decays by exp(-t)."""
    left = -along * np.expm1(-times)
    return np.stack([left, -times, times, along - left, -np.ones_like(times)])
