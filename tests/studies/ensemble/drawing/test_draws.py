"""What is drawn for the members of an ensemble. Wherever possible a property is exact: nets, slices, lengths."""

import os
import subprocess
import sys
import warnings
from hashlib import sha256

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.stats import norm
from scipy.stats.qmc import Sobol

from bodycheck.casefile.case import parse
from bodycheck.casefile.distributions import Ensemble
from bodycheck.reference.kinematics import multiply
from bodycheck.reference.trajectory import Array
from bodycheck.studies.ensemble.drawing import draws
from bodycheck.studies.ensemble.drawing.draws import HALF_CELL, SEQUENCES, points
from tests.support.ensemble_texts import BRICK, attitude, choice, ensemble_of, log_uniform, normal, sphere, uniform

#: Points of each sequence that make a net, as a power of 2, and all of them together.
POWER = 8
NET = SEQUENCES << POWER

ALL = (
    uniform("body.mass", 1, 3),
    log_uniform("body.semi_axes", [0.01, 0.1, 0.1], [10, 1, 2]),
    normal("initial.velocity", [1, 2, 3], [0.1, 0, 10]),
    sphere("initial.angular_velocity", 5),
    attitude(),
    choice("scene.gravity", [0, 1.62, 9.81]),
    choice("initial.position", [[0, 0, 0], [1, 2, 3]]),
    uniform("run.duration", 0.5, 1.5),
)


def ensemble(*vary: str, seed: int = 1) -> Ensemble:
    made = parse(ensemble_of(BRICK, *vary).replace("seed = 1", f"seed = {seed}"), "f").ensemble
    assert made is not None
    return made


def drawn(table: str, first: int = 0, count: int = NET) -> Array:
    """What is drawn where one thing varies."""
    (values,) = draws.values(ensemble(table), first, count).values()
    return values


def counts(of_a_sequence: Array, bins: int) -> NDArray[np.int64]:
    """How many numbers between 0 and 1 (n,) are in each of so many equal bins."""
    return np.bincount((of_a_sequence * bins).astype(int), minlength=bins)


def evenly(fractions: Array) -> bool:
    """Whether each sequence has exactly one of its numbers (n,) between 0 and 1 in each of n / 16 equal bins."""
    bins = len(fractions) // SEQUENCES
    return all((counts(fractions[sequence::SEQUENCES], bins) == 1).all() for sequence in range(SEQUENCES))


@pytest.mark.parametrize("block", [0, 1, 1221])
def test_each_sequence_is_a_net_in_every_dimension(block: int) -> None:
    """Sobol: of 2^m points from a multiple of 2^m on, one is in each interval of 2^-m, and in the first two dimensions one in
    each rectangle of that area."""
    cube = points(1, 7, block * NET, NET)
    assert all(evenly(cube[:, dimension]) for dimension in range(7))
    for width in range(POWER + 1):
        columns, rows = 1 << width, 1 << (POWER - width)
        for sequence in range(SEQUENCES):
            x, y = cube[sequence::SEQUENCES, :2].T
            assert (counts(((x * columns).astype(int) + y) / columns, columns * rows) == 1).all()


def test_coordinates_are_in_the_middle_of_cells_and_never_0_or_1() -> None:
    cube = points(3, 5, 0, NET)
    cells = (cube - HALF_CELL) * 2.0**52
    assert (cells == np.floor(cells)).all()
    assert 0 < cube.min() < cube.max() < 1


def test_the_points_are_those_of_scipy() -> None:
    """Which has no other way to points far along a sequence of so many bits than to make all before them."""
    seeds = [np.random.SeedSequence(7, spawn_key=(number,)) for number in range(SEQUENCES)]
    theirs = [Sobol(3, bits=52, seed=np.random.default_rng(seed)).random(1 << POWER) for seed in seeds]
    assert np.array_equal(points(7, 3, 0, NET).reshape(-1, SEQUENCES, 3), np.stack(theirs, axis=1) + HALF_CELL)


def test_the_sequences_are_scrambled_independently() -> None:
    """No two sequences and no two seeds share a coordinate, and over many dimensions the points of two are not correlated."""
    first = points(1, 100, 0, SEQUENCES)
    assert len(np.unique(first)) == first.size
    assert not np.intersect1d(points(1, 5, 0, SEQUENCES), points(2, 5, 0, SEQUENCES)).size
    correlations = np.corrcoef(first) - np.eye(SEQUENCES)
    # Each of 120 has a standard deviation of 1 / sqrt(100) = 0.1; that one of them is five of these has a probability of 1e-4.
    assert np.abs(correlations).max() < 0.5


def test_a_member_is_the_same_alone_in_any_slice_and_in_the_whole() -> None:
    made = ensemble(*ALL)
    whole = draws.values(made, 81_000, 500)
    for first, count in ((81_234, 1), (81_000, 1), (81_007, 16), (81_003, 31), (81_017, 483)):
        part = draws.values(made, first, count)
        assert list(part) == list(whole)
        for key, values in part.items():
            assert np.array_equal(values, whole[key][first - 81_000 : first - 81_000 + count]), key


def test_more_members_change_no_member_and_another_seed_all() -> None:
    few, many = draws.values(ensemble(*ALL), 0, 20), draws.values(ensemble(*ALL), 0, 3000)
    assert all(np.array_equal(values, many[key][:20]) for key, values in few.items())
    other = draws.values(ensemble(*ALL, seed=2), 0, 20)
    assert not np.intersect1d(few["body.mass"], other["body.mass"]).size


def test_the_vector_instructions_of_the_processor_change_nothing() -> None:
    """NumPy has a sine of doubles for each set of them, with other last digits."""
    code = (
        "import sys, hashlib\nfrom bodycheck.casefile.case import parse\nfrom bodycheck.studies.ensemble.drawing import draws\n"
        "values = draws.values(parse(sys.stdin.read(), 'f').ensemble, 0, 20000)\n"
        "print({key: hashlib.sha256(array.tobytes()).hexdigest() for key, array in values.items()})"
    )
    vectors = " ".join(np.show_config(mode="dicts")["SIMD Extensions"].get("found", []))
    without = os.environ | {"NPY_DISABLE_CPU_FEATURES": vectors}
    text = ensemble_of(BRICK, *ALL)
    done = subprocess.run([sys.executable, "-c", code], input=text, env=without, capture_output=True, text=True, check=True)
    here = draws.values(ensemble(*ALL), 0, 20000)
    assert done.stdout.strip() == repr({key: sha256(array.tobytes()).hexdigest() for key, array in here.items()})


def test_shapes_and_order_are_those_of_the_file() -> None:
    shapes = {key: values.shape for key, values in draws.values(ensemble(*ALL), 5, 7).items()}
    assert list(shapes.items()) == [
        *(("body.mass", (7,)), ("body.semi_axes", (7, 3)), ("initial.velocity", (7, 3)), ("initial.angular_velocity", (7, 3))),
        *(("initial.quaternion", (7, 4)), ("scene.gravity", (7,)), ("initial.position", (7, 3)), ("run.duration", (7,))),
    ]


def test_drawing_warns_of_nothing() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for count in (1, 2, 3, 15, 16, 17, 1000):
            draws.values(ensemble(*ALL), 0, count)


def test_uniform() -> None:
    values = drawn(uniform("initial.velocity.0", -2, 6))
    assert evenly((values + 2) / 8)
    assert -2 < values.min() < values.max() < 6


def test_log_uniform() -> None:
    values = drawn(log_uniform("body.mass", 1e-6, 1e2))
    assert evenly(np.log(values * 1e6) / np.log(1e8))
    assert 1e-6 <= values.min() < values.max() <= 1e2


def test_normal() -> None:
    values = drawn(normal("initial.position", [1, 0, -5], [2, 0, 0.1]))
    assert evenly(norm.cdf((values[:, 0] - 1) / 2))
    assert evenly(norm.cdf((values[:, 2] + 5) / 0.1))
    assert (values[:, 1] == 0).all(), "a standard deviation of 0"


def test_components_are_independent() -> None:
    """The first two make a net: each quarter of the plane has the same number of points."""
    values = drawn(normal("initial.velocity", 0, 1))
    for sequence in range(SEQUENCES):
        x, y, _ = values[sequence::SEQUENCES].T
        quarters = [((x > 0) == one) & ((y > 0) == other) for one in (False, True) for other in (False, True)]
        assert [quarter.sum() for quarter in quarters] == [1 << POWER - 2] * 4


def test_sphere() -> None:
    values = drawn(sphere("initial.velocity", 5.0))
    # The squares are rounded, and a root halves the error: a few roundings of 1e-16.
    np.testing.assert_allclose(np.sqrt((values**2).sum(axis=1)), 5.0, rtol=1e-15)
    assert evenly((values[:, 2] / 5 + 1) / 2), "all heights are equally probable"
    assert evenly(np.arctan2(values[:, 1], values[:, 0]) / (2 * np.pi) % 1), "and all longitudes"


def test_attitude() -> None:
    """The square of the distance from a plane is uniform, and so are the angles in both planes."""
    q = drawn(attitude())
    np.testing.assert_allclose((q**2).sum(axis=1), 1, rtol=1e-15)  # a few roundings
    assert evenly(q[:, 0] ** 2 + q[:, 3] ** 2)
    assert evenly(np.arctan2(q[:, 3], q[:, 0]) / (2 * np.pi) % 1)
    assert evenly(np.arctan2(q[:, 1], q[:, 2]) / (2 * np.pi) % 1)


def test_no_attitude_is_preferred() -> None:
    """The second moments of uniform unit quaternions are 1/4 in every direction, and a turn changes nothing."""
    q = drawn(attitude(), 0, 1 << 14)
    turned = multiply(np.tile([0.5, 0.5, -0.5, 0.5], (len(q), 1)), q)
    for values in (q, turned):
        # Random points would give 0.25 / sqrt(2^14) = 2e-3; Sobol points are more even.
        np.testing.assert_allclose(values.T @ values / len(q), np.eye(4) / 4, atol=2e-3)
        np.testing.assert_allclose((values**4).mean(axis=0), 1 / 8, atol=2e-3)


def test_choice() -> None:
    values = drawn(choice("body.mass", [3, 1, 2, 1]))
    for sequence in range(SEQUENCES):
        found = dict(zip(*np.unique(values[sequence::SEQUENCES], return_counts=True), strict=True))
        assert found == {1.0: 1 << POWER - 1, 2.0: 1 << POWER - 2, 3.0: 1 << POWER - 2}
    vectors = drawn(choice("initial.velocity", [[1, 2, 3], [4, 5, 6], [7, 8, 9]]), 0, 3000)
    found = {tuple(vector): int((vectors == vector).all(axis=1).sum()) for vector in np.unique(vectors, axis=0).tolist()}
    assert set(found) == {(1, 2, 3), (4, 5, 6), (7, 8, 9)}
    # Each sequence misses a third of its points by less than 2, except where it ends: 16 sequences by less than 2 each.
    assert all(abs(number - 1000) < 2 * SEQUENCES for number in found.values())


def test_a_choice_is_as_probable_in_the_first_as_in_the_last_value() -> None:
    values = drawn(choice("body.mass", [float(k + 1) for k in range(1000)]), 0, 16 * 1024)
    assert set(values) == {float(k + 1) for k in range(1000)}
