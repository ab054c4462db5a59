"""Inertia against its defining sums and integrals [G 2.29], and the ways of putting bodies together against one another."""

import itertools

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from bodycheck.reference.exact.axes import principal_axes
from bodycheck.reference.exact.inertia import joined, particle, solid
from bodycheck.reference.exact.numbers import doubles, real
from bodycheck.reference.inertia import (
    MassProperties,
    angular_momentum,
    inertia_tensor,
    mesh,
    principal_moments,
    satisfies_triangle_inequality,
)
from bodycheck.reference.scene import Body, Brick, Cylinder, Ellipsoid, Particle, Quaternion, Shape, Solid, Sphere, Vector

INSIDE = {
    Brick((0.1, 0.3, 0.2)): lambda x, y, z: (abs(x) < 0.1) & (abs(y) < 0.3) & (abs(z) < 0.2),
    Ellipsoid((0.1, 0.3, 0.2)): lambda x, y, z: (x / 0.1) ** 2 + (y / 0.3) ** 2 + (z / 0.2) ** 2 < 1,
    Cylinder(0.2, 0.3): lambda x, y, z: (x * x + y * y < 0.04) & (abs(z) < 0.3),
    Sphere(0.3): lambda x, y, z: x * x + y * y + z * z < 0.09,
}


@pytest.mark.parametrize("shape", INSIDE, ids=lambda shape: type(shape).__name__)
def test_moments_are_the_sums_over_the_volume(shape: Shape) -> None:
    grid = (np.arange(180) + 0.5) / 180 * 0.6 - 0.3
    x, y, z = np.meshgrid(grid, grid, grid, indexing="ij")
    inside = INSIDE[shape](x, y, z)
    x, y, z = x[inside], y[inside], z[inside]
    summed = [np.mean(q) * 2.0 for q in (y * y + z * z, x * x + z * z, x * x + y * y)]
    # 90 cells a half-length: curved surfaces are off by parts in a thousand.
    np.testing.assert_allclose(principal_moments(shape, 2.0), summed, rtol=5e-3)


@pytest.mark.parametrize(
    ("moments", "exists"),
    [((1.0, 1.0, 2.0), True), ((1.0, 1.0, 2.0 * (1 + 1e-15)), True), ((1.0, 1.0, 2.001), False), ((3.0, 1.0, 1.0), False)],
)
def test_triangle_inequality(moments: tuple[float, float, float], exists: bool) -> None:
    assert satisfies_triangle_inequality(moments) is exists


VECTOR = st.lists(st.floats(-2, 2), min_size=3, max_size=3)
TURN = st.lists(st.floats(-1, 1), min_size=4, max_size=4).filter(lambda q: float(np.linalg.norm(q)) > 0.1)


def turned(quaternion: list[float]) -> np.ndarray:
    return Rotation.from_quat(quaternion, scalar_first=True).as_matrix()


def properties(*parts: Solid | Particle) -> MassProperties:
    """Mass properties of a body of parts, in doubles."""
    made = joined([solid(part) if isinstance(part, Solid) else particle(part) for part in parts])
    xx, yy, zz, xy, xz, yz = doubles(made.tensor)
    tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return MassProperties(float(made.mass), np.array(doubles(made.centre)), tensor)


def test_particles_are_the_sum_over_the_particles() -> None:
    masses, positions = np.array([1.0, 2.0, 3.0]), np.array([[0, 0, 1.0], [1, 0, 0], [0, 2, 0]])
    made = properties(Particle(1.0, (0.0, 0.0, 1.0)), Particle(2.0, (1.0, 0.0, 0.0)), Particle(3.0, (0.0, 2.0, 0.0)))
    r = positions - made.centre
    summed = sum(m * (x @ x * np.eye(3) - np.outer(x, x)) for m, x in zip(masses, r, strict=True))
    # Sums of some products of whole numbers and sixths: some roundings of numbers of up to 10.
    np.testing.assert_allclose(masses @ r, 0, atol=1e-15)
    np.testing.assert_allclose(made.inertia, summed, atol=1e-15)


def test_a_cube_is_eight_cubes() -> None:
    whole = properties(Solid(Brick((1.0, 1.0, 1.0)), 8.0))
    eight = properties(*(Solid(Brick((0.5, 0.5, 0.5)), 1.0, (x, y, z)) for x, y, z in itertools.product((-0.5, 0.5), repeat=3)))
    assert eight.mass == whole.mass
    # Powers of two, and thirds: a rounding or none.
    np.testing.assert_allclose(eight.inertia, whole.inertia, atol=1e-15)


@given(TURN, VECTOR, st.tuples(*[st.floats(0.1, 1.0)] * 3))
def test_a_turned_and_shifted_brick_is_the_mesh_of_its_corners(
    q: list[float], shift: list[float], sizes: tuple[float, ...]
) -> None:
    a, b, c = sizes
    corners = np.array(list(itertools.product((-a, a), (-b, b), (-c, c)))) @ turned(q).T + shift
    hull = ConvexHull(corners)
    first, second, third = (corners[hull.simplices[:, n]] for n in range(3))
    outward = (np.cross(second - first, third - first) * hull.equations[:, :3]).sum(axis=1)
    triangles = np.where(outward[:, None] > 0, hull.simplices, hull.simplices[:, ::-1])
    x, y, z = shift
    made, expected = (
        mesh(corners, triangles, 3.0),
        properties(Solid(Brick((a, b, c)), 3.0, (x, y, z), (q[0], q[1], q[2], q[3]))),
    )
    np.testing.assert_allclose(made.centre, expected.centre, atol=1e-13)
    np.testing.assert_allclose(made.inertia, expected.inertia, atol=1e-13)
    # Which side of all triangles is out makes no difference, where they agree on it.
    np.testing.assert_allclose(mesh(corners, triangles[:, ::-1], 3.0).inertia, made.inertia, atol=1e-13)


def test_a_surface_that_encloses_nothing_is_refused() -> None:
    with pytest.raises(ValueError, match="encloses no volume"):
        mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2], [2, 1, 0]], 1.0)


def in_doubles(tensor: np.ndarray) -> tuple[Vector, Quaternion]:
    """Principal moments and axes of a tensor, in doubles."""
    xx, yy, zz, xy, xz, yz = (real(tensor[i, j]) for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)))
    moments, axes = principal_axes((xx, yy, zz, xy, xz, yz))
    (a, b, c), (w, x, y, z) = doubles(moments), doubles(axes)
    return (a, b, c), (w, x, y, z)


@given(TURN, st.tuples(*[st.floats(0.5, 0.9)] * 3))
@example([0.0, 1.0, 1.0, 1.0], (0.5, 0.75, 0.75))
def test_principal_axes_undo_a_turn(q: list[float], moments: tuple[float, float, float]) -> None:
    tensor = turned(q) @ np.diag(moments) @ turned(q).T
    tensor = (tensor + tensor.T) / 2
    found, axes = in_doubles(tensor)
    np.testing.assert_allclose(sorted(found), sorted(moments), atol=1e-14)
    np.testing.assert_allclose(inertia_tensor(Body(1.0, found, axes=axes)), tensor, atol=1e-14)
    assert np.linalg.norm(axes) == pytest.approx(1, abs=1e-15)
    # Of the 24 right-handed labellings the one that turns least: by at most 62.8 degrees, the covering radius of the cube.
    assert 2 * np.arccos(min(1.0, axes[0])) <= np.radians(62.9)


def test_a_diagonal_tensor_keeps_its_axes() -> None:
    assert in_doubles(np.diag([3.0, 1.0, 2.5])) == ((3.0, 1.0, 2.5), (1.0, 0.0, 0.0, 0.0))


@given(TURN, VECTOR)
def test_angular_momentum_is_the_tensor_times_the_rates(q: list[float], rates: list[float]) -> None:
    w, x, y, z = (q / np.linalg.norm(q)).tolist()
    body = Body(1.0, (0.1, 0.2, 0.25), axes=(w, x, y, z))
    # Two turns there and back of vectors of length 1 and a tensor of 0.3: some ten roundings.
    np.testing.assert_allclose(angular_momentum(body, np.array(rates)), inertia_tensor(body) @ rates, atol=1e-14)
