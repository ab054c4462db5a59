"""Write a run of one body, in flight or with rigid contacts, as a script that needs Pinocchio alone."""

from bodycheck.adapters import scripts
from bodycheck.adapters.contract import Method, SceneUnsupported
from bodycheck.adapters.pinocchio import contact
from bodycheck.adapters.pinocchio.joints import Joints
from bodycheck.adapters.pinocchio.schemes import SCHEMES, rk4, transport
from bodycheck.reference.kinematics import rotate
from bodycheck.reference.requirements import requirements
from bodycheck.reference.scene import Brick, Plane, Scene

SCRIPT = """\
{future}
import numpy as np
import pinocchio as pin

{sampling}
{body}


def acceleration(q, v, passed):
    force = np.zeros(model.nv)
{drag}    return np.asarray(pin.aba(model, data, q, v, force))


{source}

{loop}"""

#: The lines of a script that build the body on its joints and define its initial state.
BODY = """\
model = pin.Model()
model.gravity.linear[:] = 0.0, 0.0, {gravity!r}
joint = 0
{joints}
inertia = pin.Inertia({mass!r}, np.array({lever}), np.array({tensor}).reshape(3, 3))
model.appendBodyToJoint(joint, inertia, pin.SE3.Identity())
data = model.createData()
q = np.array({q})
v = np.array({v})"""

JOINT = "joint = model.addJoint(joint, pin.{kind}(), pin.SE3.Identity(), {name!r})"

#: The lines of a script that compute drag at the centre of mass, which acts on the linear velocity alone.
DRAG = "    x, y, z = v[:3]\n    force[:3] = {drag!r} * np.sqrt(x * x + y * y + z * z) * v[:3]\n"

#: The expression of a script for the state of a body from q and v, by the name of the model. Pinocchio's quaternions are x y z
#: w.
STATES = {
    "translation": "[*q, *{attitude}, *v, 0.0, 0.0, 0.0]",
    "rotation": "[*{position}, q[3], *q[:3], 0.0, 0.0, 0.0, *v]",
    "translation-and-rotation": "[*q[:3], q[6], *q[3:6], *v]",
    "six-coordinates": "[*q[:3], q[6], *q[3:6], *rotate(q[[6, 3, 4, 5]], v[:3]), *v[3:]]",
}


def body_lines(joints: Joints) -> str:
    """Return the lines that build a body on its joints as `model` and `data`, with its initial state `q` and `v`."""
    built, inertia = joints.model, joints.model.inertias[joints.joint]
    kinds = [(built.joints[number].shortname(), built.names[number]) for number in range(1, built.njoints)]
    return BODY.format(
        gravity=float(built.gravity.linear[2]),
        joints="\n".join(JOINT.format(kind=kind, name=name) for kind, name in kinds),
        mass=float(inertia.mass),
        lever=scripts.written(inertia.lever),
        tensor=scripts.written(inertia.inertia.ravel()),
        q=scripts.written(joints.q),
        v=scripts.written(joints.v),
    )


def script(scene: Scene, method: Method, joints: Joints, model: str, duration: float, samples: int) -> str:
    """Return a script that takes the steps of a run in flight, as `bodycheck.adapters.contract.Scripts` says.

    Parameters
    ----------
    scene, method
        The scene, which has no plane, and the method.
    joints
        The body on its joints.
    model
        The name of the model.
    duration, samples
        The duration (s) and the number of samples.

    Raises
    ------
    SceneUnsupported
        If the model contains more than the joints of the body.
    """
    if model not in STATES:
        raise SceneUnsupported(f"a script of the model {model!r}; scripts have the smaller ones: {', '.join(STATES)}")
    initial = scene.initial
    scheme, _ = SCHEMES[method.integrator]
    step = f"for _ in range(step - done):\n    q, v = {scheme.__name__}(model, acceleration, q, v, TIMESTEP)"
    needed = [transport, scheme] if scheme is rk4 else [scheme]
    return SCRIPT.format(
        future=scripts.FUTURE,
        sampling=scripts.sampling(method.timestep, duration, samples),
        body=body_lines(joints),
        drag=DRAG.format(drag=-scene.drag) if requirements(scene).drag else "",
        source=scripts.source(*needed, *([rotate] if model == "six-coordinates" else [])),
        loop=scripts.loop(
            step,
            STATES[model].format(attitude=scripts.written(initial.quaternion), position=scripts.written(initial.position)),
        ),
    )


#: The script of a run with rigid contacts, which has the source of the module `contact`.
CONTACT_SCRIPT = """\
{future}
import math
from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pinocchio as pin

{sampling}
{body}

UNIVERSE = 0
HAS_POINT_CONTACTS = True
{constants}


class EngineDiverged(Exception):
    pass


{source}

# The brick and its surroundings, in SI units.
scene = SimpleNamespace(
    body=SimpleNamespace(mass={mass!r}, shape=Brick({semi_axes})),
    initial=SimpleNamespace(velocity={velocity}, angular_velocity={angular_velocity}),
    gravity={gravity!r},
)
plane = SimpleNamespace(friction={friction!r})
advance = rigid_contact(scene, plane, SimpleNamespace(model=model, joint=joint), model.createData(), TIMESTEP)

{loop}"""

#: The constants of the module `contact` that its functions use.
CONSTANTS = ("SOLVER_TOLERANCE", "SPEED_ROUNDING", "INITIAL_PENALTY", "STALL_RESIDUAL")


def contact_script(
    scene: Scene, plane: Plane, joints: Joints, model: str, timestep: float, duration: float, samples: int
) -> str:
    """Return a script that takes the steps of a run with rigid contacts, as `bodycheck.adapters.contract.Scripts` says.

    Parameters
    ----------
    scene, plane
        The scene and its plane.
    joints
        The body on its joints, with gravity.
    model
        The name of the model.
    timestep
        The time step (s).
    duration, samples
        The duration (s) and the number of samples.

    Raises
    ------
    SceneUnsupported
        If the model contains more than the contacts, or if the contacts cannot model the scene.
    """
    if model != "contact":
        raise SceneUnsupported(f"a script of the model {model!r}; there is one of the model 'contact'")
    contact.rigid_contact(
        scene, plane, joints, joints.model.createData(), timestep
    )  # raises an error if the scene cannot be modelled
    shape, initial = scene.body.shape, scene.initial
    assert isinstance(shape, Brick)  # `rigid_contact` accepts only bricks
    functions = (contact.point_contacts, contact.residual_of, contact.set_tolerance)
    sources = (Brick, *functions, contact.Solver, contact.solver_settings, contact.rigid_contact)
    return CONTACT_SCRIPT.format(
        future=scripts.FUTURE,
        sampling=scripts.sampling(timestep, duration, samples),
        body=body_lines(joints),
        constants="\n".join(f"{name} = {getattr(contact, name)!r}" for name in CONSTANTS),
        source=scripts.source(*sources),
        mass=scene.body.mass,
        semi_axes=scripts.written(shape.semi_axes),
        velocity=scripts.written(initial.velocity),
        angular_velocity=scripts.written(initial.angular_velocity),
        gravity=scene.gravity,
        friction=plane.friction,
        loop=scripts.loop("for _ in range(step - done):\n    q, v = advance(q, v)", "[*q[:3], q[6], *q[3:6], *v]"),
    )
