"""Build OpenSim's model of a scene: a body on a free joint, with contact or drag if the scene has them."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import opensim

from bodycheck.adapters.contract import SceneUnsupported
from bodycheck.adapters.links import Link, links_of
from bodycheck.adapters.simbody.attitude import angles, coordinates, use_quaternions
from bodycheck.adapters.simbody.contact import add_contact
from bodycheck.reference.kinematics import rotate
from bodycheck.reference.scene import Scene

#: The features of a scene that only releases of OpenSim with forces along a path of any function have; see `Engine.models`.
DRAG = frozenset({"drag"} if hasattr(opensim, "ExpressionBasedPathForce") else ())


def described(scene: Scene, links: Sequence[Link] = ()) -> Any:
    """Return OpenSim's model of a scene.

    Parameters
    ----------
    scene
        The scene.
    links
        The links that replace the scene's body; if empty, the body stays.

    Raises
    ------
    SceneUnsupported
        If OpenSim refuses the body, or has no such contact.
    """
    model = opensim.Model()
    model.setGravity(opensim.Vec3(0.0, 0.0, -scene.gravity))
    first, *others = links_of(scene, links)
    body = added(model, "body", first)
    joint = opensim.FreeJoint("joint", model.getGround(), body)
    model.addJoint(joint)
    for number, link in enumerate(others, 1):
        weld(model, number, body, link)
    if scene.plane is not None:
        add_contact(model, body, scene, scene.plane)
    if scene.drag:
        add_drag(model, [joint.getCoordinate(3 + axis).getAbsolutePathString() for axis in range(3)], scene.drag)
    return model


def add_drag(model: Any, coordinates: Sequence[str], drag: float) -> None:
    """Add the drag (kg/m) of a body to a model, as a force that OpenSim evaluates wherever it evaluates forces.

    OpenSim's only forces with an expression of several velocities are those along a path: the lengthening speed of a
    `FunctionBasedPath` may be any function of coordinates and speeds, and an `ExpressionBasedPathForce` may have this speed as
    its tension. Each of the three paths acts on one of the coordinates x, y and z, which are given by their paths in the model.
    """
    for axis, speed in enumerate(("u", "v", "w")):
        path = opensim.FunctionBasedPath()
        path.setLengthFunction(expression("0*x", "xyz"))
        for number, coordinate in enumerate(coordinates):
            path.appendCoordinatePath(coordinate)
            path.appendMomentArmFunction(expression(f"0*x+{int(number == axis)}", "xyz"))
        path.setLengtheningSpeedFunction(expression(f"-{drag!r}*sqrt(u*u+v*v+w*w)*{speed}", "xyzuvw"))
        force = opensim.ExpressionBasedPathForce(f"drag_{axis}", 0.0, "ldot", False)
        force.set_path(path)
        model.addForce(force)


def expression(text: str, variables: str) -> Any:
    """Return OpenSim's function of variables, each a single letter."""
    function = opensim.ExpressionBasedFunction()
    function.setExpression(text)
    function.setVariables(opensim.StdVectorString(list(variables)))
    return function


def added(model: Any, name: str, link: Link) -> Any:
    """Add a link to a model, and return it. Raises `SceneUnsupported` if OpenSim refuses it."""
    try:
        body = opensim.Body(name, link.mass, opensim.Vec3(*link.center_of_mass), opensim.Inertia(*link.inertia))
    except RuntimeError as error:
        raise SceneUnsupported(f"OpenSim refuses the body: {' '.join(str(error).split())}") from error
    model.addBody(body)
    return body


def weld(model: Any, number: int, body: Any, link: Link) -> None:
    """Add a link to a model, welded to one of its bodies. Raises `SceneUnsupported` if OpenSim refuses the link."""
    origin, turn, nothing = opensim.Vec3(*link.position), opensim.Vec3(*angles(link.quaternion)), opensim.Vec3(0.0)
    part = added(model, f"link_{number}", link)
    model.addJoint(opensim.WeldJoint(f"weld_{number}", body, origin, turn, part, nothing, nothing))


def started(scene: Scene, model: Any, quaternions: bool) -> Any:
    """Return a model's state at the initial state of a scene, with quaternions or with angles."""
    state = model.initSystem()
    if quaternions:
        use_quaternions(model, state)
    initial = scene.initial
    spin = rotate(np.array(initial.quaternion), np.array(initial.angular_velocity))
    q, u = state.updQ(), state.updU()
    for index, number in enumerate(coordinates(initial, quaternions)):
        q.set(index, number)
    for index, number in enumerate([*spin.tolist(), *initial.velocity]):
        u.set(index, number)
    return state
