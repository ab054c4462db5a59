"""Scenes of bodies that touch an inclined plane and each other."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bodycheck.reference.mechanisms.mechanism import BodyStart, JointedBody, Mechanism
from bodycheck.reference.scene import Body, Brick, Cylinder, Plane, Scene, Shape, Solid, Sphere, State, Vector
from bodycheck.reference.trajectory import Array

GRAVITY, RADIUS, MASS, INCLINE = 9.81, 0.1, 2.0, 0.3
DOWNHILL = GRAVITY * math.sin(INCLINE)
BALL, CUBE = Sphere(RADIUS), Brick((RADIUS, RADIUS, RADIUS))
OF_BALL, OF_CUBE = Body(MASS, (0.4 * MASS * RADIUS**2,) * 3, BALL), Body(MASS, (2 / 3 * MASS * RADIUS**2,) * 3, CUBE)


def on(plane: Plane, body: Body, height: float = RADIUS, **others: object) -> Scene:
    """A body above the origin of a plane, along its axes."""
    return replace(Scene(body, start(plane, height), GRAVITY, plane), **others)  # type: ignore[arg-type]


def start(plane: Plane, height: float) -> State:
    x, y, z = (height * part for part in plane.normal)
    return State((x, y, z), (math.cos(plane.incline / 2), 0.0, math.sin(plane.incline / 2), 0.0))


def several(shapes: Sequence[tuple[Shape, Vector]], plane: Plane, **others: object) -> Mechanism:
    """Free bodies of equal mass at positions along the axes of a plane."""
    (nx, _, nz), attitude = plane.normal, start(plane, 0.0).quaternion
    made = tuple(
        JointedBody(f"body-{place}", Solid(shape, MASS), start=BodyStart((nz * x + nx * z, y, nz * z - nx * x), attitude))
        for place, (shape, (x, y, z)) in enumerate(shapes)
    )
    return replace(Mechanism(made, gravity=GRAVITY, plane=plane), **others)  # type: ignore[arg-type]


def lying(plane: Plane) -> Mechanism:
    """A cylinder on its side, with its axis across the plane."""
    scene = several([(Cylinder(RADIUS, RADIUS), (0.0, 0.0, RADIUS))], plane)
    (body,) = scene.bodies
    assert body.start is not None
    w, _, y, _ = body.start.attitude
    half = math.sqrt(0.5)
    return replace(
        scene, bodies=(replace(body, start=replace(body.start, attitude=(w * half, w * half, y * half, -y * half))),)
    )


def downhill(state: Array) -> Array:
    """Velocities down the plane."""
    return np.asarray(math.cos(INCLINE) * state[..., 7] - math.sin(INCLINE) * state[..., 9])
