"""The axes along which cases are pushed, and what their grammar refuses."""

import math
from dataclasses import replace

import numpy as np
import pytest

from bodycheck import Case, CaseFaults, load
from bodycheck.casefile import axes
from bodycheck.casefile.axes import AXES
from bodycheck.casefile.case import parse
from bodycheck.casefile.grammar import ExtremesTable
from bodycheck.reference.inertia import principal_moments, satisfies_triangle_inequality
from bodycheck.reference.scene import Body, Brick
from bodycheck.studies.extremes.study import points
from tests.support.cases import OF_ONE_BODY

GOOD = """\
format = 1
name = "good"
title = "A good case"
[body]
shape = "brick"
semi_axes = [0.1, 0.3, 0.2]
mass = 2.0
[initial]
velocity = [3.0, 0.0, 4.0]
angular_velocity = [0.0, 0.6, 0.8]
[run]
duration = 10.0
samples = 11
[extremes]
spin = [1, 1e6]
"""


def faults(text: str) -> dict[str, str]:
    with pytest.raises(CaseFaults) as caught:
        parse(text, "f")
    return {fault.key: fault.message for fault in caught.value.faults}


def test_every_key_of_the_grammar_is_an_axis() -> None:
    assert list(ExtremesTable.model_fields) == list(AXES)


def test_axes_are_varied_one_at_a_time_but_spins_with_every_step() -> None:
    case = parse(GOOD + "timestep = [0.1, 0.01]\nspeed = [7.0]\n", "f")
    found = [(point.axis, point.value, point.timestep) for point in points(case)]
    spins = [("spin", value, timestep) for value in (1.0, 1e6) for timestep in (0.1, 0.01)]
    assert found == [*spins, ("speed", 7.0, None)]
    alone = parse(GOOD.replace("spin = [1, 1e6]", "timestep = [0.1]"), "f")
    assert [(point.axis, point.value, point.timestep) for point in points(alone)] == [("timestep", 0.1, 0.1)]


def test_sizes_of_velocities_are_set_and_directions_kept() -> None:
    case = parse(GOOD, "f")
    # A ratio and a product: three roundings.
    np.testing.assert_allclose(axes.spin(case, 1e6).scene.initial.angular_velocity, [0, 6e5, 8e5], rtol=1e-15)
    np.testing.assert_allclose(axes.speed(case, 1e-3).scene.initial.velocity, [6e-4, 0, 8e-4], rtol=1e-15)


def test_steps_distance_and_gravity() -> None:
    case = parse(GOOD, "f")
    assert axes.steps(case, 1e6).duration == 2000.0
    assert axes.distance(case, 1e9).scene.initial.position == (1e9, 0.0, 0.0)
    assert axes.gravity(case, 1.62).scene.gravity == 1.62


def test_mass_and_size_keep_the_shape_of_the_mass() -> None:
    case = parse(GOOD, "f")
    heavy, large = axes.mass(case, 7e22).scene.body, axes.size(case, 100.0).scene.body
    assert heavy.mass == 7e22
    # Some roundings, and against the moments of the grown brick itself.
    np.testing.assert_allclose(heavy.moments, principal_moments(Brick((0.1, 0.3, 0.2)), 7e22), rtol=1e-14)
    assert isinstance(large.shape, Brick)
    np.testing.assert_allclose(large.shape.semi_axes, (10.0, 30.0, 20.0), rtol=1e-14)
    assert large.mass == pytest.approx(2e6, rel=1e-14, abs=0)
    np.testing.assert_allclose(large.moments, principal_moments(large.shape, large.mass), rtol=1e-14)


def test_a_body_on_a_plane_grows_on_it() -> None:
    case = load("sliding-brick")
    # A product or two.
    assert axes.size(case, 1e3).scene.initial.position[2] == pytest.approx(
        1e3 * case.scene.initial.position[2], rel=1e-15, abs=0
    )


@pytest.mark.parametrize("ratio", [1.0, 0.99999999, 0.5, 1e-4, 5e-9])
def test_a_stretch_makes_any_ratio_of_moments_that_a_body_can_have(ratio: float) -> None:
    body = axes.moment_ratio(load("gimbal-start"), ratio).scene.body
    a, b, c = body.moments
    # A few roundings.
    assert c / (a + b) == pytest.approx(ratio, rel=1e-15, abs=0)
    assert satisfies_triangle_inequality(body.moments)
    assert c == load("gimbal-start").scene.body.moments[2]


def test_a_stretch_is_that_of_the_brick_along_k() -> None:
    case = parse(GOOD, "f")
    longer = Brick((0.1, 0.3, 0.5))
    a, b, c = principal_moments(longer, 2.0)
    stretched = axes.moment_ratio(case, c / (a + b)).scene.body.moments
    np.testing.assert_allclose(stretched, (a, b, c), rtol=1e-14)  # some ten roundings


def test_the_separatrix_is_near_the_axis_of_the_middle_moment() -> None:
    case = parse(GOOD, "f")
    # A brick of 1 : 3 : 2 has its middle moment about K and its least about J.
    assert axes.separatrix(case, 1e-9).scene.initial.angular_velocity == (0.0, 1e-9, 1.0)
    turn = math.sqrt(0.5)
    turned = replace(case, scene=replace(case.scene, body=replace(case.scene.body, axes=(turn, 0.0, 0.0, turn))))
    # Principal axes a quarter turn about K away from the body's: the principal J lies along -I.
    np.testing.assert_allclose(
        axes.separatrix(turned, 1e-3).scene.initial.angular_velocity, [-1e-3, 0, 1], rtol=1e-15, atol=1e-18
    )


def test_friction_is_the_planes() -> None:
    plane = axes.friction(load("sliding-brick"), 10.0).scene.plane
    assert plane is not None
    assert plane.friction == 10.0
    assert plane.law == "area"


@pytest.mark.parametrize("name", [name for name in OF_ONE_BODY if load(name).extremes])
def test_every_shipped_point_is_a_body_that_exists(name: str) -> None:
    def exists(case: Case) -> bool:
        body: Body = case.scene.body
        return satisfies_triangle_inequality(body.moments) and min(*body.moments, body.mass) > 0

    found = list(points(load(name)))
    assert found
    assert all(exists(point.case) for point in found)


@pytest.mark.parametrize(
    ("written", "key", "words"),
    [
        ("spin = [1.0, 1.0]", "extremes.spin", "has a value twice"),
        ("spin = []", "extremes.spin", "has no values"),
        ("spin = [-1.0]", "extremes.spin[1]", "greater than 0"),
        ("spin = 3.0", "extremes.spin", "should be an array"),
        ("spinn = [1.0]", "extremes.spinn", "unknown key; allowed: spin, timestep, steps"),
        (f"spin = {[float(n) for n in range(1, 52)]}", "extremes.spin", "at most 50"),
        ("timestep = [20.0]", "extremes.timestep[1]", "must divide the duration into 1 to 1e+09 steps"),
        ("timestep = [1e-9]", "extremes.timestep[1]", "must divide the duration into 1 to 1e+09 steps"),
        ("steps = [1e10]", "extremes.steps[1]", "from 1 to 1e+09"),
        ("steps = [0.5]", "extremes.steps[1]", "from 1 to 1e+09"),
        ("moment_ratio = [1.5]", "extremes.moment_ratio[1]", "less than or equal to 1"),
        ("size = [1e20]", "extremes.size[1]", "less than or equal to 1"),
        ("friction = [0.5]", "extremes.friction", "the scene has no plane"),
        ("separatrix = [2.0]", "extremes.separatrix[1]", "less than or equal to 1"),
    ],
)
def test_refusals(written: str, key: str, words: str) -> None:
    found = faults(GOOD.replace("spin = [1, 1e6]", written))
    assert set(found) == {key}
    assert words in found[key]


def test_an_axis_needs_something_to_push() -> None:
    still = GOOD.replace("[3.0, 0.0, 4.0]", "[0.0, 0.0, 0.0]").replace("[0.0, 0.6, 0.8]", "[0.0, 0.0, 0.0]")
    found = faults(still + "speed = [1.0]\nseparatrix = [1e-3]\n")
    assert set(found) == {"extremes.spin", "extremes.speed", "extremes.separatrix"}
    sphere = GOOD.replace('shape = "brick"\nsemi_axes = [0.1, 0.3, 0.2]', 'shape = "sphere"\nradius = 1.0')
    assert "no intermediate principal axis" in faults(sphere + "separatrix = [1e-3]\n")["extremes.separatrix"]


def test_the_number_of_points_is_bounded() -> None:
    many = f"spin = {[float(n) for n in range(1, 31)]}\ntimestep = {[n / 1000 for n in range(1, 31)]}"
    assert faults(GOOD.replace("spin = [1, 1e6]", many)) == {"extremes": "results in 900 points; at most 500 are allowed"}
