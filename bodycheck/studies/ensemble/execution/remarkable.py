"""The remarkable runs of many members: those that failed, and the worst."""

from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from numpy.typing import NDArray

from bodycheck.reference.trajectory import Array
from bodycheck.results.outcome import Completed, Unsupported


def failed(status: pa.Array, passed: pa.Array) -> NDArray[np.bool_]:
    """Return which runs (n,) failed: their status is neither ok nor unsupported, or they have not passed."""
    fine = pc.is_in(status, value_set=pa.array([Completed.status, Unsupported.status]))
    return np.asarray(~fine.to_numpy(zero_copy_only=False) | ~passed.fill_null(True).to_numpy(zero_copy_only=False))


def worst(distances: Array, members: Any) -> tuple[float, int] | None:
    """Return the largest of the distances (n,) of some members (n,) from the ideal value, and the first member with it.

    None if all are NaN, which is no value.
    """
    if np.isnan(distances).all():
        return None
    place = int(np.nanargmax(distances))
    return float(distances[place]), int(members[place])
