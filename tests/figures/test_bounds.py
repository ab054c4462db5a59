"""The bounds of the truth's own errors are in the units of the figures that they bound, and figures below them are told."""

from dataclasses import replace

import numpy as np
import pytest

from bodycheck import Truth, load, truth
from bodycheck.figures import friction, impacts, mechanisms, sensors, touching
from bodycheck.figures.bounds import rounded_up, within_truth
from bodycheck.figures.columns import BEFORE_DEPARTURE, COLUMNS, DEPARTURE, FIGURES, bounds_of, truth_bounds
from bodycheck.figures.definition import Comparison
from bodycheck.reference.observables import observe

BOUNDS = [
    *("truth_position_error", "truth_velocity_error", "truth_angular_velocity_error"),
    *("truth_energy_error", "truth_angular_momentum_error"),
]


@pytest.fixture(scope="module")
def flip() -> Truth:
    return truth(load("intermediate-axis-flip"), [0.0, 0.5, 1.0])


def planted(exact: Truth, factor: float) -> Truth:
    """A truth whose bounds of energy (J) and angular momentum (kg m^2/s) are these multiples of their initial sizes."""
    seen = observe(exact.scene, exact.trajectory)
    energy, momentum = abs(seen.total_energy[0]), np.linalg.norm(seen.angular_momentum[0])
    ones = np.ones(len(exact.trajectory))
    bounds = replace(exact.bounds, energy_error=factor * energy * ones, angular_momentum_error=2 * factor * momentum * ones)
    return replace(exact, bounds=bounds)


def test_the_new_columns_follow_those_that_were_there() -> None:
    names = list(COLUMNS)
    first = names.index(BOUNDS[0])
    assert names[first - 1] == "time_in_contact"
    assert names[first : first + len(BOUNDS)] == BOUNDS
    own = (figure.name for module in (mechanisms, touching, friction, sensors, impacts) for figure in module.FIGURES)
    later = (
        "quaternion_norm_error",
        *own,
        "kind",
        "tags",
        "steps_taken",
        "steps_rejected",
        "evaluations",
        "role",
        DEPARTURE,
        *BEFORE_DEPARTURE.values(),
        *("efforts", "control_law", "contact_terms"),
    )
    assert all(name.endswith(("_limit", "_margin")) or name in later for name in names[first + len(BOUNDS) :])
    assert list(COLUMNS).index("truth_error") < list(COLUMNS).index("steps")


def test_a_bound_has_the_unit_of_what_it_bounds() -> None:
    bounded = {figure.name: figure for figure in FIGURES.values() if figure.bounded_by}
    assert {figure.bounded_by for figure in bounded.values()} == {"truth_error", *BOUNDS}
    for figure in bounded.values():
        assert FIGURES[figure.bounded_by].unit == figure.unit
        assert FIGURES[figure.bounded_by].of_truth


def test_energy_and_angular_momentum_are_relative_to_the_sizes_of_their_drifts(flip: Truth) -> None:
    found = truth_bounds(planted(flip, 0.25))
    # The quotient of a product by its own factor is within one rounding of the other factor.
    np.testing.assert_allclose(found["energy_drift"], 0.25, rtol=4e-16)
    np.testing.assert_allclose(found["angular_momentum_drift"], 0.5, rtol=4e-16)
    np.testing.assert_array_equal(found["velocity_error"], flip.bounds.velocity_error)


def test_the_drifts_of_the_truth_itself_are_within_its_bounds(flip: Truth) -> None:
    """Two instants, each within the bound of its own, are apart by no more than both bounds."""
    compared, bounds = Comparison(flip, flip.trajectory), truth_bounds(flip)
    for name in ("energy_drift", "angular_momentum_drift"):
        drift = FIGURES[name].compute(compared)
        assert isinstance(drift, np.ndarray)
        assert (drift <= bounds[name] + bounds[name][0]).all()
        assert (bounds[name] > 0).all()


def test_a_bound_that_is_not_known_is_left_out(flip: Truth) -> None:
    unknown = replace(flip, bounds=replace(flip.bounds, energy_error=np.full(3, np.nan)))
    assert "truth_energy_error" not in bounds_of(unknown)
    assert "energy_drift" not in truth_bounds(unknown)
    assert bounds_of(unknown).keys() | {"truth_energy_error"} == bounds_of(flip).keys() == {"truth_error", *BOUNDS}


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ({"energy_drift": 1e-15, "truth_energy_error": 1e-14}, 1e-14),
        ({"energy_drift": 1e-14, "truth_energy_error": 1e-14}, 1e-14),
        ({"energy_drift": 2e-14, "truth_energy_error": 1e-14}, None),
        ({"energy_drift": 0.0, "truth_energy_error": 0.0}, None),
        ({"energy_drift": 1e-15}, None),
        ({"energy_drift": None, "truth_energy_error": 1e-14}, None),
        ({"energy_drift": 1e-15, "truth_energy_error": None}, None),
    ],
)
def test_an_error_within_that_of_the_truth(values: dict[str, float], expected: float | None) -> None:
    assert within_truth(FIGURES["energy_drift"], values) == expected


@pytest.mark.parametrize(("value", "expected"), [(3.5527e-15, 3.56e-15), (1.0, 1.0), (0.0, 0.0), (9.991, 10.0)])
def test_a_rounded_bound_is_a_bound(value: float, expected: float) -> None:
    assert rounded_up(value, 3) == expected
