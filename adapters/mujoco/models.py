"""Models of a scene in MuJoCo, from the smallest to the largest: the joints of the body, and the other parts of the XML.

A method may select a model, as in `Euler:model=six-coordinates`. In flight, the body has slide, ball or free joints for the
motions of the scene. On a plane, the smallest model has two slides and a hinge: it contains neither the weight nor the plane
that bears it, and friction by the reference's law is an external force.
"""

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import mujoco
import numpy as np

from bodycheck.adapters.contract import SceneUnsupported, states
from bodycheck.adapters.links import Link
from bodycheck.adapters.mujoco.contact import Parts, numbers_written, written
from bodycheck.reference.kinematics import multiply
from bodycheck.reference.planar import planar_state
from bodycheck.reference.requirements import requirements
from bodycheck.reference.scene import Brick, Cylinder, Ellipsoid, Plane, Quaternion, Scene, Shape, Sphere
from bodycheck.reference.sliding.motion import smallest_friction
from bodycheck.reference.trajectory import Array

#: Depth below the origin (m) of a plane that no body ever touches.
FAR_PLANE_DEPTH_M = 1e6

#: The sensors of the model `everything`.
SENSORS = """
  <sensor>
    <framepos objtype="body" objname="body"/>
    <framequat objtype="body" objname="body"/>
    <framelinvel objtype="body" objname="body"/>
    <frameangvel objtype="body" objname="body"/>
    <framelinacc objtype="body" objname="body"/>
    <subtreeangmom body="body"/>
  </sensor>"""

#: The models of a scene in flight, from the smallest to the largest, each with a description of what it adds to the model
#: before.
IN_FLIGHT = {
    "translation": "three slides",
    "rotation": "a ball joint",
    "translation-and-rotation": "three slides and a ball joint",
    "six-coordinates": "one free joint",
    "far-geometry": "the body's shape and a plane 1000 km below it, collision detection and the constraint solver",
    "everything": "sensors of pose, velocities, acceleration and angular momentum, and energy",
}
#: The models of a scene with a plane, in the same form.
ON_PLANE = {
    "planar": "two slides and a hinge; friction is an external force, evaluated in Python",
    "six-coordinates": "one free joint; friction is the same force",
    "far-geometry": "the body's shape and a plane 1000 km below it, collision detection and the constraint solver",
    "contact": "the plane under the body, with MuJoCo's own contact, friction and gravity instead of the force",
    "everything": "sensors of pose, velocities, acceleration and angular momentum, and energy",
}

#: The models in flight whose XML does not depend on the initial state or the shape of the body.
WITHOUT_STATE = ("translation-and-rotation", "six-coordinates")

#: The models of a scene with a plane in which the body touches the plane.
MODELS_WITH_CONTACT = ("contact", "everything")

#: MuJoCo's callback for passive forces, called with a model and its data.
Force = Callable[[Any, Any], None]


@dataclass(frozen=True)
class Joints:
    """The joints of a body and its initial state in their coordinates.

    Parameters
    ----------
    xml
        The XML elements of the joints.
    qpos, qvel
        The initial state in the coordinates of the joints.
    rows
        Converts n states (n, nq + nv) in these coordinates to rows (n, 13) of the contract.
    origin
        The position (m, world frame) of the body when all coordinates are zero.
    turn
        The rotation from the frame of the scene's body to the frame of the XML's body, as a quaternion (w x y z).
    """

    xml: str
    qpos: tuple[float, ...]
    qvel: tuple[float, ...]
    rows: Callable[[Array], Array]
    origin: tuple[float, ...] = (0.0, 0.0, 0.0)
    turn: Quaternion = (1.0, 0.0, 0.0, 0.0)


def available_models(scene: Scene) -> dict[str, str]:
    """Return the models of a scene, from the smallest to the largest; the values say what each adds to the one before it."""
    needs = requirements(scene)
    if needs.contact:
        return dict(ON_PLANE)
    if needs.rotation == "none":
        others = {"rotation"}
    else:
        others = {"translation", "rotation", "translation-and-rotation"} if needs.translation else {"translation"}
    if scene.body.shape is None:
        others.add("far-geometry")
    return {name: meaning for name, meaning in IN_FLIGHT.items() if name not in others}


def joints(scene: Scene, model: str) -> Joints:
    """Return the joints of a scene's body in a model."""
    kinds = {
        "translation": slides,
        "rotation": ball,
        "translation-and-rotation": slides_and_ball,
        "planar": slides_and_hinge,
    }
    return kinds.get(model, free_joint)(scene)


def slides(scene: Scene) -> Joints:
    """Return three slides along x, y and z. The XML's body has the axes of the world, in which its inertia is rotated."""
    initial = scene.initial

    def rows(seen: Array) -> Array:
        count = len(seen)
        attitude, rates = np.tile(initial.quaternion, (count, 1)), np.zeros((count, 3))
        return states(seen[:, :3], attitude, seen[:, 3:], rates)

    return Joints(slide("1 0 0", "0 1 0", "0 0 1"), initial.position, initial.velocity, rows, turn=initial.quaternion)


def ball(scene: Scene) -> Joints:
    """Return a ball joint at the centre of mass."""
    initial = scene.initial

    def rows(seen: Array) -> Array:
        count = len(seen)
        return states(np.tile(initial.position, (count, 1)), seen[:, :4], np.zeros((count, 3)), seen[:, 4:])

    xml = '<joint type="ball"/>'
    return Joints(xml, initial.quaternion, initial.angular_velocity, rows, initial.position)


def slides_and_ball(scene: Scene) -> Joints:
    """Return three slides and a ball joint, whose coordinates are those of a free joint."""
    return replace(free_joint(scene), xml=slide("1 0 0", "0 1 0", "0 0 1") + '<joint type="ball"/>')


def free_joint(scene: Scene) -> Joints:
    """Return one free joint."""
    initial = scene.initial
    qpos = (*initial.position, *initial.quaternion)
    return Joints("<freejoint/>", qpos, (*initial.velocity, *initial.angular_velocity), lambda seen: seen)


def slides_and_hinge(scene: Scene) -> Joints:
    """Return two slides and a hinge, with the coordinates x, y and yaw. Raises `NotFlat` for a body that does not lie flat."""
    start, height = planar_state(scene).tolist(), scene.initial.position[2]

    def rows(seen: Array) -> Array:
        x, y, yaw, vx, vy, w = seen.T
        nothing = np.zeros(len(seen))
        return states(
            np.column_stack([x, y, nothing + height]),
            np.column_stack([np.cos(yaw / 2), nothing, nothing, np.sin(yaw / 2)]),
            np.column_stack([vx, vy, nothing]),
            np.column_stack([nothing, nothing, w]),
        )

    xml = slide("1 0 0", "0 1 0") + '<joint type="hinge" axis="0 0 1"/>'
    return Joints(xml, tuple(start[:3]), tuple(start[3:]), rows, (0.0, 0.0, height))


def slide(*axes: str) -> str:
    """Return the XML of slide joints along axes, each given as in `1 0 0`."""
    return "".join(f'<joint type="slide" axis="{axis}"/>' for axis in axes)


def principal_axes(scene: Scene, carried: Joints) -> str:
    """Return the quaternion (w x y z) of the principal axes in the frame of the XML's body, as XML text."""
    return numbers_written(*multiply(np.array(carried.turn), np.array(scene.body.axes)).tolist())


def parts(scene: Scene, model: str, contact: Parts | None) -> Parts:
    """Return the XML parts of a model except its body; `contact` are the parts of contact if the model touches the plane."""
    of_model = contact or Parts()
    if contact is None and model in ("far-geometry", *MODELS_WITH_CONTACT) and scene.body.shape is not None:
        plane = f'<geom type="plane" size="0 0 1" pos="0 0 {-FAR_PLANE_DEPTH_M!r}"/>'
        of_model = replace(of_model, flags="", plane=plane, geoms=geometry(scene.body.shape))
    return replace(of_model, flags='energy="enable"', sensors=SENSORS) if model == "everything" else of_model


def geometry(shape: Shape) -> str:
    """Return the XML of a body's shape, aligned with the axes of the body."""
    size: tuple[float, ...]
    match shape:
        case Brick(semi_axes):
            kind, size = "box", semi_axes
        case Ellipsoid(semi_axes):
            kind, size = "ellipsoid", semi_axes
        case Cylinder(radius, half_length):
            kind, size = "cylinder", (radius, half_length)
        case Sphere(radius):
            kind, size = "sphere", (radius,)
    return f'<geom type="{kind}" size="{numbers_written(*size)}"/>'


def drag_force(drag: float, data: Any) -> Force:
    """Return drag, with the coefficient `drag` (kg/m), as a force on joints whose first velocities are the body's (world).

    `data` must be the data that is stepped. Its arrays are looked up only once, because a look-up costs as much time as the
    arithmetic.
    """
    velocities, forces = data.qvel[:3], data.qfrc_passive[:3]

    def force(_model: Any, _data: Any) -> None:
        x, y, z = velocities.tolist()
        slowing = -drag * math.sqrt(x * x + y * y + z * z)
        forces[:] = slowing * x, slowing * y, slowing * z

    return force


def friction_force(scene: Scene, plane: Plane, timestep: float, data: Any) -> Force:
    """Return the friction of a flat body as a force on its velocities along x and y and on the last velocity, its spin.

    If friction would reverse the motion within a step, in the sense of the scalar product of the kinetic energy, it is reduced
    to the force that stops the body in that step. If the law brakes translation and spin separately, each of them stops
    separately.

    Parameters
    ----------
    scene
        The scene with the body.
    plane
        The plane with the law of friction.
    timestep
        The time step (s).
    data
        The MuJoCo data that is stepped; its arrays are looked up only once.
    """
    law, apart = smallest_friction(scene, plane)
    mass, moment = scene.body.mass, scene.body.moments[2]
    velocities, coordinates, forces = data.qvel, data.qpos, data.qfrc_passive
    others = (0.0,) * (len(velocities) - 3)

    def force(_model: Any, _data: Any) -> None:
        x, y, *_, w = velocities.tolist()
        if others:
            *_, real, _, _, k = coordinates.tolist()
            cosine, sine = real * real - k * k, 2 * real * k
        else:
            *_, yaw = coordinates.tolist()
            cosine, sine = math.cos(yaw), math.sin(yaw)
        f1, f2, torque = law(cosine * x + sine * y, cosine * y - sine * x, w)
        fx, fy = cosine * f1 - sine * f2, sine * f1 + cosine * f2
        sliding = mass * (x * x + y * y) + timestep * (fx * x + fy * y)
        spinning = moment * w * w + timestep * torque * w
        if not apart:
            sliding = spinning = sliding + spinning
        if sliding <= 0:
            fx, fy = -mass * x / timestep, -mass * y / timestep
        if spinning <= 0:
            torque = -moment * w / timestep
        forces[:] = fx, fy, *others, torque

    return force


@lru_cache(maxsize=8)
def compiled_model(xml: str) -> mujoco.MjModel:
    """Return MuJoCo's model of an XML text. Raises `SceneUnsupported` if MuJoCo refuses it.

    The last models are cached. Runs of one scene and method can share a model, because the initial state is in MuJoCo's data
    and nothing changes a model. Timing, and the comparison of runs with perturbed initial states, need the same model many
    times.
    """
    try:
        return mujoco.MjModel.from_xml_string(xml)
    except ValueError as error:
        raise SceneUnsupported(f"MuJoCo refuses the model: {without_lines(str(error))}") from error


def without_lines(message: str) -> str:
    """Return a message of MuJoCo's compiler on one line, without numbers and lines of an XML that no user sees."""
    return " ".join(re.sub(r"\s*Element name '(.*)', id \d+, line \d+", r": '\1'", message, flags=re.DOTALL).split())


def inertial(link: Link) -> str:
    """Return the XML element of a link's inertia."""
    attributes = {"pos": numbers_written(*link.center_of_mass), "mass": numbers_written(link.mass)}
    return f"<inertial {written(attributes | {'fullinertia': numbers_written(*link.inertia)})}/>"


def welded(links: Sequence[Link]) -> str:
    """Return the XML elements of links that are welded to the enclosing body. Their poses are relative to its frame."""
    poses = ({"pos": numbers_written(*link.position), "quat": numbers_written(*link.quaternion)} for link in links)
    return "\n      ".join(f"<body {written(pose)}>{inertial(link)}</body>" for pose, link in zip(poses, links, strict=True))
