"""A body between two fingers, for tests."""

from dataclasses import replace
from typing import Any

from bodycheck.reference.mechanisms.control import Controller, Signal
from bodycheck.reference.mechanisms.mechanism import WORLD, BodyStart, Joint, JointedBody, Mechanism, PairContact
from bodycheck.reference.scene import Brick, Cone, Shape, Solid, Sphere, Tensor, Vector

GRAVITY = 9.81

#: The shapes of a gripped body and of fingers.
BLOCK, BALL, POINT, PAD = Brick((0.03, 0.05, 0.3)), Sphere(0.03), Sphere(0.02), Brick((0.01, 0.03, 0.3))


def grip(
    press: Signal,
    friction: float,
    *,
    body: Shape = BLOCK,
    finger: Shape = POINT,
    mass: float = 1.0,
    torsional: float = 0.0,
    cone: Cone = "product",
    aside: tuple[float, float] = (0.0, 0.0),
    velocity: Vector = (0.0, 0.0, 0.0),
    gravity: float = GRAVITY,
    lift: Signal | None = None,
) -> Mechanism:
    """A body at the origin between two fingers along x, on the world or on a carriage along z, whose effort is given.

    aside: the y and z of the fingers (m).
    """
    reach = 0.03 + (0.02 if isinstance(finger, Sphere) else 0.01)
    held = JointedBody("body", Solid(body, mass), start=BodyStart(velocity=velocity))
    fingers = tuple(JointedBody(name, Solid(finger, 0.2)) for name in ("left", "right"))
    parent = WORLD if lift is None else 3
    slides = [
        Joint(name, "prismatic", parent, index, (side * reach, *aside), axis=(-float(side), 0.0, 0.0), **START)
        for index, (name, side) in enumerate((("left", -1), ("right", 1)), start=1)
    ]
    bodies: tuple[JointedBody, ...] = (held, *fingers)
    controllers = [Controller(joint, "effort", effort=press) for joint in (0, 1)]
    if lift is not None:
        moments = ((0.01, 0.0, 0.0), (0.0, 0.01, 0.0), (0.0, 0.0, 0.01))
        bodies = (*bodies, JointedBody("carriage", Tensor(1.4, moments)))
        slides.append(Joint("lift", "prismatic", WORLD, 3, axis=(0.0, 0.0, 1.0), **START))
        controllers.append(Controller(2, "effort", effort=lift))
    contacts = tuple(PairContact((0, index), friction, 0.0, 0.0, torsional, cone) for index in (1, 2))
    return Mechanism(bodies, tuple(slides), (), gravity, contacts=contacts, controllers=tuple(controllers))


#: The start of a prismatic joint at rest.
START: dict[str, Any] = {"start": (0.0,), "start_velocity": (0.0,)}


def with_contacts(scene: Mechanism, *laws: dict[str, Any]) -> Mechanism:
    """The scene with other values of its contacts."""
    return replace(scene, contacts=tuple(replace(pair, **law) for pair, law in zip(scene.contacts, laws, strict=True)))


def pressed(scene: Mechanism, press: float) -> Mechanism:
    """The scene with constant efforts of the fingers in the place of controllers."""
    joints = tuple(replace(joint, effort=press) for joint in scene.joints)
    return replace(scene, joints=joints, controllers=())
