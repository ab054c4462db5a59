"""Random scenes of which there are proofs: each follows from a seed."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from bodycheck.casefile.case import parse
from bodycheck.reference.mechanisms.control import Controller, Sine, Stops
from bodycheck.reference.mechanisms.joint_types import JointType
from bodycheck.reference.mechanisms.mechanism import WORLD, BodyStart, Joint, JointedBody, Mechanism, PairContact
from bodycheck.reference.scene import Plane, Scene, Solid, Sphere, Tensor, Vector
from tests.support.proofs import one_body

#: The text of a case of a body whose axes are not those of its frame.
TURNED = """
format = 1
name = "turned"
title = "A turned tensor"
[body]
shape = "none"
mass = 1.0
inertia = [[0.3, 0.05, -0.02], [0.05, 0.45, 0.04], [-0.02, 0.04, 0.4]]
[initial]
euler_zxz = [0.3, 0.8, -0.4]
velocity = [1.0, 2.0, 3.0]
angular_velocity = [1.0, 2.0, -3.0]
[scene]
gravity = 9.81
[run]
duration = 3.0
samples = 61
"""


def flight_with_drag(seed: int) -> Scene:
    """A free body with drag and gravity, also along a vertical line or without gravity."""
    rng = np.random.default_rng(seed)
    scene = parse(TURNED, "turned").scene
    velocity: Vector = tuple((5 * rng.normal(size=3)).tolist())  # type: ignore[assignment]
    if seed % 3 == 0:
        velocity = (0.0, 0.0, 3.0 * (seed - 3))
    gravity = 0.0 if seed % 3 == 1 else 9.81
    return replace(
        scene, drag=float(rng.uniform(0.01, 0.2)), gravity=gravity, initial=replace(scene.initial, velocity=velocity)
    )


def hinge_or_slider(seed: int) -> Mechanism:
    """A body on a turned hinge or slider, with some of all terms."""
    rng = np.random.default_rng(seed)
    some: Callable[[float], float] = lambda size: float(rng.uniform(0, size)) if rng.random() < 0.5 else 0.0  # noqa: E731
    a, b = rng.normal(size=(2, 3)), np.diag(rng.uniform(0.2, 0.3, 3))
    x, y, z = (tuple(row) for row in (b + 0.02 * np.outer(a[0], a[0])).tolist())
    slides = bool(rng.integers(2))
    joint = Joint(
        *("joint", "prismatic" if slides else "revolute", WORLD, 0, tuple(a[0].tolist()), tuple(rng.normal(size=4).tolist())),
        axis=tuple(a[1].tolist()),
        armature=some(0.3),
        damping=some(2.0),
        stiffness=some(30.0),
        rest=some(0.5),
        friction=some(1.0),
        effort=some(4.0),
        start=(float(rng.normal()),),
        start_velocity=(float(rng.normal()),),
    )
    centre = (0.0, 0.0, 0.0) if not slides else tuple(rng.normal(size=3).tolist())
    return Mechanism((JointedBody("body", Tensor(1.5, (x, y, z)), centre),), (joint,), gravity=9.81)  # type: ignore[arg-type]


def driven_slider(seed: int) -> Mechanism:
    """A slider with stops, of all kinds, that a law with a limit of its effort drives through a spring."""
    rng = np.random.default_rng(seed)
    rigid, friction = Stops(-0.4, 0.3, restitution=0.3 * (seed % 2)), float(rng.uniform(0, 0.5)) * (seed % 3 == 0)
    elastic = Stops(None, 0.3, restitution=None, stiffness=200.0, damping=float(rng.uniform(0, 5)))
    joint = Joint(
        *("joint", "prismatic", WORLD, 0),
        axis=(1.0, 0.0, 0.0),
        damping=float(rng.uniform(0, 0.5)),
        stiffness=float(rng.uniform(0, 2)),
        friction=friction,
        start=(float(rng.uniform(-0.2, 0.2)),),
        start_velocity=(float(rng.normal()),),
        stops=rigid if seed % 4 < 2 else elastic,
    )
    target = Sine(float(rng.uniform(0.1, 0.5)), float(rng.uniform(2, 8)))
    law = Controller(0, kp=float(rng.uniform(5, 40)), kd=float(rng.uniform(0, 3)), target=target, effort_limit=3.0)
    shape = Tensor(1.0, ((0.1, 0.0, 0.0), (0.0, 0.1, 0.0), (0.0, 0.0, 0.1)))
    return Mechanism((JointedBody("body", shape),), (joint,), controllers=(law,))


def top(seed: int) -> Mechanism:
    """A body with two equal moments and its centre of mass on its axis, on a turned ball joint, with gravity in most scenes."""
    rng = np.random.default_rng(seed)
    length, moments = float(rng.uniform(0.1, 0.5)), (0.02, 0.02, float(rng.uniform(0.01, 0.03)))
    rows = tuple(tuple(float(moments[i] if i == j else 0.0) for j in range(3)) for i in range(3))
    joint = Joint(
        *("point", "spherical", WORLD, 0, (0.1, 0.2, 0.3), tuple(rng.normal(size=4).tolist())),
        start=tuple(rng.normal(size=4).tolist()),
        start_velocity=tuple((3 * rng.normal(size=3)).tolist()),
    )
    body = JointedBody("top", Tensor(1.5, rows), (0.0, 0.0, length))  # type: ignore[arg-type]
    return Mechanism((body,), (joint,), gravity=9.81 * (seed % 3 > 0))


def two_links(seed: int) -> Mechanism:
    """Two bodies on turned joints, each a hinge or a slider, with springs and dampers; from seed 4 on the second is a ball."""
    rng = np.random.default_rng(seed)
    types: tuple[JointType, ...] = ("revolute", "prismatic")
    bodies, joints = [], []
    for number in range(2):
        spread = 0.05 * rng.normal(size=(3, 3))
        x, y, z = (tuple(row) for row in (np.diag(rng.uniform(0.2, 0.3, 3)) + spread @ spread.T).tolist())
        bodies.append(JointedBody(f"b{number}", Tensor(1.5, (x, y, z)), tuple((0.4 * rng.normal(size=3)).tolist())))
        kind: JointType = "spherical" if number and seed > 3 else types[int(rng.integers(2))]
        size, rates = (4, 3) if kind == "spherical" else (1, 1)
        joints.append(
            Joint(
                *(f"j{number}", kind, number - 1 if number else WORLD, number),
                *(tuple((0.3 * rng.normal(size=3)).tolist()), tuple(rng.normal(size=4).tolist())),
                axis=tuple(rng.normal(size=3).tolist()),
                armature=0.05 * (size == 1),
                damping=0.1 * number,
                stiffness=5.0 * number * (size == 1),
                start=tuple(rng.normal(size=size).tolist()),
                start_velocity=tuple(rng.normal(size=rates).tolist()),
            )
        )
    return Mechanism(tuple(bodies), tuple(joints), gravity=9.81)


def ball_on_plane(seed: int) -> Scene:
    """A ball that is thrown against a plane, or slips on it, with an incline in half of the scenes."""
    rng = np.random.default_rng(seed)
    incline = float(rng.uniform(0.05, 0.5)) if seed % 2 else 0.0
    radius, height = float(rng.uniform(0.05, 0.2)), float(rng.uniform(0.1, 0.5)) * (seed % 3 > 0)
    normal = np.array([math.sin(incline), 0.0, math.cos(incline)])
    velocity, spin = rng.normal(size=3), 10 * rng.normal(size=3)
    if not height:
        velocity -= (velocity @ normal) * normal
    plane = Plane(float(rng.uniform(0.05, 0.6)), incline=incline, restitution=float(rng.uniform(0.1, 0.7)))
    solid = Solid(Sphere(radius), 1.5)
    return one_body(solid, tuple((radius + height) * normal), tuple(velocity), tuple(spin), plane)


def two_spheres(seed: int) -> Mechanism:
    """Two spheres that fly or roll towards each other."""
    rng = np.random.default_rng(seed)
    plane = Plane(0.3, restitution=0.4) if seed % 2 else None
    radius, bodies = 0.1, []
    for side in (-1, 1):
        size = radius if plane else float(rng.uniform(0.05, 0.15))
        position = (0.5 * side, float(rng.uniform(-0.05, 0.05)), size if plane else 1.0)
        velocity = (-float(rng.uniform(0.5, 1.5)) * side, float(rng.uniform(-0.05, 0.05)), 0.0 if plane else 1.0)
        spin: Vector = tuple((5 * rng.normal(size=3)).tolist())  # type: ignore[assignment]
        start = BodyStart(position, velocity=velocity, rotation=spin)
        bodies.append(JointedBody(f"ball{side}", Solid(Sphere(size), float(rng.uniform(0.5, 2))), start=start))
    law = PairContact((0, 1), 0.0 if plane else float(rng.uniform(0, 0.5)), float(rng.uniform(0.2, 0.9)))
    return Mechanism(tuple(bodies), gravity=9.81, plane=plane, contacts=(law,))
