"""Faults that a reader of robot models can have, planted in a clean model, with the cause and the subject that are to be named.

A fault is a function from the model that the file describes to the model that an engine has made of it, so that several can be
planted at once. Some need something in the file first, such as damping that can be ignored.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from random import Random

import numpy as np

from bodycheck.reference.robots.model import Mimic, RobotLink, RobotModel, Wide, with_joint, with_link
from tests.support.robot_trees import random_joint, random_link, random_rotation

Change = Callable[[RobotModel], RobotModel]


@dataclass(frozen=True)
class PlantedFault:
    """A fault.

    Attributes
    ----------
    name
        What it is, for the name of a test.
    cause, subject
        The cause to be named, and the link, the joint, or `model` that it is in.
    in_engine
        What the engine makes of the model of the file.
    in_file
        What the file has besides the clean model.
    """

    name: str
    cause: str
    subject: str
    in_engine: Change
    in_file: Change = lambda model: model


def clean_model() -> RobotModel:
    """A model for faults: a chain of four moving links, of which the first carries a welded one. The root has no mass.

    The links are arm_1, arm_2, slide, and hand on the joints shoulder, elbow, rail and wrist. The tool is welded to arm_1.
    """
    random, zero = Random(23), np.zeros(3, np.longdouble)
    names = ("arm_1", "tool", "arm_2", "slide", "hand")
    links = (RobotLink("base", 0.0, zero, np.zeros((3, 3), np.longdouble)), *(random_link(random, name) for name in names))
    joints = (
        random_joint(random, "shoulder", "revolute", 0, 1),
        random_joint(random, "weld", "fixed", 1, 2),
        random_joint(random, "elbow", "revolute", 1, 3),
        random_joint(random, "rail", "prismatic", 3, 4),
        random_joint(random, "wrist", "revolute", 4, 5),
    )
    return RobotModel("clean", links, joints)


#: The axes along which the file gives the inertia of each link, in the link's frame: see `urdf` for a file that has them.
INERTIAL_AXES = {link.name: random_rotation(Random(place)) for place, link in enumerate(clean_model().links)}


def link_of(model: RobotModel, name: str) -> RobotLink:
    """The link of a name."""
    return next(link for link in model.links if link.name == name)


def _turned(name: str, turn: Callable[[Wide], Wide]) -> Change:
    """The inertia of a link, turned by a rotation that follows from the axes along which the file gives it."""
    rotation = turn(INERTIAL_AXES[name])
    return lambda model: with_link(model, name, inertia=rotation @ link_of(model, name).inertia @ rotation.T)


def _scaled(name: str, quantity: str, factor: float) -> Change:
    return lambda model: with_link(model, name, **{quantity: factor * getattr(link_of(model, name), quantity)})


def _without_mass(name: str) -> Change:
    return lambda model: with_link(model, name, mass=0.0, inertia=0 * link_of(model, name).inertia)


def _weld_unturned(name: str, weld: str) -> Change:
    """A welded link that is joined to its carrier as if the frames of both had the same axes."""

    def change(model: RobotModel) -> RobotModel:
        link, joint = link_of(model, name), next(joint for joint in model.joints if joint.name == weld)
        back = joint.rotation.T
        return with_link(model, name, center_of_mass=back @ link.center_of_mass, inertia=back @ link.inertia @ back.T)

    return change


def _weld_inertia_unturned(name: str, weld: str) -> Change:
    """A welded link whose inertia, but not whose place, is joined to its carrier as if both frames had the same axes."""

    def change(model: RobotModel) -> RobotModel:
        link, joint = link_of(model, name), next(joint for joint in model.joints if joint.name == weld)
        return with_link(model, name, inertia=joint.rotation.T @ link.inertia @ joint.rotation)

    return change


def _with_moments(name: str, *moments: float) -> Change:
    """A link with other principal moments (kg m^2) along the axes in which the file gives its inertia."""
    axes = INERTIAL_AXES[name]
    return lambda model: with_link(model, name, inertia=axes @ np.diag(np.array(moments, np.longdouble)) @ axes.T)


def _joint(name: str, **changes: object) -> Change:
    return lambda model: with_joint(model, name, **changes)


def _root_mass(mass: float) -> Change:
    """A root with a mass, and moments as of a ball of 0.2 m."""
    moments = mass * 0.016 * np.eye(3, dtype=np.longdouble)
    return lambda model: with_link(model, model.links[model.root].name, mass=mass, inertia=moments)


#: The faults that a model can have.
FAULTS = (
    PlantedFault("armature", "armature", "elbow", _joint("elbow", armature=0.1)),
    PlantedFault("armature-lost", "armature", "elbow", _joint("elbow", armature=0.0), _joint("elbow", armature=0.1)),
    PlantedFault("inertia-unturned", "inertia-turned", "arm_2", _turned("arm_2", lambda axes: axes.T)),
    PlantedFault("inertia-turned-twice", "inertia-turned", "arm_2", _turned("arm_2", lambda axes: axes)),
    PlantedFault("inertia-turned-back", "inertia-turned", "arm_2", _turned("arm_2", lambda axes: axes.T @ axes.T)),
    PlantedFault("inertia-dropped", "inertia-dropped", "arm_2", _scaled("arm_2", "inertia", 0.0)),
    PlantedFault("weld-lost", "inertia-fused", "arm_1", _without_mass("tool")),
    PlantedFault("weld-inertia-dropped", "inertia-fused", "arm_1", _scaled("tool", "inertia", 0.0)),
    PlantedFault("weld-unturned", "inertia-fused", "arm_1", _weld_unturned("tool", "weld")),
    PlantedFault("weld-inertia-unturned", "inertia-fused", "arm_1", _weld_inertia_unturned("tool", "weld")),
    PlantedFault(
        *("inertia-balanced", "inertia-balanced", "hand"),
        *(_with_moments("hand", 0.03, 0.03, 0.03), _with_moments("hand", 0.01, 0.02, 0.06)),
    ),
    PlantedFault("mass", "mass", "slide", _scaled("slide", "mass", 1.125)),
    PlantedFault("center-of-mass", "center-of-mass", "hand", _scaled("hand", "center_of_mass", 0.5)),
    PlantedFault("center-of-mass-lost", "center-of-mass", "hand", _scaled("hand", "center_of_mass", 0.0)),
    PlantedFault("damping", "damping-ignored", "wrist", _joint("wrist", damping=0.0), _joint("wrist", damping=0.5)),
    PlantedFault("friction", "friction-ignored", "rail", _joint("rail", friction=0.0), _joint("rail", friction=0.25)),
    PlantedFault(
        *("mimic", "mimic-ignored", "wrist"),
        *(_joint("wrist", mimic=None), _joint("wrist", mimic=Mimic("elbow", -0.5, 0.25))),
    ),
    PlantedFault("base-welded", "base-welded", "model", _without_mass("base"), _root_mass(4.0)),
)


def planted(*faults: PlantedFault) -> tuple[RobotModel, RobotModel]:
    """The model of the file and that of the engine with some faults."""
    file = clean_model()
    for fault in faults:
        file = fault.in_file(file)
    engine = file
    for fault in faults:
        engine = fault.in_engine(engine)
    return replace(file, name="file"), replace(engine, name="engine")
