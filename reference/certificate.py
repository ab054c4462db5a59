"""Certificate of a truth: every applicable computation of one motion, compared with every other.

Here a way is one such computation: the truth itself, a numerical integration of the equations of motion, or another closed
form.
"""

from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference import truth
from bodycheck.reference.errors import NotModelled
from bodycheck.reference.exact.start import start
from bodycheck.reference.flight import closed_form, torque_free
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array
from bodycheck.reference.truth import Truth
from bodycheck.reference.witness import angle_between


@dataclass(frozen=True, eq=False)
class Certificate:
    """A truth with the differences between all ways of computing it, at its n instants.

    Attributes
    ----------
    truth
        The truth.
    differences
        (n,) largest angles so far between the attitudes of two ways (rad), by the names of the two ways.
    bound
        (n,) bound of the attitude error of the truth (rad): the smaller of the bound of its closed form, and of the distance
        from the 128-bit Euler-Lagrange solution plus twice the distance between the two 128-bit solutions.
    growth
        (n,) attitude error (rad) per unit of relative error made at the worst earlier moment; None where heyoka is not
        installed. See `integration.sensitivity`.
    """

    truth: Truth
    differences: dict[tuple[str, str], Array]
    bound: Array
    growth: Array | None


#: Name of the way that is the truth.
TRUTH_WAY = "truth"

#: Name of the way by the general closed form, for a body that also has a simpler one.
ELLIPTIC_WAY = "elliptic functions"


def certify(scene: Scene, times: Array) -> Certificate:
    """The certificate of the truth of a scene in free flight, at ascending times (n,) >= 0, s.

    Raises as `truth.truth` does, and `NotModelled` for a body on a plane: the error bound of its truth already comes from the
    only two ways that exist.
    """
    if scene.plane is not None:
        raise NotModelled("a body on a plane in more ways than the two whose disagreement bounds its error")
    found = truth.truth(scene, times)
    plain = truth.dop853()
    ways: dict[str, NDArray[Any]] = {
        TRUTH_WAY: found.trajectory.quaternion,
        f"euler-lagrange, {plain.name}": plain.euler_lagrange(scene, times),
        f"quasi-coordinates, {plain.name}": plain.quasi_coordinates(scene, times),
    }
    begin = start(scene)
    if closed_form.smallest_form(begin.moments, begin.rates) is closed_form.SYMMETRIC:
        # The elliptic functions hold for this body too, and are computed by other formulas.
        ways[ELLIPTIC_WAY] = torque_free.rotation(begin, times).attitude
    try:
        from bodycheck.reference.integration import sensitivity, taylor
    except ImportError:
        difference, growth = angle_between, None
        quadruple: tuple[str, ...] = ()
    else:
        difference, growth = taylor.attitude_difference, sensitivity.growth(scene, times).of_any
        for precision, name in taylor.BACKEND_NAMES.items():
            ways[f"euler-lagrange, {name}"] = taylor.euler_lagrange(scene, times, precision).quaternion
            ways[f"quasi-coordinates, {name}"] = taylor.quasi_coordinates(scene, times, precision).quaternion
        quadruple = tuple(ways)[-2:]

    apart = {(one, other): np.maximum.accumulate(difference(ways[one], ways[other])) for one, other in combinations(ways, 2)}
    bound = closed_form.flight(scene, times).bounds.error
    if quadruple:
        lagrange, euler = quadruple
        bound = np.minimum(bound, apart[TRUTH_WAY, lagrange] + 2 * apart[lagrange, euler])
    return Certificate(found, apart, bound, growth)
