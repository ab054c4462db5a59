"""One body in free flight has the same truth as a file of format 1 and as one of format 2, to the sum of both bounds."""

import numpy as np
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from bodycheck.casefile.case import parse
from bodycheck.casefile.toml_text import written
from bodycheck.reference.kinematics import geodesic_angle
from bodycheck.reference.truth import truth
from tests.support.random_mechanisms import quaternions

#: Moderate numbers: with them, a second of motion is followed in a fraction of a second.
numbers = st.floats(-3.0, 3.0).map(lambda value: round(value, 6))
lengths = st.floats(0.05, 0.5).map(lambda value: round(value, 6))
vectors = st.tuples(numbers, numbers, numbers).map(list)
TIMES = np.linspace(0.0, 1.0, 5)


@given(st.tuples(lengths, lengths, lengths).map(list), vectors, vectors, vectors, quaternions(), st.sampled_from([0.0, 9.81]))
@settings(max_examples=10, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
def test_both_formats_of_a_body_have_the_same_truth(
    semi_axes: list[float],
    position: list[float],
    velocity: list[float],
    rates: list[float],
    attitude: tuple[float, float, float, float],
    gravity: float,
) -> None:
    body = {"shape": "brick", "semi_axes": semi_axes, "mass": 2.0}
    initial = {"position": position, "velocity": velocity, "angular_velocity": rates, "quaternion": list(attitude)}
    rest = {"scene": {"gravity": gravity}, "run": {"duration": 1.0, "samples": 5}}
    heading = {"name": "drawn", "title": "A body that was drawn"}
    first = written({"format": 1, **heading, "body": body, "initial": initial, **rest})
    second = written({"format": 2, **heading, "bodies": [{"name": "brick", **body, "initial": initial}], **rest})
    one, other = (truth(parse(text, "f").scene, TIMES) for text in (first, second))
    seen = other.trajectory.body(0)
    apart = {
        "error": geodesic_angle(one.trajectory.quaternion, seen.quaternion),
        "position_error": np.linalg.norm(one.trajectory.position - seen.position, axis=-1),
        "velocity_error": np.linalg.norm(one.trajectory.velocity - seen.velocity, axis=-1),
        "angular_velocity_error": np.linalg.norm(one.trajectory.angular_velocity - seen.angular_velocity, axis=-1),
    }
    for name, distances in apart.items():
        bounds = getattr(one.bounds, name) + getattr(other.bounds, name)
        # Differences of doubles are themselves rounded, relative to the size of what is subtracted.
        size = 1.0 if name == "error" else 1.0 + np.abs(getattr(one.trajectory, name.removesuffix("_error"))).max()
        assert (distances <= bounds + 4 * np.finfo(float).eps * size).all(), name
