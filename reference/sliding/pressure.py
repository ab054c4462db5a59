"""How the load of a body spreads over its footprint: a pressure p0 + p_x x + p_y y, in the body frame.

Of the pressures that balance the forces on a body there is one that is linear over the footprint. For an area it is the usual
assumption of an elastic foundation; four corners of a rigid body are statically indeterminate, and the same linear choice is
made for them: the load that equal springs under the corners would carry.
"""

import numpy as np

from bodycheck.reference.errors import WouldTip
from bodycheck.reference.sliding.footprint import Disk, Footprint, outline
from bodycheck.reference.trajectory import Array

#: Least pressure, as a fraction of the mean, that still counts as none.
PRESSURE_ROUNDING = 1e-12


def uniform(loads: Array, load: float) -> Array:
    """The pressure (3,) that is the same everywhere, of a footprint with the moments `loads` (3, 3) under a load (N)."""
    return np.array([load / loads[0, 0], 0.0, 0.0])


def balanced(loads: Array, directions: Array, coefficient: float, load: float, height: float) -> Array:
    """The linear pressure (3,) that balances the moment of its own friction about the centre of mass.

    loads, directions: moments (3, 3) of the footprint and of the direction of sliding. height: of the centre of mass (m).
    The friction F of a pressure is linear in it, and the moments about the centre of mass balance where the load is centred
    on -(height/load) F: three linear equations.
    """
    matrix = loads.T.copy()
    matrix[1:] -= coefficient * height * directions[:, :2].T
    return np.asarray(np.linalg.solve(matrix, np.array([load, 0.0, 0.0])))


def check(footprint: Footprint, pressure: Array) -> None:
    """Raises `WouldTip` where a pressure (3,) is negative anywhere on the footprint."""
    p0, slope = pressure[0], pressure[1:]
    if isinstance(footprint, Disk):
        steepness = float(np.hypot(*slope))
        where = -footprint.radius * slope / (steepness or 1.0)
        least = p0 - footprint.radius * steepness
    else:
        points = outline(footprint)
        pressures = p0 + points @ slope
        where, least = points[pressures.argmin()], pressures.min()
    if not least >= -PRESSURE_ROUNDING * abs(p0):
        raise WouldTip(
            f"the body would tip: to balance friction, the load at ({where[0]:.4g}, {where[1]:.4g}) m of its face would have "
            f"to be {least / p0:.3g} times the mean"
        )
