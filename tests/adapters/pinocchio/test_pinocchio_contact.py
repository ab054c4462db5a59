"""Pinocchio's two schemes for a body on a plane: its own rigid contact, and the reference's law as a force."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from bodycheck.adapters import offers, registry
from bodycheck.adapters.contract import EngineDiverged, Method, SceneUnsupported
from bodycheck.adapters.pinocchio.contact import solver_settings
from bodycheck.reference.inertia import principal_moments
from bodycheck.reference.scene import Body, Brick, Cylinder, Plane, Scene, Shape, State
from bodycheck.reference.sliding.motion import slide
from bodycheck.reference.trajectory import Array

PINOCCHIO = registry.load("pinocchio")
SCHEMES = ("admm", "law-force")
BRICK, DISK = Brick((0.1, 0.2, 0.05)), Cylinder(0.15, 0.05)
GRAVITY, FRICTION, SPEED, SPIN = 9.81, 0.5, 2.0, 10.0
#: Both the time (s) and the distance (m) of the straight slide: v0/(mu g) and v0^2/(2 mu g) at v0 = 2 m/s.
SLIDE = SPEED / (FRICTION * GRAVITY)

#: m/s and rad/s: far above what ADMM's tolerance leaves, and far below what a step takes away.
AT_REST = 1e-9


def flat(
    velocity: tuple[float, float] = (0.0, 0.0),
    spin: float = 0.0,
    plane: Plane | None = None,
    shape: Shape = BRICK,
    yaw: float = 0.4,
) -> Scene:
    """A body that lies on the plane (corner law where none is given), turned by a yaw (rad), and moves."""
    body = Body(1.2, principal_moments(shape, 1.2), shape)
    quaternion = (math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2))
    state = State((0.3, -0.2, 0.05), quaternion, (*velocity, 0.0), (0.0, 0.0, spin))
    return Scene(body, state, GRAVITY, plane or Plane(FRICTION, "corners"))


def every_step(scene: Scene, scheme: str, timestep: float, duration: float) -> Array:
    """The states (n + 1, 13) at t = 0 and after each of the n steps."""
    strides = np.array([0] + [1] * round(duration / timestep))
    return PINOCCHIO.prepare([scene], Method.parse(scheme, timestep)).advance(strides)[0, :, 0]


def stop(rows: Array, timestep: float) -> float:
    """The end (s) of the first step at which the body rests, and does so to the end."""
    moving = np.flatnonzero(np.abs(rows[:, 7:]).max(axis=1) > AT_REST)
    assert moving[-1] < len(rows) - 1
    return float(moving[-1] + 1) * timestep


def turned(rows: Array) -> float:
    """Yaw (rad) from the first to the last state."""
    angles = np.unwrap(2 * np.arctan2(rows[:, 6], rows[:, 3]), period=2 * np.pi)
    return float(angles[-1] - angles[0])


@pytest.mark.parametrize("scheme", SCHEMES)
def test_a_straight_slide_ends_where_it_must_with_order_1(scheme: str) -> None:
    steps, errors = (4e-3, 2e-3, 1e-3), []
    for h in steps:
        rows = every_step(flat((0.6 * SPEED, 0.8 * SPEED)), scheme, h, 0.45)
        # Friction is constant: velocities are exact until the step within which the body stops.
        assert SLIDE <= stop(rows, h) <= SLIDE + h
        way = rows[-1, :2] - rows[0, :2]
        np.testing.assert_allclose(way / np.linalg.norm(way), [0.6, 0.8], atol=1e-9)
        errors.append(abs(float(np.linalg.norm(way)) - SLIDE))
    # The next term of the error is that of the step within which the body stops, of order h^2: below 1e-3 of v0 h/2.
    np.testing.assert_allclose(np.log2(np.divide(errors[:-1], errors[1:])), 1, atol=2e-3)


@pytest.mark.parametrize(
    ("scheme", "law", "time"), [(s, "corners", 0.15196) for s in SCHEMES] + [("law-force", "area", 0.28639)]
)
def test_a_pure_spin_stops_when_its_law_says(scheme: str, law: str, time: float) -> None:
    h = 1e-3
    scene = flat(spin=SPIN, plane=Plane(FRICTION, law))
    rows = every_step(scene, scheme, h, 0.35)
    assert time <= stop(rows, h) <= time + h
    # Semi-implicit Euler misses half a step of the initial velocity; the end of the stop is below a hundredth of that.
    assert turned(rows) == pytest.approx(SPIN * time / 2 - SPIN * h / 2, abs=SPIN * h / 100)
    np.testing.assert_allclose(rows[:, :2], np.broadcast_to(rows[0, :2], (len(rows), 2)), atol=1e-12)


@pytest.mark.parametrize(
    ("plane", "shape"),
    [
        (Plane(FRICTION, "corners"), BRICK),
        (Plane(FRICTION, "corners", "balanced"), BRICK),
        (Plane(FRICTION, "area"), BRICK),
        (Plane(FRICTION, "decoupled"), BRICK),
        (Plane(FRICTION, "area"), DISK),
    ],
)
def test_the_law_as_a_force_converges_to_the_reference(plane: Plane, shape: Shape) -> None:
    scene = flat((1.6, -1.2), SPIN, plane, shape)
    exact = slide(scene, np.array([0.0, 1.0])).stop
    assert exact is not None
    errors = []
    for h in (4e-3, 2e-3, 1e-3):
        rows = every_step(scene, "law-force", h, 0.7)
        assert abs(stop(rows, h) - exact.time) <= 1.5 * h
        errors.append([*(rows[-1, :2] - exact.position[:2]), turned(rows) - (exact.yaw - 0.4)])
    fine = np.array(errors)
    # At 1 ms the errors are half a step of the initial velocities, or a step where friction at the start is off as much.
    assert np.abs(fine[2] / [SPEED, SPEED, SPIN]).max() < 1e-3
    # Order 1: what is extrapolated to h = 0 is free of them, but for the step within which the body stops.
    limit = 2 * fine[2] - fine[1]
    assert np.abs(limit).max() < np.abs(fine[2]).max() / 20


def test_the_rigid_contact_of_a_curling_brick_converges_to_the_balanced_corners() -> None:
    """Of the loads that a rigid body leaves open, the adapter chooses the linear one in the limit."""
    scene = flat((SPEED, 0.0), SPIN, Plane(FRICTION, "corners", "balanced"), yaw=0.0)
    exact = slide(scene, np.array([0.0, 1.0])).stop
    assert exact is not None
    errors = []
    for h in (2e-3, 1e-3):
        rows = every_step(scene, "admm", h, 0.5)
        assert abs(stop(rows, h) - exact.time) <= 1.5 * h
        errors.append([*(rows[-1, :2] - exact.position[:2]), turned(rows) - exact.yaw])
    coarse, fine = np.array(errors)
    # At 1 ms half a step of the initial velocities; extrapolated to h = 0, without it. Equal loads end 15 mm away, in y.
    assert np.abs(fine / [SPEED, SPEED, SPIN]).max() < 1e-3
    assert np.abs((2 * fine - coarse) / [SPEED, SPEED, SPIN]).max() < 5e-5


@pytest.mark.parametrize("motion", [((SPEED, 0.0), 0.0), ((0.0, 0.0), SPIN), ((SPEED, 1.0), -SPIN)])
@pytest.mark.parametrize("mass", [1e-3, 1e3])
@pytest.mark.parametrize("timestep", [1e-2, 1e-4])
def test_rigid_corners_neither_enter_the_plane_nor_leave_it(
    motion: tuple[tuple[float, float], float], mass: float, timestep: float
) -> None:
    scene = flat(*motion)
    body = replace(scene.body, mass=mass, moments=principal_moments(BRICK, mass))
    rows = every_step(replace(scene, body=body), "admm", timestep, 100 * timestep)
    # The solver leaves g h^2 times its tolerance, and the rounding of the centre's height.
    assert np.abs(rows[:, 2] - 0.05).max() < 1e-9 * GRAVITY * timestep**2 + 1e-15
    tilt = 2 * np.arctan2(np.hypot(rows[:, 4], rows[:, 5]), np.hypot(rows[:, 3], rows[:, 6]))
    assert tilt.max() < 1e-10


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("friction", [0.0, 0.5])
def test_a_brick_at_rest_stays_at_rest(scheme: str, friction: float) -> None:
    rows = every_step(flat(plane=Plane(friction, "corners")), scheme, 1e-3, 0.5)
    np.testing.assert_allclose(rows[:, :7], np.broadcast_to(rows[0, :7], (501, 7)), rtol=0, atol=1e-14)
    # ADMM's tolerance is 1e-15 m/s here; at 0.1 m from an axis that is 1e-14 rad/s a step, and some steps add up.
    np.testing.assert_allclose(rows[:, 7:], 0, rtol=0, atol=1e-12)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_a_brick_without_friction_slides_and_turns_uniformly(scheme: str) -> None:
    rows = every_step(flat((SPEED, 1.0), SPIN, Plane(0.0, "corners")), scheme, 1e-3, 0.5)
    # 500 roundings of a velocity of 10 rad/s.
    np.testing.assert_allclose(rows[-1, :3], [1.3, 0.3, 0.05], rtol=0, atol=1e-12)
    np.testing.assert_allclose(rows[-1, 7:], [SPEED, 1.0, 0.0, 0.0, 0.0, SPIN], rtol=0, atol=1e-12)
    assert turned(rows) == pytest.approx(SPIN * 0.5, abs=1e-12)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_stepping_in_pieces_is_stepping_at_once(scheme: str) -> None:
    scene, strides = flat((SPEED, 0.0), SPIN), np.array([0, 3, 0, 40, 300])
    whole = PINOCCHIO.prepare([scene], Method.parse(scheme, 2e-3)).advance(strides)
    simulation = PINOCCHIO.prepare([scene], Method.parse(scheme, 2e-3))
    pieces = [simulation.advance(part) for part in (strides[:2], strides[2:4], strides[4:])]
    np.testing.assert_array_equal(np.concatenate(pieces, axis=1), whole)


def test_a_step_that_admm_does_not_solve_is_diverged(monkeypatch: pytest.MonkeyPatch) -> None:
    def hurried(*arguments: Any) -> Any:
        settings = solver_settings(*arguments)
        settings.max_iterations = 2
        return settings

    monkeypatch.setattr("bodycheck.adapters.pinocchio.contact.solver_settings", hurried)
    with pytest.raises(EngineDiverged, match=r"ADMM stops at a residual of .* at t = 0\.001 s"):
        every_step(flat((SPEED, 0.0), SPIN), "admm", 1e-3, 0.01)


def test_integrators_are_those_of_the_scene() -> None:
    on_plane, free = flat(), replace(flat(), plane=None)
    assert offers.offered(PINOCCHIO.engine, on_plane) == (*SCHEMES, "law-force:model=planar-joint")
    assert set(offers.offered(PINOCCHIO.engine, free)) == {"semi-implicit-euler", "body-twist-euler", "rk4", "rk4-naive"}
    assert set(offers.listed(PINOCCHIO.engine)) == {
        *offers.offered(PINOCCHIO.engine, free),
        *offers.offered(PINOCCHIO.engine, on_plane),
    }
    for scene, integrator in ((on_plane, "rk4"), (free, "admm")):
        method = Method.parse(integrator, 1e-3)
        assert offers.not_offered(PINOCCHIO.engine, scene, method) == f"has no integrator {integrator!r} for this scene"


UNSUPPORTED = {
    "drag together with contact": replace(flat(), drag=0.1),
    "contact without a weight": replace(flat(), gravity=0.0),
    "no corners": flat(shape=DISK),
    "balanced load has no meaning": flat(plane=Plane(FRICTION, "decoupled", "balanced")),
}


@pytest.mark.parametrize("reason", UNSUPPORTED)
def test_what_cannot_be_modelled_is_named(reason: str) -> None:
    scene = UNSUPPORTED[reason]
    for scheme in SCHEMES:
        with pytest.raises(SceneUnsupported, match=reason):
            PINOCCHIO.prepare([scene], Method.parse(scheme, 1e-3))


def test_a_cylinder_has_no_corners_for_rigid_contacts() -> None:
    scene = flat(spin=SPIN, shape=DISK, plane=Plane(FRICTION, "area"))
    PINOCCHIO.prepare([scene], Method.parse("law-force", 1e-3))
    with pytest.raises(SceneUnsupported, match="admm has contacts at corners"):
        PINOCCHIO.prepare([scene], Method.parse("admm", 1e-3))
