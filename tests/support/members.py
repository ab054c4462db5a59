"""Members of an ensemble in free flight, with the truth of each computed alone."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from bodycheck.figures.columns import FIGURES
from bodycheck.reference.bounds import NAMES, Bounds
from bodycheck.reference.flight.flights import Flights
from bodycheck.reference.scenes import Scenes
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truth import truth
from bodycheck.reference.truths import Truth

STATES = ("position", "quaternion", "velocity", "angular_velocity")


def truths_alone(scenes: Scenes, times: Array) -> list[Truth]:
    """The truths of scenes at some instants, each computed by itself."""
    return [truth(scenes.scene(place), times, vouched=False) for place in range(len(scenes))]


def together(truths: list[Truth]) -> Flights:
    """The truths of scenes at the same instants, with the scenes as the first axis."""
    states = (np.array([getattr(one.trajectory, name) for one in truths]) for name in STATES)
    bounds = (np.array([getattr(one.bounds, name) for one in truths]) for name in NAMES)
    forms = np.array([one.model.removeprefix("closed form: ") for one in truths])
    return Flights(Trajectory(truths[0].trajectory.t, *states), Bounds(*bounds), forms)


def rows_of(trajectory: Trajectory) -> Array:
    """The rows (..., n, 13) of the states of a trajectory."""
    return np.concatenate([getattr(trajectory, name) for name in STATES], axis=-1)


def assert_same_row(columns: Mapping[str, Array], place: int, row: Mapping[str, Any]) -> None:
    """The columns of a member hold its row, to the last bit; a figure that is not in the row is NaN."""
    for name in ("status", "reason", "passed"):
        assert columns[name][place] == row[name], name
    for name in FIGURES:
        np.testing.assert_array_equal(columns[name][place], row.get(name, np.nan), err_msg=name)
