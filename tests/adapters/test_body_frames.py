"""Bodies whose frame is not that of their principal axes: the motion is the same, told in the user's frame."""

import math

import numpy as np
import pytest

from bodycheck import CaseFaults, compare, load, simulate, truth
from bodycheck.casefile.case import parse
from bodycheck.reference.inertia import inertia_tensor
from bodycheck.reference.kinematics import geodesic_angle, multiply, rotate
from bodycheck.reference.observables import observe
from bodycheck.reference.scene import Body, Scene, State
from bodycheck.reference.truth import truth as truth_of_scene

CASE = """\
format = 1
name = "made"
title = "A body that is made"
[body]
{body}
[initial]
angular_velocity = [1.0, 2.0, 3.0]
[run]
duration = 1.0
samples = 11
"""
PARTS = '[[body.parts]]\nshape = "sphere"\nradius = 1.0\nmass = 1.0\nposition = [{p}]\n'
TIMES = np.linspace(0, 5, 51)


def made(body: str) -> Body:
    return parse(CASE.format(body=body), "f").scene.body


def test_a_body_relabelled_moves_as_it_did() -> None:
    """Moments and rates along other axes of the same body: what the world sees is the same."""
    axes = np.array([0.5, 0.5, 0.5, 0.5])
    moments, spin = (0.2, 0.3, 0.4), np.array([0.3, 5.0, 0.1])
    plain = truth_of_scene(Scene(Body(1.0, moments), State(angular_velocity=tuple(spin))), TIMES).trajectory
    told = State(quaternion=(0.5, -0.5, -0.5, -0.5), angular_velocity=tuple(rotate(axes, spin)))
    other = truth_of_scene(Scene(Body(1.0, moments, axes=tuple(axes)), told), TIMES).trajectory
    assert geodesic_angle(multiply(other.quaternion, np.tile(axes, (51, 1))), plain.quaternion).max() < 1e-13
    np.testing.assert_allclose(rotate(np.tile(axes, (51, 1)), plain.angular_velocity), other.angular_velocity, atol=1e-13)


@pytest.mark.parametrize(("engine", "integrator"), [("mujoco", "RK4"), ("pinocchio", "rk4")])
def test_engines_agree_in_the_users_frame(engine: str, integrator: str) -> None:
    case = load("dumbbell")
    maxima = compare(truth(case), simulate(case, engine, integrator, 0.002)).maxima()
    assert case.scene.body.axes != (1, 0, 0, 0)
    # The truncation error at 2 ms and 3 rad/s; an axis mistaken makes errors of order one.
    assert maxima["attitude_error"] < 1e-9
    assert maxima["angular_velocity_error"] < 1e-9


def test_the_dumbbell_of_exercise_12() -> None:
    """Two unit spheres on a rod of length 2: 2 (2/5) m about the rod, 2 (2/5 + 1) m across it."""
    body = load("dumbbell").scene.body
    assert body.mass == 2.0
    np.testing.assert_allclose(sorted(body.moments), [0.8, 2.8, 2.8], rtol=1e-14)
    rod = np.array([0.6, 0.0, 0.8])
    np.testing.assert_allclose(inertia_tensor(body), 2.8 * np.eye(3) - 2.0 * np.outer(rod, rod), atol=1e-14)
    seen = observe(load("dumbbell").scene, truth(load("dumbbell")).trajectory)
    np.testing.assert_allclose(seen.angular_momentum, np.tile(seen.angular_momentum[0], (1001, 1)), atol=1e-14)
    np.testing.assert_allclose(seen.angular_momentum[0], inertia_tensor(body) @ [1.0, 0.5, 3.0], atol=1e-14)


def test_three_ways_to_say_one_body() -> None:
    spheres = made(PARTS.format(p="0.0, 0.0, 1.0") + PARTS.format(p="0.0, 0.0, -1.0"))
    tensor = made('shape = "none"\nmass = 2.0\ninertia = [[2.8, 0, 0], [0, 2.8, 0], [0, 0, 0.8]]')
    vector = made('shape = "none"\nmass = 2.0\ninertia = [2.8, 2.8, 0.8]')
    assert tensor == vector
    # Moments as sums of products of small whole numbers and 0.4: a few roundings.
    np.testing.assert_allclose(spheres.moments, vector.moments, rtol=1e-15)
    assert spheres.axes == vector.axes


def test_particles() -> None:
    corners = [(1, 0, 0), (-1, 0, 0), (0, 2, 0), (0, -2, 0), (0, 0, 3), (0, 0, -3)]
    body = made("\n".join(f"[[body.particles]]\nmass = 0.5\nposition = {list(map(float, corner))}" for corner in corners))
    assert body.mass == 3.0
    np.testing.assert_allclose(body.moments, [13.0, 10.0, 5.0])


def test_a_solid_may_have_another_inertia() -> None:
    body = made('shape = "sphere"\nradius = 1.0\nmass = 1.0\ninertia = [[1.0, 0.1, 0], [0.1, 1.0, 0], [0, 0, 1.2]]')
    np.testing.assert_allclose(sorted(body.moments), [0.9, 1.1, 1.2])
    assert body.shape is not None


def test_euler_rates_go_with_whichever_attitude_is_given() -> None:
    turn = math.radians(40)
    rates = "euler_rates = [1.0, 0.5, 2.0]\n"
    text = CASE.format(body='shape = "sphere"\nradius = 1.0\nmass = 1.0').replace("angular_velocity = [1.0, 2.0, 3.0]\n", rates)
    angles = parse(text.replace(rates, rates + f"euler_zxz = [0.0, {turn}, 0.0]\n"), "f")
    given = f"quaternion = [{math.cos(turn / 2)}, {math.sin(turn / 2)}, 0.0, 0.0]\n"
    quaternion = parse(text.replace(rates, rates + given), "f")
    # Both are formed in 80 bits and rounded once; the written quaternion is itself rounded.
    np.testing.assert_allclose(angles.scene.initial.angular_velocity, quaternion.scene.initial.angular_velocity, atol=1e-15)


@pytest.mark.parametrize(
    ("body", "key", "words"),
    [
        ('shape = "none"\nmass = 1.0', "body", "needs one of inertia, particles, parts"),
        ('shape = "none"\ninertia = [1.0, 1.0, 1.0]', "body.mass", "is missing"),
        (
            "mass = 1.0\n[[body.particles]]\nmass = 1.0\nposition = [0, 0, 1]",
            "body.mass",
            "particles are given too",
        ),
        ("[[body.particles]]\nmass = 1.0\nposition = [0, 0, 1]", "body", "a body on a line"),
        ("[[body.particles]]\nmass = -1.0\nposition = [0, 0, 1]", "body.particles[1].mass", "greater than 0"),
        ('shape = "none"\nmass = 1.0\ninertia = [[1, 0.5, 0], [0, 1, 0], [0, 0, 1]]', "body.inertia", "symmetric"),
        ('shape = "none"\nmass = 1.0\ninertia = [[1, 2, 0], [2, 1, 0], [0, 0, 1]]', "body.inertia", "must be positive"),
        # Singular in exact arithmetic, whatever an eigenvalue in doubles is.
        ('shape = "none"\nmass = 1.0\ninertia = [[1, 1, 0], [1, 1, 0], [0, 0, 2]]', "body.inertia", "must be positive"),
        ('shape = "none"\nmass = 1.0\ninertia = [[3, 1, 2], [1, 2, -1], [2, -1, 3]]', "body.inertia", "must be positive"),
        ('shape = "none"\nmass = 1.0\ninertia = [[1, 0, 0], [0, 1, 0], [0, 0, 3]]', "body.inertia", "no body has these"),
        ('shape = "none"\nmass = 1.0\ninertia = [[1, 0, 0], [0, 1, 0]]', "body.inertia[3]", "is missing"),
        (PARTS.format(p="0, 0, 1").replace("radius = 1.0\n", ""), "body.parts[1].radius", "is missing"),
        (
            PARTS.format(p="0, 0, 1") + "semi_axes = [1, 1, 1]",
            "body.parts[1].semi_axes",
            "not apply to a sphere; allowed: radius",
        ),
        (PARTS.format(p="0, 0, 1") + "radus = 1", "body.parts[1].radus", "unknown key; allowed: shape, semi_axes"),
        (
            PARTS.format(p="0, 0, 1") + "euler_zxz=[0,0,0]\nquaternion=[1,0,0,0]",
            "body.parts[1].quaternion",
            "euler_zxz is given too",
        ),
    ],
)
def test_faults_of_bodies(body: str, key: str, words: str) -> None:
    with pytest.raises(CaseFaults) as caught:
        made(body)
    assert any(fault.key == key and words in fault.message for fault in caught.value.faults), caught.value
