"""Three particles have six degrees of freedom: their positions keep the distances, and give the coordinates back."""

import math

import numpy as np
import pytest
import sympy as sp
from hypothesis import assume, given
from hypothesis import strategies as st

from bodycheck.reference.chapter import particles

LENGTH = st.floats(0.1, 10)
PLACE = st.floats(-10, 10)
TURN = st.floats(-math.pi, math.pi)
COORDINATES = st.tuples(PLACE, PLACE, PLACE, TURN, st.floats(0, math.pi), TURN).map(np.array)


@st.composite
def triangles(draw: st.DrawFn) -> np.ndarray:
    """Distances d12, d13, d23 of particles that are, at times, nearly in a row."""
    d12, d13 = draw(LENGTH), draw(LENGTH)
    share = draw(st.one_of(st.floats(0.01, 0.99), st.sampled_from([1e-9, 1 - 1e-9])))
    return np.array([d12, d13, abs(d12 - d13) + share * (d12 + d13 - abs(d12 - d13))])


@given(COORDINATES, triangles())
def test_every_choice_of_coordinates_keeps_the_distances(coordinates: np.ndarray, distances: np.ndarray) -> None:
    placed = particles.positions(coordinates, distances)
    # Positions of some 20 m are rounded to 4e-15 m, and the squares of distances up to 20 m change by 40 m times that.
    assert np.abs(particles.residuals(placed, distances)).max() < 1e-12
    np.testing.assert_allclose(particles.separations(placed), distances, rtol=0, atol=3e-14)
    assert placed[0].tolist() == coordinates[:3].tolist()


@given(COORDINATES, triangles())
def test_coordinates_of_the_positions_are_the_coordinates(coordinates: np.ndarray, distances: np.ndarray) -> None:
    _, _, radius = particles.circle(distances)
    alpha, beta = coordinates[3:5]
    level = math.hypot(math.cos(beta), math.sin(alpha) * math.sin(beta))
    # alpha has no meaning along k, v1 jumps where r12 is along i, and gamma has no meaning without a circle.
    assume(math.sin(beta) > 0.1 and level > 0.1 and radius > 0.1)
    found = particles.coordinates(particles.positions(coordinates, distances))
    difference = (found - coordinates)[3:]
    # Positions of some 20 m are rounded to 4e-15 m, seen from 0.1 m and, for gamma, off by a tenth more.
    assert np.abs(np.arctan2(np.sin(difference), np.cos(difference))).max() < 1e-11
    assert found[:3].tolist() == coordinates[:3].tolist()


@given(COORDINATES, triangles())
def test_positions_come_back_from_any_direction(coordinates: np.ndarray, distances: np.ndarray) -> None:
    """Also along i and k, where the coordinates that are found may be others."""
    placed = particles.positions(coordinates, distances)
    again = particles.positions(particles.coordinates(placed), particles.separations(placed))
    _, _, radius = particles.circle(distances)
    # Off the line by r, rounding of the positions turns the particle by 1e-14 / r; nearly in a row, only its square counts.
    np.testing.assert_allclose(again, placed, rtol=0, atol=1e-12 if radius > 0.1 else 1e-6)


@pytest.mark.parametrize("gamma", [0.0, 0.7, -2.0])
@pytest.mark.parametrize(
    ("alpha", "beta", "along"),
    [
        (0.0, math.pi / 2, [1, 0, 0]),
        (math.pi, math.pi / 2, [-1, 0, 0]),
        (math.pi / 2, math.pi / 2, [0, 1, 0]),
        (-math.pi / 2, math.pi / 2, [0, -1, 0]),
        (0.0, 0.0, [0, 0, 1]),
        (0.0, math.pi, [0, 0, -1]),
    ],
)
def test_along_an_axis_the_coordinates_still_come_back(alpha: float, beta: float, along: list[int], gamma: float) -> None:
    coordinates, distances = np.array([0.3, 0.2, 0.1, alpha, beta, gamma]), np.array([2.0, 1.5, 1.0])
    placed = particles.positions(coordinates, distances)
    # Some roundings of squares of distances, of up to 4; of distances of 2; and of angles of up to pi.
    assert np.abs(particles.residuals(placed, distances)).max() < 1e-14
    np.testing.assert_allclose(placed[1] - placed[0], 2.0 * np.array(along), rtol=0, atol=1e-15)
    np.testing.assert_allclose(particles.coordinates(placed), coordinates, rtol=0, atol=1e-14)


@given(st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda v: math.hypot(*v) > 0.1))
def test_normals_are_a_right_handed_triad_with_the_line(vector: tuple[float, ...]) -> None:
    along = np.array(vector) / math.hypot(*vector)
    v1, v2 = particles.normals(along)
    # Some roundings of unit vectors.
    np.testing.assert_allclose(np.stack([along, v1, v2]) @ np.stack([along, v1, v2]).T, np.eye(3), rtol=0, atol=1e-15)
    np.testing.assert_allclose(np.cross(along, v1), v2, rtol=0, atol=1e-15)


def test_where_the_line_is_along_i_the_first_normal_is_along_j_cross_it() -> None:
    v1, v2 = particles.normals(np.array([[1.0, 0.0, 0.0], [-1.0, 1e-16, 0.0]]))
    assert v1.tolist() == [[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]]
    # The second line is off the axis by 1e-16.
    np.testing.assert_allclose(v2, [[0, 1, 0], [0, 1, 0]], rtol=0, atol=1e-15)


def test_circle_is_that_of_the_chapter() -> None:
    """[G 2.3-2.5], worked exactly for the triangle 13, 14, 15 and compared for one that is not so kind."""
    a, b, r = particles.circle(np.array([14.0, 13.0, 15.0]))
    assert (float(a), float(b), float(r)) == (5.0, 9.0, 12.0)
    d12, d13, d23 = distances = [sp.Rational(*each) for each in ((2, 1), (3, 2), (6, 5))]
    exact = (
        (d12**2 + d13**2 - d23**2) / (2 * d12),
        (d12**2 - d13**2 + d23**2) / (2 * d12),
        sp.sqrt(2 * d12**2 * (d13**2 + d23**2) - d12**4 - (d13**2 - d23**2) ** 2) / (2 * d12),
    )
    assert sp.simplify(exact[0] ** 2 + exact[2] ** 2 - d13**2) == 0
    found = particles.circle(np.array([float(each) for each in distances]))
    np.testing.assert_allclose(found, [float(each) for each in exact], rtol=1e-15)


def test_thin_triangles_keep_their_digits() -> None:
    """The radius of a needle against 50 digits: the radicand as printed would be rounding alone."""
    distances = [1.0, 0.5, 0.5 + 1e-15]
    d12, d13, d23 = (sp.Float(each, 60) for each in distances)
    radicand = 2 * d12**2 * (d13**2 + d23**2) - d12**4 - (d13**2 - d23**2) ** 2
    _, _, r = particles.circle(np.array(distances))
    assert float(r) == pytest.approx(float(sp.sqrt(radicand) / (2 * d12)), rel=1e-14, abs=0)


def test_particles_in_a_row_have_no_turn() -> None:
    # 0.3 exceeds 0.1 + 0.2 as decimals, not as the numbers they are read as.
    for distances in ([0.3, 0.1, 0.2], [0.1, 0.3, 0.2], [0.7, 0.1, 0.6], [0.1, 0.2, 0.3]):
        assert float(particles.circle(np.array(distances))[2]) < 1e-8
    row = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 2.0], [0.0, 0.0, 1.0]])
    assert particles.coordinates(row).tolist() == [0.0] * 6


@pytest.mark.parametrize(
    "distances",
    [
        [1.0, 1.0, 2.1],
        [3.0, 1.0, 1.0],
        [1.0, 3.0, 1.0],
        [0.0, 1.0, 1.0],
        [1.0, 1.0, 0.0],
        [-1.0, 1.0, 1.0],
        [1.0, 1.0, math.nan],
        [math.inf, math.inf, 1.0],
    ],
)
def test_distances_that_make_no_triangle_are_refused(distances: list[float]) -> None:
    with pytest.raises(particles.NoTriangle, match=r"d12 = .* make no triangle"):
        particles.positions(np.zeros(6), np.array([[1.0, 1.0, 1.0], distances]))


def test_particles_in_one_place_have_no_coordinates() -> None:
    with pytest.raises(particles.NoTriangle, match=r"d12 = 0\.0"):
        particles.coordinates(np.array([[1.0, 0, 0], [1.0, 0, 0], [0, 1.0, 0]]))


def test_residuals_say_by_how_much() -> None:
    triangle = np.array([[0.0, 0, 0], [3.0, 0, 0], [0, 4.0, 0]])
    # Squares of whole numbers: what a square root in between could round of 25.
    np.testing.assert_allclose(particles.residuals(triangle, np.array([3.0, 3.0, 5.0])), [0, 7, 0], rtol=0, atol=1e-14)


def test_six_coordinates_are_free_and_no_more() -> None:
    """The positions depend on all six, independently: the rank of their derivative is six, of nine."""
    exact = np.array([0.1, 0.2, 0.3, 0.4, 0.5, 0.6])
    steps = 1e-6 * np.vstack([np.eye(6), -np.eye(6)])
    placed = particles.positions(exact + steps, np.array([2.0, 1.5, 1.0])).reshape(12, 9)
    slopes = (placed[:6] - placed[6:]) / 2e-6
    assert np.linalg.matrix_rank(slopes, tol=1e-3) == 6


def test_arrays_of_particles() -> None:
    coordinates, distances = np.linspace(0.1, 1, 24).reshape(4, 6), np.array([2.0, 1.5, 1.0])
    placed = particles.positions(coordinates, distances)
    assert placed.shape == (4, 3, 3)
    np.testing.assert_array_equal(placed[2], particles.positions(coordinates[2], distances))
    # Coordinates of up to 1 from positions of up to 3, by way of angles whose sines are at least 0.3.
    np.testing.assert_allclose(particles.coordinates(placed), coordinates, rtol=0, atol=1e-14)
    many = particles.positions(coordinates[0], np.stack([distances, 2 * distances]))
    assert many.shape == (2, 3, 3)
