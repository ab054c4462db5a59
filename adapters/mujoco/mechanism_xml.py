"""Write a mechanism as MuJoCo's XML, and define the options of a method that change its constraints.

A body of the file is a body of MuJoCo inside the body of its parent. Its pose there is the joint's frame, so that `xquat` is
the attitude of the body's frame in the file. A joint of the file becomes:

- revolute, prismatic: a hinge, a slide.
- spherical: a ball.
- free, and a body that is the child of no joint: a free joint, which MuJoCo allows for children of the world only. On another
  body it becomes three slides and a ball, whose velocities are the velocities of the joint in the file.
- universal: two hinges; planar: two slides and a hinge. Joints of one body act one after another.
- fixed: no joint. A body of MuJoCo without a joint moves with its parent and keeps its own mass, tensor and frame in the model.
  MuJoCo would fuse such bodies into their parents with `fusestatic`, which is off in MJCF (and on in URDF).

A body without mass between two joints is no body of MuJoCo: both joints are joints of the body behind it; see `massless`.

Armature, damping, stiffness with `springref`, and `frictionloss` are attributes of a joint; `limits` has those of stops. A loop
is a `connect` between two sites, and the rule of a joint that follows another one is an equality `joint`. Both are soft
constraints. Angles are in radians, and `balanceinertia` is off, so that MuJoCo refuses inertias that it cannot use instead of
changing them.

An option that is not given is not written into the XML, and keeps the default of the installed MuJoCo. The keys are:

- solref, solimp: the stiffness and the softness of the constraints that close loops and that make joints follow others.
- solreffriction, solimpfriction: the stiffness and the softness of the dry friction of joints.
- solreflimit, solimplimit: the stiffness and the softness of the limits of joints.
- noslip: the number of iterations of MuJoCo's noslip solver, which acts on dry friction.
- eulerdamp: with `disable`, `Euler` computes the damping of joints from the velocity before the step, else from the velocity
  after the step.
"""

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import TYPE_CHECKING
from xml.etree import ElementTree

from bodycheck.adapters.contract import Kind, Option, SceneUnsupported, choice
from bodycheck.adapters.mujoco import contact
from bodycheck.adapters.mujoco.contact import numbers_written
from bodycheck.adapters.mujoco.limits import attributes, limited
from bodycheck.reference.mechanisms import exact
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, JointedBody, Mechanism, depth_first

if TYPE_CHECKING:
    from bodycheck.adapters.mujoco.massless import Mounted, Seat

#: The kinds of scene with loops and friction of joints.
JOINTED: frozenset[Kind] = frozenset({"mechanism"})

#: The options that each integrator has for a mechanism; some of them also have an effect on a plane.
OPTIONS: dict[str, Option] = {
    **{
        key: replace(contact.OPTIONS[key], kinds=contact.OPTIONS[key].kinds | JOINTED) for key in ("solref", "solimp", "noslip")
    },
    "solreffriction": replace(contact.OPTIONS["solref"], kinds=JOINTED),
    "solimpfriction": replace(contact.OPTIONS["solimp"], kinds=JOINTED),
    "solreflimit": replace(contact.OPTIONS["solref"], kinds=JOINTED),
    "solimplimit": replace(contact.OPTIONS["solimp"], kinds=JOINTED),
}

#: The requirements of mechanisms that are soft constraints, and the options of their softness.
SOFT = {
    "loops": "solref, solimp",
    "mimic joints": "solref, solimp",
    "joint friction": "solreffriction, solimpfriction",
    "rigid stops": "solreflimit, solimplimit",
    "elastic stops": "solreflimit, solimplimit",
}

#: The options of `Euler` for a mechanism.
OF_EULER = {"eulerdamp": choice("disable", kinds=JOINTED)}

#: MuJoCo's joints for each type of joint, each as its kind and the name of its axis in the frame of the joint: "given" for the
#: axis of the joint in the file, and empty for a ball.
PARTS: dict[str, tuple[tuple[str, str], ...]] = {
    "revolute": (("hinge", "given"),),
    "prismatic": (("slide", "given"),),
    "spherical": (("ball", ""),),
    "free": (("slide", "x"), ("slide", "y"), ("slide", "z"), ("ball", "")),
    "fixed": (),
    "universal": (("hinge", "x"), ("hinge", "y")),
    "planar": (("slide", "x"), ("slide", "y"), ("hinge", "z")),
}

#: The attributes of joints beyond those of their own numbers, by the names of the joints.
More = Mapping[str, Mapping[str, str]]

#: The three hinges that replace a ball.
THREE_HINGES = (("hinge", "x"), ("hinge", "y"), ("hinge", "z"))


def document(
    mechanism: Mechanism,
    timestep: float,
    integrator: str,
    chosen: Mapping[str, str],
    inverse_inertias: Mapping[str, float] = MappingProxyType({}),
) -> str:
    """Return the XML of a mechanism.

    Parameters
    ----------
    mechanism
        The mechanism.
    timestep, integrator
        The time step (s) and MuJoCo's name of the integrator.
    chosen
        The options of the method, keyed by their names.
    inverse_inertias
        `dof_invweight0` of joints by their names; elastic stops of other joints have the softness for 1.

    Raises
    ------
    SceneUnsupported
        If an option does not fit the mechanism, if MuJoCo would silently change it, or for a moving body without mass that
        MuJoCo would refuse.
    """
    hinges = chosen.get("model") == "three-hinges"
    check_options(mechanism, timestep, integrator, chosen)
    root = ElementTree.Element("mujoco")
    ElementTree.SubElement(root, "compiler", angle="radian", balanceinertia="false", inertiafromgeom="false")
    option = {"timestep": repr(timestep), "integrator": integrator, "gravity": numbers_written(0, 0, -mechanism.gravity)}
    if "noslip" in chosen:
        option["noslip_iterations"] = chosen["noslip"]
    limits = {
        joint.name: attributes(joint, timestep, chosen, inverse_inertias.get(joint.name, 1.0))
        for joint in limited(mechanism, chosen)
    }
    held = constrained(mechanism) or bool(limits)
    flags = {"contact": "disable"} if held else {"contact": "disable", "constraint": "disable"}
    if "eulerdamp" in chosen:
        flags["eulerdamp"] = chosen["eulerdamp"]
    ElementTree.SubElement(ElementTree.SubElement(root, "option", option), "flag", flags)
    friction = {key: chosen[key] for key in ("solreffriction", "solimpfriction") if key in chosen}
    more = {joint.name: limits.get(joint.name, {}) | (friction if joint.friction else {}) for joint in mechanism.joints}
    elements = add_bodies(ElementTree.SubElement(root, "worldbody"), mechanism, more, hinges)
    add_equalities(root, elements, mechanism, {key: chosen[key] for key in ("solref", "solimp") if key in chosen})
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode")


def add_bodies(
    world: ElementTree.Element, mechanism: Mechanism, more: More, hinges: bool = False
) -> dict[int, ElementTree.Element]:
    """Add the bodies of a mechanism to the element of the world, and return the elements of all by their indices."""
    from bodycheck.adapters.mujoco.massless import seats  # it imports the exact arithmetic, which only mechanisms need

    elements = {WORLD: world}
    for index, seat in seats(mechanism, depth_first(mechanism)).items():
        parent, joint = elements[seat.parent], mechanism.joint_of[index]
        elements[index] = add_body(parent, mechanism.bodies[index], joint, seat, more, hinges)
    return elements


def constrained(mechanism: Mechanism) -> bool:
    """Return whether a mechanism has constraints for MuJoCo's solver: loops, joints that follow others, or dry friction."""
    return bool(mechanism.loops) or any(joint.friction or joint.mimic for joint in mechanism.joints)


def check_options(mechanism: Mechanism, timestep: float, integrator: str, chosen: Mapping[str, str]) -> None:
    """Raise `SceneUnsupported` for options without an effect, and for a time constant that MuJoCo would raise."""
    rubbing, stopped = any(joint.friction for joint in mechanism.joints), bool(limited(mechanism, chosen))
    held = bool(mechanism.loops) or any(joint.mimic for joint in mechanism.joints)
    for key, present, lacking in (
        ("solref", held, "loops and mimic joints"),
        ("solimp", held, "loops and mimic joints"),
        ("solreffriction", rubbing, "dry friction"),
        ("solimpfriction", rubbing, "dry friction"),
        ("solreflimit", stopped, "limits"),
        ("solimplimit", stopped, "limits"),
        ("noslip", rubbing, "dry friction"),
        ("eulerdamp", any(joint.damping for joint in mechanism.joints), "damping"),
    ):
        if key in chosen and not present:
            raise SceneUnsupported(f"the option {key}={chosen[key]} for a mechanism without {lacking}")
    for key in ("solref", "solreffriction", "solreflimit"):
        contact.check_time_constant(chosen, contact.shortest_time_constant(integrator, timestep), key)


def add_body(
    parent: ElementTree.Element, body: JointedBody, joint: Joint | None, seat: "Seat", more: More, hinges: bool
) -> ElementTree.Element:
    """Add a body, with its joints and its inertia, to the element of its parent, and return its element.

    `seat` is its place in MuJoCo's tree, and `hinges` is whether three hinges replace a ball.
    """
    attributes = {"name": body.name}
    if joint is not None:
        attributes |= {"pos": numbers_written(*seat.position), "quat": numbers_written(*seat.quaternion)}
    element = ElementTree.SubElement(parent, "body", attributes)
    if joint is None or (joint.type == "free" and joint.parent == WORLD):
        ElementTree.SubElement(element, "freejoint", {} if joint is None else {"name": joint.name})
    else:
        for mounted in seat.joints:
            add_joints(element, mounted, more[mounted.joint.name], hinges)
    inertia = exact.nearest_inertia(body)
    inertial = {"pos": numbers_written(*inertia.centre), "mass": numbers_written(inertia.mass)}
    if any(inertia.tensor[3:]):
        inertial["fullinertia"] = numbers_written(*inertia.tensor)
    else:
        inertial["diaginertia"] = numbers_written(*inertia.tensor[:3])
    ElementTree.SubElement(element, "inertial", inertial)
    return element


def names_of_parts(joint: Joint, hinges: bool) -> list[str]:
    """Return the names of MuJoCo's joints that make up a joint. `hinges` is whether three hinges replace a ball."""
    count = len(parts_of(joint, hinges))
    return [joint.name] if count == 1 else [f"{joint.name}:{number + 1}" for number in range(count)]


def parts_of(joint: Joint, hinges: bool) -> tuple[tuple[str, str], ...]:
    """Return MuJoCo's joints that make up a joint, as in `PARTS`. `hinges` is whether three hinges replace a ball."""
    return THREE_HINGES if hinges and joint.type == "spherical" else PARTS[joint.type]


def add_joints(element: ElementTree.Element, mounted: "Mounted", more: Mapping[str, str], hinges: bool) -> None:
    """Add the MuJoCo joints that make up a joint, with more attributes, to the element of the body that they move."""
    joint = mounted.joint
    numbers = {
        "armature": joint.armature,
        "damping": joint.damping,
        "stiffness": joint.stiffness,
        "springref": joint.rest,
        "frictionloss": joint.friction,
    }
    written = {key: numbers_written(value) for key, value in numbers.items() if value}
    anchor = {"pos": numbers_written(*mounted.anchor)} if any(mounted.anchor) else {}
    for name, (kind, axis) in zip(names_of_parts(joint, hinges), parts_of(joint, hinges), strict=True):
        attributes = {"name": name, "type": kind} | anchor
        if axis:
            attributes["axis"] = numbers_written(*mounted.axis(axis))
        ElementTree.SubElement(element, "joint", attributes | written | dict(more))


def add_equalities(
    root: ElementTree.Element, elements: Mapping[int, ElementTree.Element], mechanism: Mechanism, softness: Mapping[str, str]
) -> None:
    """Add the loops of a mechanism, each a `connect` between two sites, and the rules of joints that follow others."""
    following = [(joint.name, joint.mimic) for joint in mechanism.joints if joint.mimic is not None]
    if not mechanism.loops and not following:
        return
    equality = ElementTree.SubElement(root, "equality")
    for number, loop in enumerate(mechanism.loops, start=1):
        sites = (f"loop {number}:1", f"loop {number}:2")
        for site, body, point in zip(sites, loop.bodies, loop.points, strict=True):
            ElementTree.SubElement(elements[body], "site", name=site, pos=numbers_written(*point))
        ElementTree.SubElement(equality, "connect", {"site1": sites[0], "site2": sites[1], **softness})
    for follower, rule in following:
        polynomial = numbers_written(rule.offset, rule.multiplier, 0, 0, 0)
        pair = {"joint1": follower, "joint2": mechanism.joints[rule.joint].name, "polycoef": polynomial}
        ElementTree.SubElement(equality, "joint", {**pair, **softness})
