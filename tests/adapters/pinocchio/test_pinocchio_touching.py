"""Pinocchio's rigid contacts of bodies that roll, rest, slide down, bounce, are pushed and bear each other."""

import math
from dataclasses import replace

import numpy as np
import pytest

from bodycheck import load
from bodycheck.adapters import offers
from bodycheck.adapters.contract import Method, SceneUnsupported
from bodycheck.adapters.pinocchio import engine as adapter
from bodycheck.adapters.pinocchio.contact import HAS_POINT_CONTACTS
from bodycheck.adapters.pinocchio.contact_points import Placed, between, on_plane
from bodycheck.reference.contact_observables import reach
from bodycheck.reference.kinematics import rotate
from bodycheck.reference.mechanisms.mechanism import WORLD, Mechanism, PairContact
from bodycheck.reference.scene import Body, Brick, Cylinder, Ellipsoid, Plane, Push, Scene, Shape, Sphere, State
from bodycheck.reference.trajectory import Array
from tests.support.touching import (
    BALL,
    CUBE,
    DOWNHILL,
    GRAVITY,
    INCLINE,
    MASS,
    OF_BALL,
    OF_CUBE,
    RADIUS,
    downhill,
    lying,
    on,
    several,
)

pytestmark = pytest.mark.skipif(not HAS_POINT_CONTACTS, reason="releases before 4 have no point contacts")

STEP = 0.002
ADMM = Method.parse("admm", STEP)

#: A few roundings of numbers of the order of 1 in some hundred steps, and what ADMM's tolerance of 1e-13 leaves.
EXACT = 1e-11


def states(scene: Scene | Mechanism, duration: float) -> Array:
    """States (n, bodies, 13) after every step."""
    return np.asarray(adapter.prepare([scene], ADMM).advance(np.ones(round(duration / STEP), dtype=np.int64))[0])


@pytest.mark.parametrize("part", [0.0, 0.5, 0.99, 1.01, 2.0])
def test_a_block_rests_or_slides_as_coulomb_has_it(part: float) -> None:
    seen = states(on(Plane(part * math.tan(INCLINE), incline=INCLINE), OF_CUBE), 0.4)[-1, 0]
    assert downhill(seen) == pytest.approx(max(0.0, 1 - part) * DOWNHILL * 0.4, abs=EXACT)
    assert seen[10:] == pytest.approx(0, abs=1e-9)


def test_round_bodies_roll_or_slip_down_as_they_must() -> None:
    for friction, part in ((1.0, 5 / 7), (0.05, None)):
        wanted = DOWNHILL * part if part else DOWNHILL - friction * GRAVITY * math.cos(INCLINE)
        ball = states(on(Plane(friction, incline=INCLINE), OF_BALL), 0.4)[-1, 0]
        assert downhill(ball) == pytest.approx(0.4 * wanted, abs=EXACT)
    cylinder = states(lying(Plane(1.0, incline=INCLINE)), 0.4)[-1, 0]
    # Its ends are in line along the plane, within what the quaternion's norm and the roundings of its turn leave.
    assert downhill(cylinder) == pytest.approx(0.4 * 2 / 3 * DOWNHILL, abs=1e-9)


@pytest.mark.parametrize("coefficient", [0.0, 0.3, 0.9, 1.0])
def test_bounces_have_the_coefficient_exactly(coefficient: float) -> None:
    seen = states(on(Plane(0.5, restitution=coefficient), OF_BALL, 0.5 + RADIUS), 0.4)[:, 0]
    last = int(np.argmin(seen[:, 9]))
    # The velocity after the step of the impact is -e times the one before it.
    assert seen[last + 1 : last + 3, 9].max() == pytest.approx(-coefficient * seen[last, 9], abs=EXACT)
    assert seen[:, 2].min() >= RADIUS - EXACT


def test_a_bounce_without_loss_keeps_the_energy_that_the_steps_conserve() -> None:
    """Semi-implicit Euler conserves v^2 / 2 + g z - g h v / 2 of a fall, and such a bounce does too."""
    seen = states(on(Plane(0.5, restitution=1.0), OF_BALL, 0.3 + RADIUS), 2.0)[:, 0]
    kept = seen[:, 9] ** 2 / 2 + GRAVITY * seen[:, 2] - GRAVITY * STEP * seen[:, 9] / 2
    assert np.ptp(kept) < 1e-11


def test_an_oblique_impact_follows_the_laws_of_impulse_and_momentum() -> None:
    """A ball without spin that hits at 45 degrees slips at mu < 2/7 / (1 + e), and else leaves as it rolls."""
    coefficient, speed = 0.5, 3.0
    for friction in (0.1, 1.0):
        scene = replace(on(Plane(friction, restitution=coefficient), OF_BALL, RADIUS + 1e-4), gravity=0.0)
        scene = replace(scene, initial=replace(scene.initial, velocity=(speed, 0.0, -speed)))
        seen = states(scene, 0.002)[-1, 0]
        tangential = min(friction * (1 + coefficient), 2 / 7) * speed
        assert seen[7:10] == pytest.approx([speed - tangential, 0.0, coefficient * speed], abs=EXACT)
        assert seen[10:] == pytest.approx([0.0, 2.5 * tangential / RADIUS, 0.0], abs=1e-9)


def test_pushes_accelerate_and_turn_between_their_instants() -> None:
    floating = Scene(OF_BALL, State((0.0, 0.0, 5.0)), 0.0, Plane(0.5))
    push = Push((3.0, 0.0, 0.0), (0.0, 0.05, 0.0), 0.2, 0.5)
    seen = states(replace(floating, pushes=(push,)), 0.8)
    assert seen[99, 0, 7:] == pytest.approx(0, abs=0)
    assert seen[-1, 0, 7:10] == pytest.approx([0.9 / MASS, 0.0, 0.0], abs=EXACT)
    assert seen[100, 0, 12] == pytest.approx(-0.05 * 3.0 * STEP / OF_BALL.moments[2], rel=1e-12)


def test_pairs_have_their_own_friction_and_bodies_their_order() -> None:
    blocks = [(CUBE, (0.0, y, RADIUS)) for y in (-1.0, 0.0, 1.0)]
    own = (PairContact((WORLD, 0), 0.0, 0.0), PairContact((WORLD, 2), 2.0, 0.0))
    seen = states(several(blocks, Plane(0.5 * math.tan(INCLINE), incline=INCLINE), contacts=own), 0.2)[-1]
    assert seen[:, 1] == pytest.approx([-1.0, 0.0, 1.0], abs=EXACT)
    assert downhill(seen) == pytest.approx(np.array([1.0, 0.5, 0.0]) * DOWNHILL * 0.2, abs=EXACT)


def test_a_stack_rests_and_its_loads_are_the_weights_above() -> None:
    stack = several([(CUBE, (0.01 * place, 0.0, RADIUS * (2 * place + 1))) for place in range(3)], Plane(0.5))
    assert states(stack, 0.1)[-1, :, 7:] == pytest.approx(0, abs=1e-9)
    loads = adapter.interface_loads(stack, ADMM, 20)
    weight = MASS * GRAVITY
    for pair, bodies in (((WORLD, 0), 3), ((0, 1), 2), ((1, 2), 1)):
        assert loads[pair][1:] == pytest.approx(bodies * weight, rel=1e-9)


def test_balls_on_a_pushed_box_accelerate_as_mechanics_has_it() -> None:
    """A ball that rolls on a box with the acceleration a has 2/7 a, so that F - mu M g = (m + 2/7 n m') a."""
    shapes: list[tuple[Shape, tuple[float, float, float]]] = [(Brick((1.0, 1.0, 0.1)), (0.0, 0.0, 0.1))]
    shapes += [(BALL, (x, 0.0, 0.2 + RADIUS)) for x in (-0.5, 0.5)]
    friction, force = 0.2, 30.0
    scene = several(shapes, Plane(friction), contacts=tuple(PairContact((0, ball), 0.8, 0.0) for ball in (1, 2)))
    seen = states(replace(scene, pushes=(Push((force, 0.0, 0.0)),)), 0.1)[-1]
    wanted = (force - friction * 3 * MASS * GRAVITY) / (MASS * (1 + 2 * 2 / 7))
    assert seen[:, 7] == pytest.approx(0.1 * wanted * np.array([1.0, 2 / 7, 2 / 7]), abs=EXACT)


def test_a_thin_rod_falls_and_lies_down() -> None:
    """Its eight points are nearly on a line, and ADMM's faster rule of penalties stalls when it lands."""
    scene = load("falling-rod").scene
    assert isinstance(scene, Scene)
    assert isinstance(scene.body.shape, Cylinder)
    landed = states(scene, 1.0)[-1, 0]
    assert landed[2] == pytest.approx(scene.body.shape.radius, abs=1e-4)


@pytest.mark.parametrize("shape", [Sphere(0.1), Brick((0.1, 0.2, 0.3)), Ellipsoid((0.1, 0.2, 0.3)), Cylinder(0.1, 0.2)])
def test_the_lowest_point_on_a_plane_is_where_the_support_of_the_shape_has_it(shape: Shape) -> None:
    rng = np.random.default_rng(5)
    incline = 0.4
    plane = Plane(incline=incline)
    axes = np.array(
        [[math.cos(incline), 0.0, math.sin(incline)], [0.0, 1.0, 0.0], [-math.sin(incline), 0.0, math.cos(incline)]]
    )
    for _ in range(20):
        quaternion = rng.normal(size=4)
        quaternion /= np.linalg.norm(quaternion)
        centre = rng.normal(size=3)
        body = Placed(shape, centre, rotate(quaternion, np.eye(3)).T)
        gaps = [point.gap for point in on_plane(0, body, axes, 10.0)]
        lowest = centre @ np.array(plane.normal) - reach(shape, quaternion[None], plane.normal)[0]
        assert min(gaps) == pytest.approx(lowest, abs=1e-14)


def test_points_between_two_bodies() -> None:
    upright, turned = np.eye(3), np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    # Two bars that cross: no corner of one is over the other, and the part in common is a square.
    bar = Brick((0.5, 0.1, 0.1))
    lower, upper = Placed(bar, np.zeros(3), upright), Placed(bar, np.array([0.0, 0.0, 0.2]), turned)
    crossed = list(between((0, 1), lower, upper, 0.01))
    square = [[x, y, 0.1] for x in (-0.1, 0.1) for y in (-0.1, 0.1)]
    assert sorted(point.position.round(9).tolist() for point in crossed) == square
    assert all(abs(point.gap) < 1e-15 and point.axes[2, 2] == 1.0 for point in crossed)
    # In the other order the normal, which points from the first to the second, is the other one.
    assert {point.axes[2, 2] for point in between((0, 1), upper, lower, 0.01)} == {-1.0}
    assert not list(between((0, 1), lower, Placed(bar, np.array([0.0, 0.0, 0.3]), turned), 0.01))
    beside = Placed(Sphere(0.1), np.array([0.65, 0.0, 0.0]), upright)
    (point,) = between((0, 1), Placed(bar, np.zeros(3), upright), beside, 0.1)
    assert point.gap == pytest.approx(0.05)
    assert point.axes[:, 2] == pytest.approx([1.0, 0.0, 0.0])
    inside = Placed(Sphere(0.1), np.array([0.0, 0.0, 0.09]), upright)
    (point,) = between((0, 1), inside, Placed(bar, np.zeros(3), upright), 0.1)
    assert point.gap == pytest.approx(-0.11)
    assert point.axes[:, 2] == pytest.approx([0.0, 0.0, -1.0])


def test_what_is_offered_and_refused() -> None:
    bouncing = on(Plane(0.5), OF_BALL, 1.0)
    assert offers.offered(adapter.engine, bouncing) == ("admm",)
    assert adapter.models(bouncing, "admm") == {}
    two = several([(Cylinder(0.1, 0.1), (0.0, 0.0, 0.1)), (CUBE, (1.0, 0.0, RADIUS))], Plane(0.5))
    for scene in (two, on(Plane(0.5), Body(1.0, (1.0, 1.0, 1.0)), 1.0)):
        with pytest.raises(SceneUnsupported):
            adapter.prepare([scene], ADMM)
    with pytest.raises(SceneUnsupported, match="script"):
        adapter.script(bouncing, ADMM, 1.0, 2)
    with pytest.raises(SceneUnsupported, match="script"):
        adapter.script(two, ADMM, 1.0, 2)
