"""Every applicable way to the truth of one scene, held against every other."""

from dataclasses import dataclass, replace
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference import truth
from bodycheck.reference.flight import closed_form, torque_free
from bodycheck.reference.flight.closed_form import smallest_rotation
from bodycheck.reference.principal import along_principal_axes, in_body_frame
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array
from bodycheck.reference.truth import Truth


@dataclass(frozen=True, eq=False)
class Certificate:
    """What is known of a truth's error at its n instants.

    differences: by the names of two ways, how far apart their attitudes have been so far (n,), rad; the truth is one of them.
    bound: (n,) rad, of the truth's own error: the closed form's own or, where that is less, the distance from the 128-bit run
    and twice the distance between its two forms.
    growth: (n,) attitude error per unit of relative error made at the worst moment before; None without heyoka.
    """

    truth: Truth
    differences: dict[tuple[str, str], Array]
    bound: Array
    growth: Array | None


THE_TRUTH = "truth"
ELLIPTIC = "elliptic functions"


def certify(scene: Scene, times: Array) -> Certificate:
    """The certificate of a scene's truth at ascending times (n,) >= 0 s.

    Raises as `truth.truth` does, and `NotModelled` for a body on a plane, whose bound comes from the only two ways there are.
    """
    if scene.plane is not None:
        raise truth.NotModelled("a body on a plane in more ways than the two that its printed bound comes from")
    body_frame, scene = scene, along_principal_axes(scene)
    found = truth.truth(scene, times)
    plain = truth.dop853()
    ways: dict[str, NDArray[Any]] = {
        THE_TRUTH: found.trajectory.quaternion,
        f"euler-lagrange, {plain.name}": plain.euler_lagrange(scene, times),
        f"quasi-coordinates, {plain.name}": plain.quasi_coordinates(scene, times),
    }
    body, start = scene.body, scene.initial
    if smallest_rotation(body.moments, start.angular_velocity) is closed_form.SYMMETRIC:
        # The general form holds for it too, by another way.
        ways[ELLIPTIC], _ = torque_free.rotation(body.moments, start.angular_velocity, start.quaternion, times)
    try:
        from bodycheck.reference.integration import sensitivity, taylor
    except ImportError:
        difference, growth = truth.attitude_difference, None
        quadruple: tuple[str, ...] = ()
    else:
        difference, growth = taylor.attitude_difference, sensitivity.growth(scene, times).of_any
        for precision, name in taylor.NAMES.items():
            ways[f"euler-lagrange, {name}"] = taylor.euler_lagrange(scene, times, precision).quaternion
            ways[f"quasi-coordinates, {name}"] = taylor.quasi_coordinates(scene, times, precision).quaternion
        quadruple = tuple(ways)[-2:]

    apart = {(one, other): np.maximum.accumulate(difference(ways[one], ways[other])) for one, other in combinations(ways, 2)}
    bound = closed_form.bound(scene, times)
    if quadruple:
        lagrange, euler = quadruple
        bound = np.minimum(bound, apart[THE_TRUTH, lagrange] + 2 * apart[lagrange, euler])
    told = replace(found, scene=body_frame, trajectory=in_body_frame(body_frame, found.trajectory))
    return Certificate(told, apart, bound, growth)
