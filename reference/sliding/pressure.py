"""Distribution of the load of a body over its footprint: a pressure p0 + p_x x + p_y y, in the body frame.

Pressures are arrays (3,) of p0, p_x, p_y. They are in N/m^2 and N/m^3 over an area, and in N and N/m at points. Among the
pressures that balance the forces on a body exactly one is linear over the footprint. For an area this is the usual assumption
of an elastic foundation. Four corners of a rigid body are statically indeterminate; for them the same linear choice is made,
which is the load that equal springs under the corners would carry.
"""

import numpy as np

from bodycheck.reference.errors import OutOfReach, WouldTip
from bodycheck.reference.sliding.footprint import Disk, Footprint, outline
from bodycheck.reference.trajectory import Array

#: Size of a negative pressure, as a fraction of p0, up to which it counts as a rounding error.
PRESSURE_ROUNDING = 1e-12


def uniform(loads: Array, load: float) -> Array:
    """The pressure (3,) that is the same everywhere; loads: moments (3, 3) of the footprint, load: the weight (N)."""
    return np.array([load / loads[0, 0], 0.0, 0.0])


def balanced(loads: Array, directions: Array, coefficient: float, load: float, height: float) -> Array:
    """The linear pressure that balances the moment of its own friction about the centre of mass.

    The friction force F is linear in the pressure, and the moments about the centre of mass balance if the load is centred at
    -(height/load) F. Together with the total load these are three linear equations.

    Parameters
    ----------
    loads
        (3, 3) moments of the footprint, from `footprint.load_moments`.
    directions
        (3, 3) moments of the direction of sliding, from `direction_moments`.
    coefficient
        Coefficient of friction mu.
    load
        Weight of the body (N).
    height
        Height of the centre of mass above the plane (m).

    Returns
    -------
    Array
        (3,) the pressure. It is negative somewhere if the body would tip.

    Raises
    ------
    OutOfReach
        If the equations are singular in double precision, as for a face that is tiny beside the moment of friction.
    """
    matrix = loads.T.copy()
    matrix[1:] -= coefficient * height * directions[:, :2].T
    try:
        return np.asarray(np.linalg.solve(matrix, np.array([load, 0.0, 0.0])))
    except np.linalg.LinAlgError as error:
        raise OutOfReach("the equations of the load that balances friction are singular in double precision") from error


def check(footprint: Footprint, pressure: Array) -> None:
    """Raise `WouldTip` if a pressure (3,) is negative anywhere on the footprint."""
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
