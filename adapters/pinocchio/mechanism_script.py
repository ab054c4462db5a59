"""Write a run of a mechanism as a script that needs Pinocchio alone."""

from collections.abc import Callable, Sequence
from typing import Any

import pinocchio as pin

from bodycheck.adapters import scripts
from bodycheck.adapters.contract import Method
from bodycheck.adapters.pinocchio import mechanisms
from bodycheck.adapters.pinocchio.driving import Actuated, Indices
from bodycheck.adapters.pinocchio.mechanism_model import Built, built
from bodycheck.adapters.pinocchio.schemes import SCHEMES, rk4, transport
from bodycheck.reference.kinematics import rotate
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.trajectory import Array

SCRIPT = """\
{future}
import numpy as np
import pinocchio as pin

{sampling}
BODIES = {bodies}


def place(turn, origin):
    return pin.SE3(np.array(turn).reshape(3, 3), np.array(origin))


model = pin.Model()
model.gravity.linear[:] = 0.0, 0.0, {gravity!r}
{joints}
{followers}{armature}
q = np.array({q})
v = np.array({v})
# The joint of each body, and the body's frame in that of the joint; the centres of mass in the bodies' frames.
PLACES = [
{places}
]
CENTRES = np.array({centres})
# Efforts, dampings, stiffnesses, rests and dry frictions of the velocities, and the places in q of their coordinates.
FORCES = [
{forces}
]
{rules}

{source}
{driven}
data = model.createData()
forces = {forces_of}
{acceleration}
states = states_of(model, data, PLACES, CENTRES)
step_length = np.full(model.nv, TIMESTEP)
{loop}"""

JOINT = """\
model.addJoint({parent}, pin.JointModel{kind}({numbers}), {frame}, {name!r})
model.inertias[{place}] = pin.Inertia({mass!r}, np.array({lever}), np.array({tensor}).reshape(3, 3))"""


#: The line of a script that makes a joint of the model follow another one.
FOLLOWER = "model = pin.transformJointIntoMimic(model, {0.leader}, {0.joint}, {0.ratio!r}, {0.offset!r})\n"

#: The lines of a script that define the numbers of `mechanisms.rules_of`.
RULES = """\
# Of the joints that follow others: the ratios and the offsets, and the places in q and in v of those that they follow.
RULES = [
{}
]
"""

#: The lines of a script that define the driven joints.
DRIVEN = """
{controls}

{source}

joints = Actuated(forces_of(*FORCES), {in_q}, {in_v}, len(FORCES[0]), TIMESTEP)
if controls.continuous:
    joints.obey(controls.law)
"""


def script(mechanism: Mechanism, method: Method, duration: float, samples: int) -> str:
    """Return a script for Pinocchio alone, as `Scripts.script` does. Raises `SceneUnsupported`."""
    mechanism = mechanisms.modelled(mechanism, method)
    scheme, body_twist = SCHEMES[method.integrator]
    built_mechanism = built(mechanism, body_twist, method.option("model") == "three-hinges")
    followers = bool(built_mechanism.followers)
    dynamics: list[Callable[..., Any]]
    if followers:
        dynamics = [mechanisms.all_joints, mechanisms.with_followers, mechanisms.coupled]
    else:
        dynamics = [mechanisms.constrained if mechanism.loops else mechanisms.unconstrained]
    drive = scripts.controls_of(mechanism, method)
    needed = [transport, scheme] if scheme is rk4 else [scheme]
    forces = "joints.total" if drive else "forces_of(*FORCES)"
    return SCRIPT.format(
        future=scripts.FUTURE,
        sampling=scripts.sampling(method.timestep, duration, samples),
        bodies=[body.name for body in mechanism.bodies],
        gravity=-mechanism.gravity,
        joints=joint_lines(built_mechanism),
        followers="".join(FOLLOWER.format(follower) for follower in built_mechanism.followers),
        armature=armature_line(mechanism, built_mechanism),
        q=scripts.written(built_mechanism.q),
        v=scripts.written(built_mechanism.v),
        places="\n".join(f"    ({joint}, {placed(frame)})," for joint, frame in built_mechanism.places),
        centres=mechanisms.centres_of(mechanism).tolist(),
        forces=arrays(mechanisms.joint_numbers(mechanism, built_mechanism)),
        rules=RULES.format(arrays(mechanisms.rules_of(built_mechanism))) if followers else "",
        source=scripts.source(rotate, mechanisms.forces_of, *dynamics, mechanisms.states_of, *needed),
        driven=driven_lines(drive, mechanism, built_mechanism),
        forces_of=f"with_followers({forces}, *RULES)" if followers else forces,
        acceleration=acceleration_line(mechanism, built_mechanism, method),
        loop=scripts.mechanism_loop(
            advance_lines(scheme.__name__, bool(drive), followers),
            "states(q[None], v[None])[0]",
        ),
    )


def driven_lines(controls: str, mechanism: Mechanism, built_mechanism: Built) -> str:
    """Return the lines that define the driven joints, from those that define what drives them, which may be empty."""
    if not controls:
        return ""
    in_q, in_v = map(array, mechanisms.driven_joints(mechanism, built_mechanism))
    return DRIVEN.format(controls=controls, source=scripts.source(Actuated), in_q=in_q, in_v=in_v)


def advance_lines(scheme: str, driven: bool, followers: bool) -> str:
    """Return the lines that take the steps to the next sample. scheme: the name of its function."""
    step = f"{scheme}(model, acceleration, q, v, step_length)"
    if not driven:
        return f"for _ in range(step - done):\n    q, v = {step}"
    state = "lambda: joints.state(*all_joints(*RULES)(q, v))" if followers else "lambda: joints.state(q, v)"
    return scripts.driven_advance(f"for _ in range(following - done):\n    q, v = joints.count({step})", state)


def joint_lines(built_mechanism: Built) -> str:
    """Return the lines that add the joints of a model, each with the inertia that it moves."""
    model, lines = built_mechanism.model, []
    for number, (kind, numbers) in enumerate(built_mechanism.kinds, start=1):
        inertia = model.inertias[number]
        lines.append(
            JOINT.format(
                parent=model.parents[number],
                kind=kind,
                numbers=", ".join(map(repr, numbers)),
                frame=placed(model.jointPlacements[number]),
                name=model.names[number],
                place=number,
                mass=float(inertia.mass),
                lever=scripts.written(inertia.lever),
                tensor=scripts.written(inertia.inertia.ravel()),
            )
        )
    return "\n".join(lines)


def armature_line(mechanism: Mechanism, built_mechanism: Built) -> str:
    """Return the line that sets the armature; empty if no joint has armature."""
    if not any(joint.armature for joint in mechanism.joints):
        return ""
    return f"model.armature = np.array({scripts.written(built_mechanism.model.armature)})"


def acceleration_line(mechanism: Mechanism, built_mechanism: Built, method: Method) -> str:
    """Return the line that defines the accelerations."""
    if built_mechanism.followers:
        return "acceleration = coupled(model, data, forces)"
    if not mechanism.loops:
        return "acceleration = unconstrained(model, data, forces)"
    ends = ", ".join(
        f"({one}, {array(point)}, {other}, {array(second)})"
        for one, point, other, second in mechanisms.ends_of(mechanism, built_mechanism)
    )
    gains, accuracy = mechanisms.gains_of(method), mechanisms.ACCURACY
    return f"acceleration = constrained(model, data, forces, [{ends}], {gains}, {accuracy})"


def placed(frame: pin.SE3) -> str:
    """Return a placement as a Python expression."""
    return f"place({scripts.written(frame.rotation.ravel())}, {scripts.written(frame.translation)})"


def array(numbers: Array | Indices) -> str:
    """Return an array as a Python expression."""
    return f"np.array({numbers.tolist()})"


def arrays(numbers: Sequence[Array | Indices]) -> str:
    """Return the lines of a list of arrays."""
    return "\n".join(f"    {array(each)}," for each in numbers)
