"""The numbers that errors depend on, in made ensembles whose errors depend on known ones."""

from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from bodycheck.studies.ensemble.findings import maps
from bodycheck.studies.ensemble.findings.analysis import analyse
from bodycheck.studies.ensemble.findings.sensitivity import FAILURE, RELEVANT, dependences, first_order, numbers, strongest
from tests.support.ensembles import EULER, RK4, made

MEMBERS = 8000


def drawn() -> dict[str, np.ndarray]:
    """Seven numbers: three of a spin, a mass, three of a velocity that nothing depends on."""
    random = np.random.default_rng(11)
    spin, velocity = random.normal(0, 3, (3, MEMBERS)), random.normal(0, 1, (3, MEMBERS))
    vectors = {
        f"initial.{key}.{i}": values[i]
        for key, values in (("angular_velocity", spin), ("velocity", velocity))
        for i in range(3)
    }
    return vectors | {"body.mass": random.uniform(1, 2, MEMBERS), "body.semi_axes.0": np.full(MEMBERS, 0.1)}


def test_the_number_that_matters_is_found(tmp_path: Path) -> None:
    """The errors of one method grow with the mass, those of the other with the square of a component of the spin."""
    given = drawn()
    noise = np.random.default_rng(12).normal(0, 0.1, MEMBERS)
    runs = {
        EULER: {"attitude_error": 10.0 ** (3 * given["body.mass"] + noise)},
        RK4: {"attitude_error": 1e-9 * np.exp(given["initial.angular_velocity.1"] ** 2 / 9 + noise)},
    }
    ensemble = made(tmp_path, given, runs)
    found = {(one.method, one.number): one for one in dependences(ensemble, numbers(ensemble), ("attitude_error",))}
    assert found[0, "body.mass"].share > 0.95
    assert found[0, "body.mass"].rank_correlation > 0.95
    assert found[1, "initial.angular_velocity.1"].share > 0.9
    assert abs(found[1, "initial.angular_velocity.1"].rank_correlation) < 0.05  # it falls, and then it rises
    # The length of the spin says something of its component; nothing else does, up to chance, of the order of 1 / 8000.
    related = {(0, "body.mass"), (1, "initial.angular_velocity.1"), (1, "|initial.angular_velocity|")}
    assert all(one.share < RELEVANT for key, one in found.items() if key not in related)
    assert "body.semi_axes.0" not in {number for _, number in found}


def test_lengths_of_vectors_are_among_the_numbers(tmp_path: Path) -> None:
    given = drawn()
    spin = np.sqrt(sum(given[f"initial.angular_velocity.{i}"] ** 2 for i in range(3)))
    ensemble = made(tmp_path, given, {EULER: {"attitude_error": 1e-3 * spin**2}})
    found = dependences(ensemble, numbers(ensemble), ("attitude_error",))
    assert strongest(found)[0] == "|initial.angular_velocity|"
    length = next(one for one in found if one.number == "|initial.angular_velocity|")
    assert length.rank_correlation == pytest.approx(1.0)
    assert np.array_equal(numbers(ensemble, MEMBERS, ["|initial.angular_velocity|"])["|initial.angular_velocity|"], spin)


def test_the_rank_correlation_is_that_of_scipy(tmp_path: Path) -> None:
    given = drawn()
    errors = np.exp(given["body.mass"] + np.random.default_rng(13).normal(0, 1, MEMBERS))
    errors[::7] = np.nan
    ensemble = made(tmp_path, given, {EULER: {"attitude_error": errors}})
    there = np.isfinite(errors)
    for one in dependences(ensemble, numbers(ensemble), ("attitude_error",)):
        if one.number in given:
            wanted = stats.spearmanr(given[one.number][there], errors[there]).statistic
            assert one.rank_correlation == pytest.approx(wanted, abs=1e-12)


def test_shares_of_a_linear_model() -> None:
    """y = 3 a + b with equal variances: nine tenths are from a. A bin of a 32nd of the range loses 1e-3 of them."""
    random = np.random.default_rng(14)
    a, b = random.random((2, 40_000))
    shares = [first_order(stats.rankdata(x), 3 * a + b) for x in (a, b, random.random(40_000))]
    assert shares == pytest.approx([0.9, 0.1, 0.0], abs=0.01)  # three standard errors of the last two are 0.01


def test_failures_in_one_region_are_found_and_mapped(tmp_path: Path) -> None:
    given = drawn()
    wrong = (given["body.mass"] > 1.9) & (given["initial.angular_velocity.2"] > 3)
    columns = {"attitude_error": np.ones(MEMBERS), "status": np.where(wrong, "diverged", "ok").tolist()}
    ensemble = made(tmp_path, given, {EULER: columns})
    analysis = analyse(ensemble)
    of_failures = [one for one in analysis.dependences if one.figure == FAILURE]
    assert set(strongest(of_failures)) == {"body.mass", "initial.angular_velocity.2"}
    (drawn_map,) = analysis.maps
    assert drawn_map.figure == FAILURE
    assert {drawn_map.x, drawn_map.y} == {"body.mass", "initial.angular_velocity.2"}
    assert drawn_map.members[0].sum() == MEMBERS
    failed = np.nansum(drawn_map.values[0] * drawn_map.members[0])
    assert failed == pytest.approx(np.count_nonzero(wrong))
    in_corner = drawn_map.x_edges[:-1] > 1.9 if drawn_map.x == "body.mass" else drawn_map.x_edges[:-1] > 3
    assert np.nansum(drawn_map.values[0][:, in_corner] * drawn_map.members[0][:, in_corner]) > 0.7 * failed


def test_maps_of_wide_numbers_have_logarithmic_cells(tmp_path: Path) -> None:
    random = np.random.default_rng(15)
    given = {"body.mass": 10.0 ** random.uniform(-3, 3, MEMBERS), "scene.gravity": random.uniform(5, 10, MEMBERS)}
    ensemble = made(tmp_path, given, {EULER: {"attitude_error": given["body.mass"]}})
    drawn_map = maps.made(ensemble, "attitude_error", ("body.mass", "scene.gravity"), [0])
    ratios = drawn_map.x_edges[1:] / drawn_map.x_edges[:-1]
    assert ratios == pytest.approx(np.full(len(ratios), ratios[0]))
    middles = np.sqrt(drawn_map.x_edges[1:] * drawn_map.x_edges[:-1])
    known = ~np.isnan(drawn_map.values[0])
    # A mean of a cell is a value of the cell, which is a factor of 10^(6/24) wide.
    assert (np.abs(np.log10(drawn_map.values[0] / middles))[known] <= 0.125 + 1e-9).all()
