"""Phases that grow steadily with time, reduced to one turn before they are rounded."""

import numpy as np

from bodycheck.reference.independent.arithmetic import Real, Wide, WideArray, wide
from bodycheck.reference.independent.border import MP
from bodycheck.reference.trajectory import Array

#: Bits of the lower part of a time that is split into two; the upper part has the other 26.
_LOWER_BITS = 27

#: Bits of a rate that are counted: 2^-64 of a turn after 2^46 turns.
_RATE_BITS = 110

#: Bits of a piece of a rate. Its product with either part of a time is exact in the wide type.
_PIECE_BITS = np.finfo(Wide).nmant + 1 - _LOWER_BITS


def turns(offset: Real, rate: Real, times: Array) -> tuple[WideArray, WideArray]:
    """Whole numbers of turns (n,), and what is left, in [-1/2, 1/2], of offset + rate t at times t (n,), s.

    offset: turns at t = 0. rate: turns per second. Each piece of the rate and of the time is multiplied without rounding, and
    whole turns are dropped at once, so that what is left has the accuracy of the wide type after any number of turns.
    """
    whole = MP.nint(offset)
    count, left = np.full(len(times), wide(whole)), np.full(len(times), wide(offset - whole))
    upper = (np.ascontiguousarray(times).view(np.int64) & -(1 << _LOWER_BITS)).view(np.float64)
    parts = upper.astype(Wide), (times - upper).astype(Wide)
    for piece in _pieces(rate):
        for part in parts:
            product = piece * part
            nearest = np.rint(product)
            count += nearest
            left += product - nearest
    nearest = np.rint(left)
    return count + nearest, left - nearest


def _pieces(rate: Real) -> list[np.longdouble]:
    """Numbers of few bits each, whose sum is a rate."""
    pieces, rest, bits = [], rate, 0
    while rest and bits < _RATE_BITS:
        fraction, exponent = MP.frexp(rest)
        piece = MP.ldexp(MP.nint(MP.ldexp(fraction, _PIECE_BITS)), exponent - _PIECE_BITS)
        pieces.append(wide(piece))
        rest, bits = rest - piece, bits + _PIECE_BITS
    return pieces
