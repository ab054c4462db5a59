"""The rotation of a body without torque by Taylor series of Euler's equations, along the axes in which the body is given.

It knows no principal axes, elliptic functions or quaternions: dL/dt = L x Omega with L = I Omega, and dR/dt = R [Omega]. So it
checks the closed form, for motions of some dozen radians.
"""

from collections.abc import Sequence

from tests.support.multiprecision.arithmetic import MP, Matrix, Real, Vector, norm, vector

#: Terms of a series, and the angle (rad) of a step; what is left out was seen to be below 1e-35 for motions of ten radians.
TERMS, STEP_RAD = 30, MP.mpf("0.25")

#: The cyclic orders of three indices.
CYCLES = ((0, 1, 2), (1, 2, 0), (2, 0, 1))


def integrated(inertia: Matrix, attitude: Matrix, rates: Vector, times: Sequence[float]) -> list[tuple[Matrix, Vector]]:
    """Attitudes (3, 3) and angular velocities (3, 1) at ascending times >= 0 (s), with the arguments of `rotation.rotation`."""
    inverse, now, momentum, found = inertia**-1, MP.zero, inertia * rates, []
    # Omega is never larger than |L| over the least moment.
    step = STEP_RAD / (norm(momentum) * max(MP.eigsy(inverse, eigvals_only=True)))
    for time in times:
        while now < MP.mpf(time):
            forward = min(step, MP.mpf(time) - now)
            attitude, momentum = _step(inverse, attitude, momentum, forward)
            now += forward
        found.append((attitude, inverse * momentum))
    return found


def _step(inverse: Matrix, attitude: Matrix, momentum: Vector, step: Real) -> tuple[Matrix, Vector]:
    """Attitude and angular momentum in the body after one step (s): the Taylor coefficients, scaled by the step, are added."""
    momenta: list[list[Real]] = [[each] for each in momentum]
    rates: list[list[Real]] = [[], [], []]
    turns: list[list[list[Real]]] = [[[attitude[row, column]] for column in range(3)] for row in range(3)]
    for order in range(TERMS):
        for axis in range(3):
            rates[axis].insert(0, MP.fdot((inverse[axis, n], momenta[n][order]) for n in range(3)))
        factor = step / (order + 1)
        for series in (momenta, *turns):  # each row of R obeys the same equation as L, for both are at rest in the world
            for axis, coefficient in [(k, _product(series, rates, i, j)) for i, j, k in CYCLES]:
                series[axis].append(factor * coefficient)
    sums = MP.matrix([[MP.fsum(turns[row][column]) for column in range(3)] for row in range(3)])
    return sums, vector([MP.fsum(series) for series in momenta])


def _product(series: list[list[Real]], rates: list[list[Real]], i: int, j: int) -> Real:
    """The highest coefficient of one component, a_i Omega_j - a_j Omega_i, of a vector product; the rates are in reverse."""
    length = len(rates[0])
    return MP.fdot(zip(series[i][:length], rates[j], strict=True)) - MP.fdot(zip(series[j][:length], rates[i], strict=True))
