"""Draw the members of an ensemble: points of Sobol sequences, mapped to the distributions of its keys.

Every map preserves the measure, so that evenly spread points give evenly spread values. A value depends on its member alone, to
the last bit, and not on the other members that are drawn with it. Functions that are not exact are evaluated in the widest type
of NumPy, whose code is the same for all processors of a kind: results for doubles differ in the last digit between processors.

The points come from 16 independently scrambled Sobol sequences, which fill a unit cube more evenly than random numbers.
Member i of an ensemble has the point i div 16 of the sequence i mod 16, so that any number of members, or any single
member, can be drawn. The spread of the 16 sequences shows the uncertainty of a mean over the members [Owen, Randomly permuted
(t,m,s)-nets and (t,s)-sequences, 1995]. The points are those of `scipy.stats.qmc.Sobol` with the scrambling of Matousek and 52
bits each, moved by half of their spacing, so that no coordinate is 0 or 1.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

from bodycheck.casefile.distributions import AnyAttitude, Choice, Distribution, Ensemble, LogUniform, Normal, OnSphere, Uniform
from bodycheck.reference.exact.numbers import Wide
from bodycheck.reference.trajectory import Array

#: The number of sequences.
SEQUENCES = 16

#: The bits of a coordinate. With one more bit for half of the spacing, every coordinate is exactly a double.
BITS = 52
CELL, HALF_CELL = 2.0**-BITS, 2.0 ** -(BITS + 1)

#: Coordinates as whole numbers of cells.
Cells = NDArray[np.uint64]


def values(ensemble: Ensemble, first: int, count: int) -> dict[str, Array]:
    """Return the values drawn for consecutive members, by key paths.

    Parameters
    ----------
    ensemble
        The ensemble.
    first
        The number of the first member, from 0.
    count
        The number of members.

    Returns
    -------
    Arrays (count,) of numbers and (count, k) of vectors, in SI units, in the order of the file. An attitude has the key path
    "initial.quaternion".
    """
    sizes = [dimensions(variation.distribution, variation.key.components or 1) for variation in ensemble.vary]
    uniforms = points(ensemble.seed, sum(sizes), first, count)
    by_key, start = {}, 0
    for variation, size in zip(ensemble.vary, sizes, strict=True):
        drawn = _mapped(variation.distribution, np.ascontiguousarray(uniforms[:, start : start + size]))
        by_key[variation.key.text] = drawn if variation.key.components else drawn[:, 0]
        start += size
    return by_key


def dimensions(distribution: Distribution, components: int) -> int:
    """Return the number of uniform numbers from which a vector with this number of components is drawn."""
    match distribution:
        case OnSphere():
            return 2
        case AnyAttitude():
            return 3
        case Choice():
            return 1
        case _:
            return components


def _mapped(distribution: Distribution, uniforms: Array) -> Array:
    """Return values (m, k) of a distribution for uniform numbers (m, d) strictly between 0 and 1."""
    match distribution:
        case Uniform(low, high):
            return _between(np.array(low), np.array(high), uniforms)
        case LogUniform(low, high):
            return _log_between(np.array(low), np.array(high), uniforms)
        case Normal(mean, deviation):
            return np.asarray(np.array(mean) + np.array(deviation) * ndtri(uniforms))
        case OnSphere(radius):
            return _on_sphere(radius, uniforms)
        case AnyAttitude():
            return _attitudes(uniforms)
        case Choice(choices):
            places = np.minimum((uniforms[:, 0] * len(choices)).astype(np.int64), len(choices) - 1)
            return np.array(choices)[places]


def _between(low: Array, high: Array, u: Array) -> Array:
    """Return the numbers (m, k) at the fractions u (m, k) between limits (k,)."""
    return np.asarray(np.clip(low + (high - low) * u, low, high))  # rounding could lead beyond a limit


def _log_between(low: Array, high: Array, u: Array) -> Array:
    """Return the numbers (m, k) whose logarithms are at the fractions u (m, k) between the logarithms of limits (k,)."""
    ratio = np.log(high.astype(Wide)) - np.log(low.astype(Wide))
    return np.asarray(np.clip((low * np.exp(ratio * u)).astype(float), low, high))


def _turns(u: Array) -> tuple[Array, Array]:
    """Return the cosines and sines (m,) of angles u (m,), given in turns."""
    angle = 8 * np.arctan(Wide(1)) * u
    return np.cos(angle).astype(float), np.sin(angle).astype(float)


def _on_sphere(radius: float, u: Array) -> Array:
    """Return points (m, 3), uniform on a sphere, for uniform numbers u (m, 2) that give height and longitude [Archimedes]."""
    cosine, sine = _turns(u[:, 1])
    height, across = 2 * u[:, 0] - 1, 2 * np.sqrt(u[:, 0] * (1 - u[:, 0]))
    return radius * np.stack([across * cosine, across * sine, height], axis=1)


def _attitudes(u: Array) -> Array:
    """Return unit quaternions w, x, y, z (m, 4) for uniform numbers u (m, 3) [Shoemake, Graphics Gems III, 1992]."""
    (one_cosine, one_sine), (other_cosine, other_sine) = _turns(u[:, 1]), _turns(u[:, 2])
    one, other = np.sqrt(1 - u[:, 0]), np.sqrt(u[:, 0])
    return np.stack([other * other_cosine, one * one_sine, one * one_cosine, other * other_sine], axis=1)


def points(seed: int, dimensions: int, first: int, count: int) -> Array:
    """Return the points (count, dimensions) of consecutive members, with coordinates between 0 and 1.

    Point n of a sequence is the exclusive or of its first point and the direction numbers whose bits are 1 in the Gray code of
    n [Antonov and Saleev, 1979], so that points far along a sequence take no longer. `fast_forward` of SciPy 1.17 fails for
    more than 32 bits.

    Parameters
    ----------
    seed
        The seed of the ensemble.
    dimensions
        The number of coordinates. All points depend on it.
    first
        The number of the first member, from 0.
    count
        The number of members.
    """
    member = np.arange(first, first + count, dtype=np.uint64)
    sequence, index = member % np.uint64(SEQUENCES), member // np.uint64(SEQUENCES)
    gray = index ^ (index >> np.uint64(1))
    starts, directions = _sequences(seed, dimensions)
    cells = starts[sequence]
    for bit in range(int(index.max(initial=0)).bit_length()):
        chosen = (gray >> np.uint64(bit)) & np.uint64(1)
        cells ^= directions[bit][sequence] * chosen[:, None]
    return np.asarray(cells * CELL + HALF_CELL)


@lru_cache(maxsize=16)
def _sequences(seed: int, dimensions: int) -> tuple[Cells, Cells]:
    """Return the first points (16, d) of all sequences, and their direction numbers (52, 16, d).

    The scrambling of a sequence depends on the seed and the number of the sequence.
    """
    from scipy.stats import qmc  # a second and tens of megabytes, which processes that draw nothing save

    starts, directions = [], []
    for number in range(SEQUENCES):
        generator = np.random.Generator(np.random.PCG64(np.random.SeedSequence(seed, spawn_key=(number,))))
        state = vars(qmc.Sobol(dimensions, scramble=True, bits=BITS, seed=generator))
        starts.append(state["_shift"])
        directions.append(state["_sv"].T)
    return np.stack(starts), np.stack(directions, axis=1)
