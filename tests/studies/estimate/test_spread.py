"""The difference between the limits of two engines, by the names of bodies and joints."""

from dataclasses import replace

import numpy as np

from bodycheck.adapters.file_motion import Names
from bodycheck.reference.trajectory import Array
from bodycheck.running.refining import Motion
from bodycheck.studies.estimate.distances import differences, in_common

T = np.linspace(0.0, 1.0, 11)


def motion(bodies: tuple[str, ...], angles: dict[str, Array]) -> Motion:
    """Bodies at rest at the origin, and joints with angles (11,), rad."""
    still = np.tile([1.0, 0.0, 0.0, 0.0], (len(bodies), len(T), 1))
    places = np.zeros((len(bodies), len(T), 3))
    values = np.array(list(angles.values()))
    none = (np.empty((0, len(T), 4)), np.empty((0, len(T), 3)), None, None, (), 10, 0.0)
    return Motion(T, places, still, values, *none, names=Names(bodies, tuple(angles)))


def test_joints_are_compared_by_name_and_not_by_their_order() -> None:
    one = motion(("arm", "hand"), {"shoulder": T, "wrist": 2 * T})
    other = motion(("hand", "arm"), {"wrist": 2 * T + 0.25, "shoulder": T, "extra": 9 * T})
    apart = differences(None, *in_common(one, other))
    assert np.allclose(apart["joint_position_error"], 0.25)
    assert np.allclose(apart["position_error"], 0.0)


def test_centres_of_mass_are_not_compared_if_an_engine_has_joined_links() -> None:
    one, other = motion(("arm", "hand"), {"shoulder": T}), motion(("arm",), {"shoulder": T})
    moved = replace(other, position=other.position + 0.1)
    apart = differences(None, *in_common(one, moved))
    assert "position_error" not in apart
    assert np.allclose(apart["attitude_error"], 0.0)


def test_engines_without_a_common_name_have_nothing_to_compare() -> None:
    assert differences(None, *in_common(motion(("arm",), {"a": T}), motion(("leg",), {"b": T}))) == {}
