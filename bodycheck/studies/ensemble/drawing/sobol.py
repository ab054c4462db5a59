"""Points of 16 independently scrambled Sobol sequences, which fill a unit cube more evenly than random numbers.

Member i of an ensemble has the point i div 16 of the sequence i mod 16, so that any number of members may be drawn, any member
alone, and the spread of the 16 sequences says how certain a mean over the members is [Owen, Randomly permuted (t,m,s)-nets and
(t,s)-sequences, 1995]. The points are those of `scipy.stats.qmc.Sobol` with the scrambling of Matousek, 52 bits each, moved by
half of their distance: no coordinate is 0 or 1.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference.trajectory import Array

#: The number of sequences.
SEQUENCES = 16

#: Bits of a coordinate. With one bit more for half of the distance, every coordinate is a double.
BITS = 52
CELL, HALF_CELL = 2.0**-BITS, 2.0 ** -(BITS + 1)

#: Coordinates as whole numbers of cells.
Cells = NDArray[np.uint64]


def points(seed: int, dimensions: int, first: int, count: int) -> Array:
    """Return the points (count, dimensions) of consecutive members, with coordinates between 0 and 1.

    Point n of a sequence is its first one, with the exclusive or of the direction numbers whose bits are 1 in the Gray code
    of n [Antonov and Saleev, 1979], so that points far along a sequence take no longer. SciPy's own `fast_forward` fails for
    more than 32 bits (1.17).

    Parameters
    ----------
    seed
        The seed of the ensemble.
    dimensions
        The number of coordinates; the points are others for another number.
    first
        The number of the first member, from 0.
    count
        How many members.
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
    from scipy.stats import qmc  # takes a second and tens of megabytes, of which processes that draw nothing have no use

    starts, directions = [], []
    for number in range(SEQUENCES):
        generator = np.random.Generator(np.random.PCG64(np.random.SeedSequence(seed, spawn_key=(number,))))
        state = vars(qmc.Sobol(dimensions, scramble=True, bits=BITS, seed=generator))
        starts.append(state["_shift"])
        directions.append(state["_sv"].T)
    return np.stack(starts), np.stack(directions, axis=1)
