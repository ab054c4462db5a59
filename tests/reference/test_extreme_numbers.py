"""Truths of accepted cases whose numbers are extreme: each has a bound or a reason, and no number goes out of range unseen."""

import contextlib

import numpy as np
import pytest

from bodycheck.casefile.case import parse
from bodycheck.reference.errors import OutOfReach
from bodycheck.running.truths import truth
from tests.support.cases import a_case

#: Growth of rounding, and a period, that together are beyond the range of doubles.
NEARLY_UNSTABLE = {
    "body": {"shape": "none", "mass": 1.0, "inertia": [24.0, 17.0, 7.2]},
    "initial": {"angular_velocity": [1e-100, 2.3e41, 0.0]},
}

#: Drag that leaves the velocity unknown, and a moment that turns its error into an energy beyond the range of doubles.
HEAVY_DRAG = {
    "body": {"shape": "none", "mass": 1e-75, "inertia": [7.5e56, 7.5e56, 1.0]},
    "initial": {"velocity": [-1e-99, -105.0, 0.0], "angular_velocity": [-7.5e-57, 1e16, 1e75]},
    "scene": {"drag": {"quadratic": 9e99}},
    "run": {"duration": 4e7, "samples": 3},
}

#: A spin so fast that the turn until its stop, and its error, are more radians than the rates leave room for.
SPINNING_SPECK = {
    "body": {"shape": "brick", "mass": 1e-99, "semi_axes": [1e-9, 7e-82, 2.8e-7]},
    "initial": {"velocity": [1e9, -1.16e33, 0.0], "angular_velocity": [0.0, 0.0, 2e19]},
    "scene": {"gravity": 5.8e-28, "plane": {"friction": 2.2e-15, "law": "area", "pressure": "uniform"}},
    "run": {"duration": 1e75, "samples": 11},
}

#: A slide whose first trial step leads out of the range of doubles.
SPINNING_NEEDLE = {
    "body": {"shape": "cylinder", "mass": 1e-16, "radius": 3.5e-34, "half_length": 1e100, "inertia": [9e99, 9e99, 1e-31]},
    "initial": {"velocity": [1.1e-68, 1.0, 0.0], "angular_velocity": [0.0, 0.0, -1e75]},
    "scene": {"gravity": 9.81, "plane": {"friction": 1e9, "law": "area", "pressure": "balanced"}},
    "run": {"duration": 1e-99, "samples": 11},
}

#: A slide whose error grows beyond the range of doubles within a panel.
SPINNING_BEAM = {
    "body": {"shape": "brick", "mass": 2.4763052716664716e-55, "semi_axes": [1e-100, 9.753414438283735e51, 1e9]},
    "initial": {"velocity": [-7.090944322263792e59, 1e-100, 0.0], "angular_velocity": [0.0, 0.0, 4.272336007281539e38]},
    "scene": {
        "gravity": 1.7923668382312466e-31,
        "plane": {"friction": 9.569804835365697e-73, "law": "corners", "pressure": "balanced"},
    },
    "run": {"duration": 4.510456185364365e-73, "samples": 11},
}

#: A slide whose error has a square beyond the range of doubles, and which nearly nothing brakes.
SPINNING_ROD = {
    "body": {
        "shape": "brick",
        "mass": 2.964842107623685e-34,
        "semi_axes": [1e-50, 1e-50, 1e9],
        "inertia": [1.1803941557707058e66, 1.7086379861091958e46, 1.1803941557707058e66],
    },
    "initial": {"velocity": [0.0, -1e-16, 0.0], "angular_velocity": [0.0, 0.0, -3.8717246242275725e37]},
    "scene": {"gravity": 9.81, "plane": {"friction": 3.50447309801852e-33, "law": "area", "pressure": "uniform"}},
    "run": {"duration": 1e50, "samples": 3},
}

#: A spin whose acceleration has a square beyond the range of doubles, which only a witness forms.
FASTEST_SPIN = {
    "body": {"shape": "cylinder", "mass": 1.9e-19, "radius": 1e-50, "half_length": 1e-99},
    "initial": {"euler_zxz": [-1.406911816596725e58, 1e-75, 6.4e-90], "euler_rates": [0.0, 0.0, 1e100]},
    "run": {"duration": 7.5e-99, "samples": 2},
}

#: A slide whose friction no load on its face balances, as its equations are singular in double precision.
SLIDING_NEEDLE = {
    "body": {"shape": "cylinder", "mass": 9.6e-69, "radius": 1e-75, "half_length": 3.8e64, "inertia": [1e75, 1.0, 1e75]},
    "initial": {"velocity": [5.5e21, 0.0, 0.0], "angular_velocity": [0.0, 0.0, 1e-50]},
    "scene": {"gravity": 0.0, "plane": {"friction": 1.5e68, "law": "area", "pressure": "balanced"}},
    "run": {"duration": 1e-50, "samples": 101},
}

SCENES = [
    SLIDING_NEEDLE,
    NEARLY_UNSTABLE,
    HEAVY_DRAG,
    SPINNING_SPECK,
    SPINNING_NEEDLE,
    SPINNING_BEAM,
    SPINNING_ROD,
    FASTEST_SPIN,
]


@pytest.mark.parametrize("scene", SCENES)
def test_a_truth_of_extreme_numbers_has_a_bound_or_a_reason(scene: dict[str, object]) -> None:
    case = parse(a_case(**scene), "extreme")
    with contextlib.suppress(OutOfReach):
        for bound in vars(truth(case).bounds).values():
            assert not np.isnan(bound).any()
