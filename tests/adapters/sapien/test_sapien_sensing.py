"""Sensors in SAPIEN: the incoming forces of joints, and the impulses of contacts."""

import numpy as np
import pytest

from bodycheck.adapters import registry
from tests.support.sensor_readings import readings, reasons

SAPIEN = registry.load("sapien")


@pytest.mark.parametrize("spelling", ["PGS", "TGS"])
def test_the_wrench_at_rest_is_that_of_the_weight(spelling: str) -> None:
    seen = readings(SAPIEN, "sensor-rest", spelling, 0.002, 3)
    assert not seen.given["wrench"][0].any()  # before the first step there is none
    assert seen.given["wrench"][1:] == pytest.approx(seen.expected["wrench"][1:], abs=1e-5)  # single precision of 20 N


@pytest.mark.parametrize("spelling", ["PGS", "TGS"])
def test_the_wrench_of_a_swinging_arm_is_along_the_axes_of_the_child(spelling: str) -> None:
    """The elbow's axis is not one of the child's. The readings are a step old, which changes them by 2 percent."""
    seen = readings(SAPIEN, "sensor-three-link-wrench", spelling, 0.0005, 10)
    for name in ("base", "middle", "end"):
        given, exactly = seen.given[name][1:, :3], seen.expected[name][1:, :3]
        assert np.abs(given - exactly).max() < 0.05 * np.abs(exactly).max()


def test_sensors_that_are_states_are_lacking() -> None:
    why = reasons(SAPIEN, "sensor-rest", "PGS")
    assert not why.pop("wrench")
    assert all(reason.startswith("has no") for reason in why.values())
