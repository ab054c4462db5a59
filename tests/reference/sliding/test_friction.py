"""The friction of a flat face against adaptive quadrature, through its limits, and against what mechanics demands of it."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.integrate import dblquad, quad_vec

from bodycheck.reference.errors import NotFlat, WouldTip
from bodycheck.reference.planar import resting_height
from bodycheck.reference.scene import Body, Brick, Cylinder, Ellipsoid, Plane, Sphere
from bodycheck.reference.sliding.direction_moments import FAR_RADII, NEAR_CENTRE_RADII, direction_moments
from bodycheck.reference.sliding.footprint import Disk, Footprint, Points, Polygon, load_moments, nearness, reach, rectangle
from bodycheck.reference.sliding.friction import (
    balanced_friction,
    balanced_pressure,
    decoupled_friction,
    footprint_of,
    friction,
    refuse_tipping,
    uniform_friction,
)
from bodycheck.reference.trajectory import Array

#: What a dozen roundings make of sums that cancel up to (1 + FAR)^2-fold, relative to the size of their terms: 1e-14, and room
#: for quadrature.
ROUNDING = 1e-12

RECTANGLE = Polygon(rectangle(0.1, 0.2))
DISK = Disk(0.1)
SKEW = Polygon(np.array([[0.3, -0.1], [0.2, 0.25], [-0.15, 0.2], [-0.25, -0.1], [0.0, -0.2]]))
CORNERS = Points(rectangle(0.1, 0.2))
FOOTPRINTS = (RECTANGLE, DISK, SKEW, CORNERS)

#: From a parameter in 0..1 to a point (2,) of the boundary and its derivative (2,).
Curve = Callable[[float], tuple[Array, Array]]


def boundary(footprint: Polygon | Disk) -> list[Curve]:
    if isinstance(footprint, Polygon):
        vertices = footprint.vertices
        pairs = zip(vertices, np.roll(vertices, -1, axis=0), strict=True)
        return [lambda s, a=a, b=b: (a + s * (b - a), b - a) for a, b in pairs]

    def rim(s: float) -> tuple[Array, Array]:
        c, d = math.cos(2 * math.pi * s), math.sin(2 * math.pi * s)
        return footprint.radius * np.array([c, d]), 2 * math.pi * footprint.radius * np.array([-d, c])

    return [rim]


def by_quadrature(footprint: Polygon | Disk, v1: float, v2: float, w: float) -> Array:
    """The moments of the direction of sliding over the fan from a point to the boundary, adaptively along the boundary.

    From the instantaneous centre, where that is not far, because the direction does not change along the rays from there.
    """
    centre = np.array([-v2, v1]) / w
    apex = centre if np.hypot(*centre) < FAR_RADII * reach(footprint) else np.zeros(2)
    nodes, weights = np.polynomial.legendre.leggauss(20)
    nodes, weights = (1 + nodes) / 2, weights / 2

    def along(curve: Curve, s: float) -> Array:
        point, tangent = curve(s)
        ray = point - apex
        r = apex + nodes[:, None] * ray
        u = np.stack([v1 - w * r[:, 1], v2 + w * r[:, 0]], axis=-1)
        e = u / np.hypot(u[:, 0], u[:, 1])[:, None]
        moment = r[:, 0] * e[:, 1] - r[:, 1] * e[:, 0]
        areas = weights * nodes * (ray[0] * tangent[1] - ray[1] * tangent[0])
        return np.asarray((areas[:, None] * np.column_stack([np.ones(len(r)), r])).T @ np.column_stack([e, moment]))

    size = float(load_moments(footprint)[0, 0])
    total = np.zeros((3, 3))
    for curve in boundary(footprint):
        part, _ = quad_vec(lambda s, curve=curve: along(curve, s), 0, 1, epsabs=1e-15 * size, epsrel=1e-14, limit=2000)
        total += part
    return total


def relative(footprint: Footprint, moments: Array) -> Array:
    """Moments (3, 3) over the size that they can have at most."""
    power = reach(footprint) ** np.array([[0, 0, 1], [1, 1, 2], [1, 1, 2]])
    return np.asarray(moments / (load_moments(footprint)[0, 0] * power))


@st.composite
def polygons(draw: st.DrawFn) -> Polygon:
    """Convex polygons: corners on an ellipse, no two closer than 0.2 rad, about a point inside."""
    steps = np.array(draw(st.lists(st.floats(0.2, 1.0), min_size=3, max_size=7)))
    angles = draw(st.floats(0, 6)) + np.cumsum(steps) / steps.sum() * 2 * np.pi
    vertices = np.column_stack([np.cos(angles), draw(st.floats(0.2, 1.0)) * np.sin(angles)])
    return Polygon((vertices - vertices.mean(axis=0)) * draw(st.sampled_from([0.01, 0.3, 5.0])))


@settings(max_examples=30)
@given(polygons(), st.floats(0, 6.28), st.floats(-3, 2), st.sampled_from([-1.0, 1.0]))
def test_polygons_against_adaptive_quadrature(polygon: Polygon, heading: float, log_distance: float, sign: float) -> None:
    distance = 10**log_distance * reach(polygon)
    v1, v2, w = 3 * distance * math.cos(heading), 3 * distance * math.sin(heading), 3 * sign
    exact = direction_moments(polygon)(v1, v2, w)
    np.testing.assert_allclose(relative(polygon, exact - by_quadrature(polygon, v1, v2, w)), 0, atol=ROUNDING)


@pytest.mark.parametrize("distance", [1e-9, 0.3, 0.4999, 0.5001, 0.999, 1.0, 1.001, 2.0, 3.99, 4.01, 60.0])
def test_a_disk_against_adaptive_quadrature(distance: float) -> None:
    v1, v2, w = 0.6 * distance * DISK.radius, -0.8 * distance * DISK.radius, -1.0
    exact = direction_moments(DISK)(v1, v2, w)
    np.testing.assert_allclose(relative(DISK, exact - by_quadrature(DISK, v1, v2, w)), 0, atol=ROUNDING)


def test_a_rectangle_against_quadrature_in_cartesian_coordinates() -> None:
    """Force and torque as they are defined, by another adaptive rule, the centre of the spin outside the rectangle."""
    v1, v2, w, mu, load = 0.5, -0.2, 1.3, 0.4, 7.0

    def integral(component: Callable[[float, float, float, float], float]) -> float:
        def integrand(y: float, x: float) -> float:
            u1, u2 = v1 - w * y, v2 + w * x
            return -mu * load / 0.08 * component(x, y, u1, u2) / math.hypot(u1, u2)

        return float(dblquad(integrand, -0.1, 0.1, -0.2, 0.2, epsabs=1e-14)[0])

    expected = [
        integral(lambda x, y, u1, u2: u1),
        integral(lambda x, y, u1, u2: u2),
        integral(lambda x, y, u1, u2: x * u2 - y * u1),
    ]
    np.testing.assert_allclose(uniform_friction(RECTANGLE, mu, load)(v1, v2, w), expected, rtol=ROUNDING, atol=0)


@pytest.mark.parametrize("footprint", FOOTPRINTS)
@pytest.mark.parametrize("limit", [FAR_RADII, NEAR_CENTRE_RADII])
def test_no_jump_where_the_method_changes(footprint: Footprint, limit: float) -> None:
    moments = direction_moments(footprint)
    for heading in np.linspace(0, 6, 7):
        for sign in (-1, 1):
            speed = limit * reach(footprint) * np.array([math.cos(heading), math.sin(heading)])
            below, above = (moments(*(factor * speed).tolist(), sign) for factor in (1 - 1e-15, 1 + 1e-15))
            np.testing.assert_allclose(relative(footprint, above - below), 0, atol=1e-13)  # the requirement is 1e-12


@pytest.mark.parametrize("footprint", FOOTPRINTS)
def test_the_limits_of_no_spin_and_of_no_velocity_are_reached_evenly(footprint: Footprint) -> None:
    """The distance from a limit falls in proportion to what is left, down to nothing: no method gives up before."""
    moments = direction_moments(footprint)
    translation, spin = moments(0.6, 0.8, 0.0), moments(0.0, 0.0, 2.0)
    for small in 10.0 ** -np.arange(2, 18, 3):
        left = relative(footprint, moments(0.6, 0.8, small / reach(footprint)) - translation)
        assert np.abs(left).max() < 2 * small + 1e-15
        turning = relative(footprint, moments(0.6 * small, 0.8 * small, 2 / reach(footprint)) - spin)
        assert np.abs(turning).max() < 20 * small + 1e-14  # along an ill-shaped face the centre moves the farther
    # Relative accuracy of a torque that vanishes with the spin: over a disk it is w R^2/(4 v) times mu N.
    torque = uniform_friction(DISK, 1.0, 1.0)(0.0, 1.0, 1e-9)[2]
    assert torque == pytest.approx(-1e-9 * 0.1**2 / 4, rel=1e-12, abs=0)


def test_nothing_at_rest() -> None:
    for footprint in FOOTPRINTS:
        assert uniform_friction(footprint, 0.5, 10.0)(0.0, 0.0, 0.0) == (0, 0, 0)
        assert balanced_friction(footprint, 0.5, 10.0, 0.01)(0.0, 0.0, 0.0) == (0, 0, 0)
    assert decoupled_friction(RECTANGLE, 0.5, 10.0)(0.0, 0.0, 0.0) == (0, 0, 0)


VELOCITIES = st.tuples(*[st.floats(-1, 1).map(lambda x: x**5)] * 2, st.floats(-10, 10).map(lambda x: x**3))


@settings(max_examples=100)
@given(st.sampled_from(FOOTPRINTS), VELOCITIES)
@example(RECTANGLE, (0.0, 1.5e-312, 0.0))
@example(RECTANGLE, (0.0, 0.0, 5e-324))
@example(DISK, (1e-310, 0.0, 1e-310))
def test_friction_only_takes_energy(footprint: Footprint, velocity: tuple[float, float, float]) -> None:
    for law in (
        uniform_friction(footprint, 0.5, 10.0),
        balanced_friction(footprint, 0.5, 10.0, 0.05),
        decoupled_friction(footprint, 0.5, 10.0),
    ):
        size = max(map(abs, velocity)) or 1.0  # so that the power of the slowest motion does not vanish
        power = np.dot(law(*velocity), [part / size for part in velocity])
        assert power <= 0
        if any(velocity):
            assert power < 0


@settings(max_examples=100)
@given(st.sampled_from([RECTANGLE, DISK, CORNERS]), VELOCITIES, st.sampled_from([0.0, 0.05]))
def test_a_mirrored_or_turned_motion_has_mirrored_or_turned_friction(
    footprint: Footprint, velocity: tuple[float, float, float], height: float
) -> None:
    law = balanced_friction(footprint, 0.5, 10.0, height)
    v1, v2, w = velocity
    f1, f2, torque = law(v1, v2, w)
    size = [5, 5, 5 * reach(footprint)]
    images = [
        ((v1, -v2, -w), (f1, -f2, -torque)),
        ((-v1, v2, -w), (-f1, f2, -torque)),
        ((-v1, -v2, w), (-f1, -f2, torque)),
        ((3 * v1, 3 * v2, 3 * w), (f1, f2, torque)),
    ]
    if height == 0:  # reversed friction puts a balanced load elsewhere
        images.append(((-v1, -v2, -w), (-f1, -f2, -torque)))
    for image, expected in images:
        np.testing.assert_allclose((np.array(law(*image)) - expected) / size, 0, atol=1e-13)
    if isinstance(footprint, Disk):
        c, s = math.cos(1.0), math.sin(1.0)
        turned = law(c * v1 - s * v2, s * v1 + c * v2, w)
        np.testing.assert_allclose((turned - np.array([c * f1 - s * f2, s * f1 + c * f2, torque])) / size, 0, atol=1e-13)


def test_a_turned_rectangle_is_a_turned_velocity() -> None:
    c, s = math.cos(0.7), math.sin(0.7)
    turn = np.array([[c, -s], [s, c]])
    f1, f2, torque = uniform_friction(RECTANGLE, 0.5, 10.0)(0.3, 0.1, 4.0)
    turned = uniform_friction(Polygon(RECTANGLE.vertices @ turn.T), 0.5, 10.0)(*(turn @ [0.3, 0.1]), 4.0)
    # Some hundred nodes of quadrature, summed about corners that are rounded.
    np.testing.assert_allclose(turned, [*(turn @ [f1, f2]), torque], rtol=1e-13)


def test_the_pure_spin_of_a_rectangle_and_of_its_corners() -> None:
    """The book's integral for the torque, and 1.88 times it if the corners bear the load."""
    quarter, _ = dblquad(lambda y, x: math.hypot(x, y), 0, 0.1, 0, 0.2, epsabs=1e-14)
    force1, force2, area = uniform_friction(RECTANGLE, 0.5, 9.81)(0.0, 0.0, 10.0)
    corners = uniform_friction(CORNERS, 0.5, 9.81)(0.0, 0.0, 10.0)[2]
    assert area == pytest.approx(-0.5 * 9.81 * quarter / (0.1 * 0.2), rel=1e-12, abs=0)
    assert corners == pytest.approx(-0.5 * 9.81 * math.hypot(0.1, 0.2), rel=1e-15, abs=0)
    assert corners / area == pytest.approx(1.88, abs=0.005)
    np.testing.assert_allclose([force1, force2], 0, atol=1e-15)


def test_a_pure_translation_and_the_spin_of_a_disk() -> None:
    for footprint in FOOTPRINTS:
        # Closed forms: some roundings.
        np.testing.assert_allclose(uniform_friction(footprint, 0.5, 10.0)(3.0, -4.0, 0.0)[:2], [-3, 4], rtol=1e-15)
    assert uniform_friction(DISK, 0.5, 10.0)(0.0, 0.0, -2.0)[2] == pytest.approx(5 * 0.1 * 2 / 3, rel=1e-15, abs=0)


def test_the_decoupled_law_is_each_for_itself() -> None:
    coupled, law = uniform_friction(RECTANGLE, 0.5, 10.0), decoupled_friction(RECTANGLE, 0.5, 10.0)
    assert law(3.0, -4.0, -7.0) == pytest.approx((-3, 4, coupled(0.0, 0.0, -7.0)[2]), rel=1e-15, abs=0)


@pytest.mark.parametrize("footprint", [RECTANGLE, DISK, CORNERS])
@pytest.mark.parametrize("velocity", [(0.3, 0.1, 0.0), (0.3, 0.1, 1.0), (0.3, 0.1, 5.0), (0.3, 0.1, 1e3), (0.0, 0.0, 1.0)])
def test_a_balanced_load_carries_the_weight_and_the_moment_of_friction(
    footprint: Footprint, velocity: tuple[float, float, float]
) -> None:
    load, height = 10.0, 0.03
    pressure = balanced_pressure(footprint, 0.5, load, height)(*velocity)
    force = balanced_friction(footprint, 0.5, load, height)(*velocity)
    carried = load_moments(footprint) @ pressure
    # Three linear equations, well conditioned: some hundred roundings of the load.
    np.testing.assert_allclose(carried, [load, -height * force[0], -height * force[1]], atol=1e-13 * load)


@pytest.mark.parametrize("footprint", [RECTANGLE, DISK, CORNERS])
def test_a_low_body_bears_its_load_evenly(footprint: Footprint) -> None:
    """The difference falls in proportion to the height."""
    velocity = (0.3, 0.1, 2.0)
    even = np.array(uniform_friction(footprint, 0.5, 10.0)(*velocity))
    assert balanced_friction(footprint, 0.5, 10.0, 0.0)(*velocity) == pytest.approx(even, rel=1e-14, abs=0)
    for height in (1e-3, 1e-6, 1e-9):
        apart = np.abs(np.array(balanced_friction(footprint, 0.5, 10.0, height)(*velocity)) - even)
        assert 0 < apart.max() < 100 * height


@pytest.mark.parametrize(
    ("shape", "law", "share"),
    [
        (Brick((0.1, 0.2, 0.05)), "area", 3 * 0.5 * 0.05 / 0.1),
        (Brick((0.1, 0.2, 0.05)), "corners", 0.5 * 0.05 / 0.1),
        (Cylinder(0.1, 0.05), "area", 4 * 0.5 * 0.05 / 0.1),
    ],
)
def test_a_body_that_would_tip_is_refused(shape: Brick | Cylinder, law: str, share: float) -> None:
    """share: by what part of the mean the load behind a straight slide is less than the mean."""
    body = Body(1.0, (1.0, 1.0, 1.0), shape)
    for friction_coefficient, tips in ((0.5 / share * 0.999, False), (0.5 / share * 1.001, True)):
        plane = Plane(friction_coefficient, law, "balanced")  # type: ignore[arg-type]
        refuse = refuse_tipping(body, plane, 9.81)
        refuse(0.0, 0.0, 5.0)
        if tips:
            with pytest.raises(WouldTip, match=r"would tip.*\(-0\.1"):
                refuse(2.0, 0.0, 0.0)
        else:
            refuse(2.0, 0.0, 0.0)
    refuse_tipping(body, Plane(100.0, law), 9.81)(2.0, 0.0, 0.0)  # type: ignore[arg-type]


def test_the_law_that_a_plane_names() -> None:
    body = Body(2.0, (1.0, 1.0, 1.0), Brick((0.1, 0.2, 0.05)))
    load, velocity = 2 * 9.81, (0.3, 0.1, 2.0)
    for plane, law in (
        (Plane(0.5), uniform_friction(RECTANGLE, 0.5, load)),
        (Plane(0.5, "corners"), uniform_friction(CORNERS, 0.5, load)),
        (Plane(0.5, "decoupled"), decoupled_friction(RECTANGLE, 0.5, load)),
        (Plane(0.5, "area", "balanced"), balanced_friction(RECTANGLE, 0.5, load, 0.05)),
        (Plane(0.5, "corners", "balanced"), balanced_friction(CORNERS, 0.5, load, 0.05)),
    ):
        assert friction(body, plane, 9.81)(*velocity) == law(*velocity)
    with pytest.raises(ValueError, match="balanced load has no meaning under the decoupled law"):
        friction(body, Plane(0.5, "decoupled", "balanced"), 9.81)


def test_shapes_without_a_face_are_refused_by_name() -> None:
    for shape, name in ((Sphere(0.1), "sphere"), (Ellipsoid((0.1, 0.2, 0.3)), "ellipsoid"), (None, "without a shape")):
        for refused in (lambda shape=shape: footprint_of(shape, "area"), lambda shape=shape: resting_height(shape)):
            with pytest.raises(NotFlat, match=name):
                refused()
    with pytest.raises(NotFlat, match="a cylinder has no corners"):
        footprint_of(Cylinder(0.1, 0.2), "corners")


def test_nearness_is_the_inverse_distance_of_what_is_not_smooth() -> None:
    """Close to an edge, a rim and a point at rest; and finite on them."""
    assert nearness(RECTANGLE)(0.0, 0.1 - 1e-4, -1.0) == pytest.approx(reach(RECTANGLE) / 1e-4, rel=0.01)
    assert nearness(DISK)(0.0, 0.1 - 1e-4, 1.0) == pytest.approx(1e3, rel=0.01)
    assert nearness(CORNERS)(0.2, -0.1 + 1e-5, 1.0) == pytest.approx(math.hypot(*[0.223606797749979] * 2) / 1e-5 / 4, rel=0.01)
    for footprint, velocity in ((RECTANGLE, (0.0, 0.1, -1.0)), (DISK, (0.0, 0.1, 1.0)), (CORNERS, (0.2, -0.1, 1.0))):
        assert 1e4 < nearness(footprint)(*velocity) < 1e12
        assert nearness(footprint)(1.0, 2.0, 0.0) < 10
