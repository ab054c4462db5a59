"""Stacks and piles at rest: nothing moves, and what each interface bears is what balances weights."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bodycheck.reference.contact.motion import ContactMotion
from bodycheck.reference.contact.piles import rest
from bodycheck.reference.contact.problem import Problem
from bodycheck.reference.errors import NotModelled
from bodycheck.reference.mechanisms.mechanism import WORLD, PairContact
from bodycheck.reference.scene import Brick, Cylinder, Push, Shape, Sphere
from tests.support.piles import GRAVITY, body, height, loads_of, moved, on_incline, pile

MINUTE = np.array([0.0, 1.0, 60.0])
CUBE = Brick((0.1, 0.1, 0.1))


def stack(*layers: tuple[Shape, float, float, float]) -> Problem:
    """Bodies one on another: shape, mass, and place along x and y."""
    bodies, top = [], 0.0
    for place, (shape, mass, x, y) in enumerate(layers):
        bodies.append(body(f"body-{place}", shape, mass, (x, y, top + height(shape))))
        top += 2 * height(shape)
    return pile(*bodies)


def wrenches(known: Problem, below: dict[int, int], levels: dict[int, float]) -> dict[int, np.ndarray]:
    """The force and the moment (6,) on each body from the one below it, about the foot of its own interface on the z axis.

    Newton and Euler of every body, as one linear system: independent of what is tested.
    """
    count = len(known.bodies)
    matrix, sides = np.zeros((6 * count, 6 * count)), np.zeros(6 * count)

    def onto(row: int, column: int, sign: float) -> None:
        arm = np.array([0.0, 0.0, levels[column]]) - known.bodies[row].position.astype(float)
        cross = np.array([[0, -arm[2], arm[1]], [arm[2], 0, -arm[0]], [-arm[1], arm[0], 0]])
        block = np.block([[np.eye(3), np.zeros((3, 3))], [cross, np.eye(3)]])
        matrix[6 * row : 6 * row + 6, 6 * column : 6 * column + 6] += sign * block

    for upper, lower in below.items():
        onto(upper, upper, 1.0)
        if lower != WORLD:
            onto(lower, upper, -1.0)
        sides[6 * upper : 6 * upper + 3] = (-known.bodies[upper].mass * known.gravity).astype(float)
    return dict(enumerate(np.linalg.solve(matrix, sides).reshape(count, 6)))


def assert_at_rest(known: Problem, found: ContactMotion) -> None:
    for place, own in enumerate(known.bodies):
        assert np.all(found.position[place] == own.position)
        assert np.all(found.quaternion[place] == own.quaternion)
    assert not np.any(found.velocity)
    assert not np.any(found.spin)
    assert found.events == ()


def test_a_stack_of_ten_bears_the_weight_above() -> None:
    known = stack(*[(CUBE, 1.5, 0.0, 0.0)] * 10)
    found = moved(rest.motion, known, MINUTE)
    assert_at_rest(known, found)
    expected = {(place - 1, place): (10 - place) * 1.5 * GRAVITY for place in range(10)}
    assert loads_of(found) == pytest.approx(expected, rel=1e-13)  # some roundings of a linear system
    assert found.friction == 0
    # The heights of the file are rounded decimals.
    assert max(found.errors["position_error"]) < 1e-14


@pytest.mark.parametrize("masses", [(1.0, 1000.0), (1000.0, 1.0)])
def test_a_mass_ratio_of_a_thousand(masses: tuple[float, float]) -> None:
    found = moved(rest.motion, stack(*((CUBE, mass, 0.0, 0.0) for mass in masses)), MINUTE)
    assert loads_of(found) == pytest.approx({(-1, 0): 1001 * GRAVITY, (0, 1): masses[1] * GRAVITY}, rel=1e-12)


def is_refused(known: Problem) -> bool:
    """Whether a stack tips, or its faces do not even meet."""
    try:
        return rest.motion(known, MINUTE) is None
    except NotModelled as error:
        return "tips" in str(error)


SHAPES = st.one_of(
    st.builds(lambda a, b, c: Brick((a, b, c)), *3 * [st.floats(0.05, 0.3)]),
    st.builds(Cylinder, st.floats(0.05, 0.3), st.floats(0.05, 0.3)),
)
LAYERS = st.lists(st.tuples(SHAPES, st.floats(0.01, 10.0), st.floats(-0.1, 0.1), st.floats(-0.1, 0.1)), min_size=2, max_size=6)


@settings(max_examples=40, deadline=None)
@given(LAYERS, st.floats(0.0, 0.6))
def test_newton_and_euler_hold_in_every_stack(layers: list[tuple[Shape, float, float, float]], angle: float) -> None:
    """The stack rests just where the forces that balance all bodies act within the faces."""
    standing, levels, top = [], {}, 0.0
    for place, (shape, mass, x, y) in enumerate(layers):
        levels[place] = top
        standing.append((f"body-{place}", shape, mass, (x, y, top + height(shape))))
        top += 2 * height(shape)
    known = on_incline(angle, *standing)
    below = {place: place - 1 for place in range(len(layers))}
    forces = wrenches(known, below, levels)
    inside = []
    for place, (fx, fy, fz, mx, my, _) in forces.items():
        assert math.hypot(fx, fy) == pytest.approx(math.tan(angle) * fz, abs=1e-9)
        point = np.array([-my, mx]) / fz
        for other in {place, max(place - 1, 0)} if place else {place}:
            shape, _, x, y = layers[other]
            away = np.abs(point - (x, y))
            inside.append(
                shape.radius - math.hypot(*away) if isinstance(shape, Cylinder) else min(np.array(shape.semi_axes[:2]) - away)
            )
    if abs(min(inside)) < 1e-9:
        return  # at the rim, where roundings decide
    if min(inside) < 0:
        assert is_refused(known)
        return
    found = moved(rest.motion, known, MINUTE)
    assert_at_rest(known, found)
    loads = loads_of(found)
    for place, force in forces.items():
        assert loads[place - 1, place] == pytest.approx(force[2], rel=1e-9)
    assert loads[-1, 0] == pytest.approx(sum(mass for _, mass, *_ in layers) * GRAVITY * math.cos(angle), rel=1e-12)
    assert found.friction == pytest.approx(math.tan(angle), abs=1e-15)


def test_frictions_hold_a_stack_on_an_incline_up_to_the_tangent() -> None:
    layers = [(f"body-{place}", CUBE, 1.0, (0.0, 0.0, 0.1 + 0.2 * place)) for place in range(2)]
    angle = 0.1
    moved(rest.motion, on_incline(angle, *layers, friction=1.01 * math.tan(angle)), MINUTE)
    with pytest.raises(NotModelled, match="slide"):
        rest.motion(on_incline(angle, *layers, friction=0.99 * math.tan(angle)), MINUTE)


@pytest.mark.parametrize("friction", [0.1, 0.25, 0.3, 0.49])
def test_at_the_limit_the_bound_covers_what_rounding_decides(friction: float) -> None:
    layers = [(f"body-{place}", CUBE, 1.0, (0.0, 0.0, 0.1 + 0.2 * place)) for place in range(2)]
    error = moved(rest.motion, on_incline(math.atan(friction), *layers, friction=friction), MINUTE).errors["position_error"]
    # Half a last place of both numbers: the upper body slides on the lower one, which slides too.
    assert 2 * 60**2 / 2 * GRAVITY * 2**-53 * friction < error[-1] < 1e-10


def test_a_bridge_shares_its_weight_where_it_is_symmetric() -> None:
    pillars = [body(f"pillar-{x}", CUBE, 2.0, (x, 0.0, 0.1)) for x in (-0.3, 0.3)]
    beam = Brick((0.5, 0.1, 0.05))
    found = moved(rest.motion, pile(*pillars, body("beam", beam, 3.0, (0.0, 0.0, 0.25))), MINUTE)
    expected = {(-1, 0): 3.5, (-1, 1): 3.5, (0, 2): 1.5, (1, 2): 1.5}
    assert loads_of(found) == pytest.approx({pair: mass * GRAVITY for pair, mass in expected.items()}, rel=1e-12)
    # Elsewhere, rigid bodies do not tell what each pillar bears.
    aside = moved(rest.motion, pile(*pillars, body("beam", beam, 3.0, (0.05, 0.0, 0.25))), MINUTE)
    assert loads_of(aside) == {}
    with pytest.raises(NotModelled, match="by their weights alone"):
        rest.motion(pile(*pillars, body("beam", Brick((0.8, 0.1, 0.05)), 3.0, (0.45, 0.0, 0.25))), MINUTE)


def test_several_stacks_stand_apart() -> None:
    bodies = [body(f"body-{x}-{z}", CUBE, 1.0 + x, (x, 0.0, z), yaw=0.3 * x) for x in (0.0, 1.0) for z in (0.1, 0.3)]
    found = moved(rest.motion, pile(*bodies), MINUTE)
    expected = {(-1, 0): 2.0, (0, 1): 1.0, (-1, 2): 4.0, (2, 3): 2.0}
    assert loads_of(found) == pytest.approx({pair: mass * GRAVITY for pair, mass in expected.items()}, rel=1e-12)


def test_bricks_that_touch_beside_may_press_each_other() -> None:
    known = pile(*(body(f"body-{x}", CUBE, 1.0, (x, 0.0, 0.1)) for x in (0.0, 0.2)))
    found = moved(rest.motion, known, MINUTE)
    assert_at_rest(known, found)
    assert found.interfaces == ()


def test_a_sphere_rests_on_a_brick() -> None:
    found = moved(rest.motion, stack((CUBE, 1.0, 0.0, 0.0), (Sphere(0.2), 3.0, 0.05, 0.0)), MINUTE)
    assert loads_of(found) == pytest.approx({(-1, 0): 4 * GRAVITY, (0, 1): 3 * GRAVITY}, rel=1e-13)


@pytest.mark.parametrize(
    ("known", "reason"),
    [
        (stack((Sphere(0.1), 1.0, 0.0, 0.0), (CUBE, 1.0, 0.0, 0.0)), "stands on a sphere"),
        (stack((CUBE, 1.0, 0.0, 0.0), (CUBE, 1.0, 0.11, 0.0)), "tips"),
        (pile(body("one", CUBE, 1.0, (0.0, 0.0, 0.1)), body("two", CUBE, 1.0, (0.1, 0.0, 0.1))), "overlap at the start"),
        (pile(body("one", CUBE, 1.0, (0.0, 0.0, 0.1)), body("two", CUBE, 1.0, (1.0, 0.0, 0.05))), "into the plane"),
    ],
)
def test_what_cannot_rest_is_told(known: Problem, reason: str) -> None:
    with pytest.raises(NotModelled, match=reason):
        rest.motion(known, MINUTE)


@pytest.mark.parametrize(
    "known",
    [
        pile(body("one", CUBE, 1.0, (0.0, 0.0, 0.1)), body("two", CUBE, 1.0, (0.0, 0.0, 0.31))),
        pile(body("one", CUBE, 1.0, (0.0, 0.0, 0.1)), body("two", CUBE, 1.0, (1.0, 0.0, 0.1)), push=Push((1.0, 0.0, 0.0))),
        pile(body("one", CUBE, 1.0, (0.0, 0.0, 0.1))),
        on_incline(0.1, ("one", CUBE, 1.0, (0.0, 0.0, 0.1)), ("two", Sphere(0.1), 1.0, (0.0, 0.0, 0.3))),
    ],
    ids=["falls", "pushed", "alone", "rolls"],
)
def test_what_does_not_rest_is_another_ways(known: Problem) -> None:
    assert rest.motion(known, MINUTE) is None


def test_a_pair_may_have_too_little_friction() -> None:
    layers = [(f"body-{place}", CUBE, 1.0, (0.0, 0.0, 0.1 + 0.2 * place)) for place in range(2)]
    known = on_incline(0.2, *layers)
    slippery = Problem(known.bodies, known.plane, (PairContact((0, 1), 0.1, 0.0),), known.gravity, ())
    with pytest.raises(NotModelled, match="slide"):
        rest.motion(slippery, MINUTE)


def test_bodies_of_a_stack_come_in_any_order() -> None:
    upper, lower = body("upper", CUBE, 1.0, (0.0, 0.0, 0.3)), body("lower", CUBE, 2.0, (0.0, 0.0, 0.1))
    loads = loads_of(moved(rest.motion, pile(upper, lower), MINUTE))
    assert loads == pytest.approx({(0, 1): GRAVITY, (-1, 1): 3 * GRAVITY}, rel=1e-13)
    assert all(one < other for one, other in loads)
    assert list(pairwise(sorted(loads)))


def test_a_wall_in_bond_rests() -> None:
    """Three bricks bear two, and these bear one: the mirror tells how the highest is shared, but nothing tells more."""
    rows = [[((k - (2 - row) / 2) * 0.22, 0.0, 0.05 + 0.1 * row) for k in range(3 - row)] for row in range(3)]
    known = pile(*(body(f"at-{x}-{z}", Brick((0.1, 0.05, 0.05)), 1.0, (x, y, z)) for row in rows for x, y, z in row))
    found = moved(rest.motion, known, MINUTE)
    assert_at_rest(known, found)
    assert loads_of(found) == pytest.approx({(3, 5): GRAVITY / 2, (4, 5): GRAVITY / 2}, rel=1e-12)
