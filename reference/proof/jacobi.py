"""Jacobi's elliptic functions in balls, as quotients of theta functions."""

from collections.abc import Callable

from flint import acb, arb

from bodycheck.reference.proof.balls import Ball
from bodycheck.reference.proof.enclosure import NotEnclosed


def jacobi(m: Ball) -> tuple[Callable[[Ball], tuple[Ball, Ball, Ball]], Ball]:
    """Return Jacobi's functions sn, cn and dn of a parameter as a function of u, and their quarter period.

    Raises `NotEnclosed` if the parameter may be 1.
    """
    quarter, other = acb(m).elliptic_k().real, acb(1 - m).elliptic_k().real
    if not (quarter.is_finite() and other.is_finite()):
        raise NotEnclosed("a motion that may end at an unstable equilibrium")
    nome = acb(arb(0), other / quarter)
    _, b, c, d = (each.real for each in acb.modular_theta(acb(0), nome))

    def functions(u: Ball) -> tuple[Ball, Ball, Ball]:
        one, two, three, four = (each.real for each in acb.modular_theta(acb(u / (2 * quarter)), nome))
        return c * one / (b * four), d * two / (b * four), d * three / (c * four)

    return functions, quarter
