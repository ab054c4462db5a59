"""The order of an integrator, observed in an engine's own runs."""

import numpy as np

from bodycheck.adapters.contract import Adapter, Method
from bodycheck.reference.kinematics import geodesic_angle
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.scene import Scene


def observed_order(
    adapter: Adapter, scene: Scene, spelling: str, steps: tuple[float, float, float], duration: float
) -> dict[str, float]:
    """The orders of position, attitude and angular velocity at the end of a motion, by the name of the quantity.

    They come from the differences between runs with three time steps (s), each half of the one before, so that no truth is
    asked: log2(|x(h) - x(h/2)| / |x(h/2) - x(h/4)|). duration: that of the motion, in s.
    """
    coarse, middle, fine = (
        adapter.prepare([scene], Method.parse(spelling, step)).advance(np.array([round(duration / step)]))[0, -1, 0]
        for step in steps
    )
    differences = {
        "position": [np.linalg.norm(one[:3] - other[:3]) for one, other in ((coarse, middle), (middle, fine))],
        "attitude": [geodesic_angle(one[3:7], other[3:7]) for one, other in ((coarse, middle), (middle, fine))],
        "angular velocity": [np.linalg.norm(one[10:] - other[10:]) for one, other in ((coarse, middle), (middle, fine))],
    }
    return {name: float(np.log2(first / second)) for name, (first, second) in differences.items()}


def observed_mechanism_order(
    adapter: Adapter, mechanism: Mechanism, spelling: str, steps: tuple[float, float, float], duration: float
) -> dict[str, float]:
    """The orders of the positions and attitudes of all bodies at the end of a motion, as `observed_order` has those of one."""
    coarse, middle, fine = (
        adapter.prepare([mechanism], Method.parse(spelling, step)).advance(np.array([round(duration / step)]))[0, -1]
        for step in steps
    )
    pairs = ((coarse, middle), (middle, fine))
    differences = {
        "position": [np.linalg.norm(one[:, :3] - other[:, :3]) for one, other in pairs],
        "attitude": [np.linalg.norm(geodesic_angle(one[:, 3:7], other[:, 3:7])) for one, other in pairs],
    }
    return {name: float(np.log2(first / second)) for name, (first, second) in differences.items()}
