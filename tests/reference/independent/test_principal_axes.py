"""The principal axes by the roots of a cubic: for every kind of tensor, to a hundred digits."""

from collections.abc import Sequence

import numpy as np
import pytest

from bodycheck.reference.independent.arithmetic import Matrix, Real, cross, dot, norm, product, scaled, transposed
from bodycheck.reference.independent.border import MP, attitude
from bodycheck.reference.independent.principal_axes import principal_axes

#: Moments of a tensor and how many of them differ; they are given in words where double precision cannot hold them.
KINDS: dict[str, tuple[Sequence[str | float], int]] = {
    "all differ": ((1.0, 2.0, 2.5), 3),
    "in any order": ((2.5, 1.0, 2.0), 3),
    "two equal, oblate": ((1.0, 1.0, 1.7), 2),
    "two equal, prolate": ((0.3, 1.0, 1.0), 2),
    "sphere": ((2.0, 2.0, 2.0), 1),
    "needle": ((1e-12, 1.0, 1.0), 2),
    "nearly two equal": ((1.0, "1.0000000000000000000000000000001", 1.7), 3),
    "nearly a sphere": ((1.0, "1.000000000000000000000000000001", "1.000000000000000000000000000003"), 3),
    "equally far apart": ((1.0, 2.0, 3.0), 3),
}


def frame(seed: int) -> Matrix:
    """The rows of a rotation matrix."""
    w, x, y, z = np.random.default_rng(seed).normal(size=4).tolist()
    rows = attitude((w, x, y, z))
    first = scaled(rows[0], 1 / norm(rows[0]))
    along = dot(first, rows[1])
    across = [b - along * a for a, b in zip(first, rows[1], strict=True)]
    second = scaled(across, 1 / norm(across))
    return first, second, cross(first, second)


def joined(axes: Matrix, moments: Sequence[Real]) -> Matrix:
    """The tensor with some moments about axes, which are the rows of a matrix."""
    return product(transposed(axes), [scaled(axis, moment) for axis, moment in zip(axes, moments, strict=True)])


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(("given", "different"), KINDS.values(), ids=KINDS)
def test_the_tensor_is_that_of_its_moments_and_axes(given: Sequence[str | float], different: int, seed: int) -> None:
    exact = [MP.mpf(moment) for moment in given]
    tensor = joined(frame(seed), exact)
    moments, axes = principal_axes(tensor)
    # All three are rounded some tens of times in a hundred digits.
    limit = MP.mpf(10) ** -97
    assert all(abs(one - other) <= limit for one, other in zip(moments, sorted(exact), strict=True))
    assert len(set(moments)) == different
    back = joined(axes, moments)
    assert max(abs(back[i][j] - tensor[i][j]) for i in range(3) for j in range(3)) <= limit
    unit = product(axes, transposed(axes))
    assert max(abs(unit[i][j] - (i == j)) for i in range(3) for j in range(3)) <= limit
    assert dot(axes[0], cross(axes[1], axes[2])) > 0


def test_a_diagonal_tensor_keeps_every_digit() -> None:
    tensor = [[MP.mpf(0)] * 3 for _ in range(3)]
    for axis, moment in enumerate(("2e-300", "1e-310", "1e-300")):
        tensor[axis][axis] = MP.mpf(moment)
    moments, axes = principal_axes(tensor)
    assert list(moments) == [tensor[axis][axis] for axis in (1, 2, 0)]
    assert [[int(component) for component in axis] for axis in axes] == [[0, 1, 0], [0, 0, 1], [1, 0, 0]]


def test_a_tensor_with_one_product_of_inertia_is_turned_about_one_axis() -> None:
    one, zero = MP.mpf(1), MP.mpf(0)
    moments, axes = principal_axes([[one, one / 2, zero], [one / 2, one, zero], [zero, zero, 2 * one]])
    half = MP.sqrt(one / 2)
    expected = [(half, -half, zero), (half, half, zero), (zero, zero, one)]
    assert all(abs(one - other) <= 1e-98 for one, other in zip(moments, (0.5, 1.5, 2.0), strict=True))
    for axis, direction in zip(axes, expected, strict=True):
        assert abs(abs(dot(axis, direction)) - 1) <= 1e-98
