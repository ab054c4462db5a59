"""Carlson's symmetric elliptic integral R_J for arrays of the wide type [DLMF 19.16.2].

It is computed by duplications and a series [DLMF 19.26.19, 19.36.2].
"""

import numpy as np

from bodycheck.reference.exact.numbers import Wide
from bodycheck.reference.exact.pairs import WideArray

#: Relative distance of the arguments from their mean at which the series, to the seventh order, is exact in 80 bits.
_CLOSE = 2e-3

#: The number of duplications after which any arguments are that close: each divides the distance by four.
_MOST = 200


def third_kind(x: WideArray, y: WideArray, z: WideArray, p: WideArray) -> WideArray:
    """R_J(x, y, z, p) for arrays (n,) of numbers >= 0, at most one of x, y, z being zero, and p > 0."""
    total, scale = np.zeros_like(p), Wide(1)
    for _ in range(_MOST):
        mean = (x + y + z + 2 * p) / 5
        if np.all(np.maximum.reduce([abs(x - mean), abs(y - mean), abs(z - mean), abs(p - mean)]) < _CLOSE * mean):
            break
        rx, ry, rz = np.sqrt(x), np.sqrt(y), np.sqrt(z)
        shift = rx * ry + rx * rz + ry * rz
        alpha, beta = p * (rx + ry + rz) + rx * ry * rz, np.sqrt(p) * (p + shift)
        total = total + scale * _elementary(alpha, beta)
        x, y, z, p, scale = (x + shift) / 4, (y + shift) / 4, (z + shift) / 4, (p + shift) / 4, scale / 4
    return 3 * total + scale * _series(x, y, z, p)


def _elementary(a: WideArray, b: WideArray) -> WideArray:
    """R_C(a^2, b^2) for positive a and b, without cancellation where b is much smaller than a."""
    apart = (b - a) * (b + a)
    root = np.sqrt(np.abs(apart))
    safe = np.where(root > 0, root, Wide(1))
    arc = np.where(apart > 0, np.arctan(safe / a), np.log1p((a - b + safe) / b))
    value: WideArray = np.where(root > 0.01 * a, arc / safe, _near(apart / (a * a)) / a)
    return value


def _near(e: WideArray) -> WideArray:
    """R_C(1, 1 + e) for |e| < 1e-4: atan(sqrt e) / sqrt e and its continuation, by their series."""
    return 1 - e * (Wide(1) / 3 - e * (Wide(1) / 5 - e * (Wide(1) / 7 - e * (Wide(1) / 9 - e / 11))))


def _series(x: WideArray, y: WideArray, z: WideArray, p: WideArray) -> WideArray:
    mean = (x + y + z + 2 * p) / 5
    dx, dy, dz = 1 - x / mean, 1 - y / mean, 1 - z / mean
    dp = -(dx + dy + dz) / 2
    product = dx * dy * dz
    e2 = dx * dy + dx * dz + dy * dz - 3 * dp * dp
    e3 = product + 2 * e2 * dp + 4 * dp**3
    e4 = (2 * product + e2 * dp + 3 * dp**3) * dp
    e5 = product * dp * dp
    terms = -3 * e2 / 14 + e3 / 6 + 9 * e2 * e2 / 88 - 3 * e4 / 22 - 9 * e2 * e3 / 52 + 3 * e5 / 26
    terms = terms - e2**3 / 16 + 3 * e3 * e3 / 40 + 3 * e2 * e4 / 20
    terms = terms + 45 * e2 * e2 * e3 / 272 - 9 * (e3 * e4 + e2 * e5) / 68
    value: WideArray = (1 + terms) / (mean * np.sqrt(mean))
    return value
