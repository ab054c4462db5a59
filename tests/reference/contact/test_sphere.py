"""A sphere on a plane against event-driven integration, against the laws themselves, and in its limits."""

import numpy as np
import pytest

from bodycheck.reference.contact.motion import ContactMotion
from bodycheck.reference.contact.problem import problem
from bodycheck.reference.contact.ways import contact_motion
from bodycheck.reference.kinematics import geodesic_angle, rotate
from bodycheck.reference.scene import Plane, State
from bodycheck.reference.trajectory import Array
from tests.support.round_bodies import ball_on, integrated

#: DOP853 at its least tolerance leaves some hundred roundings of each of these numbers, of size 1 to 10.
TOLERANCE = 1e-12

STARTS = {
    "backspin and sidespin": (Plane(0.3), State((0.0, 0.0, 0.1), velocity=(2.0, 0.5, 0.0), angular_velocity=(1.0, -30.0, 5.0))),
    "rolls at once": (Plane(0.3), State((0.0, 0.0, 0.1), velocity=(1.0, 0.0, 0.0), angular_velocity=(0.0, 10.0, 3.0))),
    "no friction": (Plane(), State((0.0, 0.0, 0.1), velocity=(1.0, 0.5, 0.0), angular_velocity=(3.0, 10.0, 3.0))),
    "rolls down with spin": (Plane(0.5, incline=0.4), State((0.0, 0.0, 0.1), angular_velocity=(0.0, 0.0, 4.0))),
    "slips down": (Plane(0.1, incline=0.6), State((0.0, 0.0, 0.1), angular_velocity=(0.0, 0.0, 4.0))),
    "slips down, then rolls": (Plane(0.3, incline=0.4), State((0.0, 0.0, 0.1), velocity=(3.0, 0.0, 0.0))),
    "slips up, then rolls": (Plane(0.3, incline=0.4), State((0.0, 0.0, 0.1), velocity=(-3.0, 0.0, 0.0))),
    "slips up, then down": (Plane(0.1, incline=0.6), State((0.0, 0.0, 0.1), velocity=(-3.0, 0.0, 0.0))),
    "slips across, then rolls": (
        Plane(0.3, incline=0.4),
        State((0.0, 0.0, 0.1), velocity=(-1.0, 2.0, 0.0), angular_velocity=(5.0, -8.0, 3.0)),
    ),
    "slips across for ever": (Plane(0.1, incline=0.6), State((0.0, 0.0, 0.1), velocity=(-1.0, 2.0, 0.0))),
    "dropped": (Plane(0.3, restitution=0.5), State((0.0, 0.0, 1.1))),
    "dropped without restitution": (Plane(0.3), State((0.0, 0.0, 1.1), angular_velocity=(5.0, 2.0, 0.0))),
    "bounces for ever": (Plane(0.3, restitution=1.0), State((0.0, 0.0, 0.3), velocity=(0.5, 0.0, 0.0))),
    "thrown with spin": (
        Plane(0.2, restitution=0.7),
        State((0.0, 0.0, 0.6), velocity=(2.0, 1.0, -1.0), angular_velocity=(20.0, -40.0, 6.0)),
    ),
    "bounces down a ramp": (
        Plane(0.2, incline=0.3, restitution=0.6),
        State((0.0, 0.0, 0.6), velocity=(0.0, 1.0, 0.0), angular_velocity=(0.0, -20.0, 6.0)),
    ),
}  # fmt: skip


def found(plane: Plane, state: State, times: Array, **body: float) -> ContactMotion:
    return contact_motion(problem(ball_on(plane, state, **body)), times)


@pytest.mark.parametrize(
    ("name", "ratio"), [*((name, 0.4) for name in STARTS), ("slips across, then rolls", 0.6), ("thrown with spin", 0.6)]
)
def test_a_motion_is_that_of_an_integration_with_events(name: str, ratio: float) -> None:
    plane, state = STARTS[name]
    times = np.linspace(0.0, 0.9, 46)
    known = integrated(plane, state, times, ratio=ratio)
    motion = found(plane, state, times, ratio=ratio)
    here = ~np.isnan(known.position[:, 0])
    assert here.sum() > 30
    assert motion.position[0, here] == pytest.approx(known.position[here], abs=TOLERANCE)
    assert motion.velocity[0, here] == pytest.approx(known.velocity[here], abs=10 * TOLERANCE)
    spin = rotate(motion.quaternion[0], motion.spin[0])
    assert spin[here] == pytest.approx(known.spin[here], abs=100 * TOLERANCE)  # a velocity over the radius
    turned = geodesic_angle(motion.quaternion[0, here].astype(float), known.quaternion[here] / norms(known.quaternion[here]))
    assert turned.max() < 10 * TOLERANCE
    events = [(event.kind, event.time) for event in motion.events if event.time <= known.until]
    assert [kind for kind, _ in events[: len(known.events)]] == [kind for kind, _ in known.events]
    assert [time for _, time in events[: len(known.events)]] == pytest.approx([time for _, time in known.events], abs=1e-12)


def norms(quaternions: Array) -> Array:
    return np.linalg.norm(quaternions, axis=1, keepdims=True)
