"""Step mechanisms in MuJoCo. The module `mechanism_xml` writes them.

MuJoCo computes the poses and the velocities of bodies from the coordinates at the start of a step, so that in the data after
the step they lag by one step. Here they are computed again from the coordinates after the step, by `mj_kinematics`, `mj_comPos`
and `mj_comVel` on separate data. `cvel` contains the angular velocity (world) and the velocity at the centre of mass of the
tree of bodies, from which the velocity at the centre of mass of the body is computed. The states of bodies without mass between
joints, which are no bodies of the model, come from a second model with the same coordinates; see `massless`.

The velocity of a ball joint is the angular velocity in the child's frame. The velocity of a free joint is the velocity of the
origin of the child's frame, in the world frame, and the angular velocity in the child's frame.
"""

import copy
from collections.abc import Callable, Sequence

import mujoco
import numpy as np

from bodycheck.adapters import mechanism_models, scripts
from bodycheck.adapters.contract import Method, SceneUnsupported
from bodycheck.adapters.mechanisms import frames, starts
from bodycheck.adapters.mujoco import driving, gripping, limits
from bodycheck.adapters.mujoco.exporting import ADVANCE
from bodycheck.adapters.mujoco.mechanism_xml import document, names_of_parts
from bodycheck.adapters.mujoco.models import compiled_model
from bodycheck.adapters.mujoco.stepping import Stepper
from bodycheck.adapters.stepping import TakingLaws
from bodycheck.reference.kinematics import conjugate, rotate
from bodycheck.reference.mechanisms.mechanism import Joint, JointedBody, Mechanism
from bodycheck.reference.requirements import touches
from bodycheck.reference.trajectory import Array

#: The requirements of a mechanism that MuJoCo models. MuJoCo itself refuses a moving body with a moment of zero.
MODELS = frozenset(
    {
        *("mechanisms", "gravity", "loops", "armature", "joint damping", "joint springs", "joint friction", "joint efforts"),
        *(f"{type} joints" for type in ("revolute", "prismatic", "ball", "free", "fixed", "planar", "universal")),
        *("point masses", "massless bodies", "mimic joints", "controllers", "rigid stops", "elastic stops"),
        "stops that cease to act",
    }
)

SCRIPT = '''\
{future}
import mujoco
import numpy as np

{sampling}
BODIES = {bodies}
XML = """
{xml}
"""

model = mujoco.MjModel.from_xml_string(XML)
data = mujoco.MjData(model)
data.qpos[:] = {qpos}
data.qvel[:] = {qvel}
data.qfrc_applied[:] = {applied}


{source}

{frames}states = states_of(frames, BODIES)
{driven}{loop}'''


#: The lines of a script that define the model from which the poses of bodies come.
SAME_FRAMES, OWN_FRAMES = (
    "frames = model\n",
    """\
# Bodies without mass between joints are no bodies of the model above. Their poses come from a model in which they have a mass.
frames = mujoco.MjModel.from_xml_string(r\"\"\"
{xml}
\"\"\")
""",
)

#: The lines of a script that define the driven joints, whose laws are passive forces for MuJoCo.
DRIVEN = """\
{controls}

{source}

joints = Actuated(model, data, {names})
if controls.continuous:
    joints.follow(controls.law)
    mujoco.set_mjcb_passive(joints.force)
"""


def prepare(mechanism: Mechanism, method: Method) -> Stepper | TakingLaws:
    """Return the simulation of a mechanism at t = 0, as `Adapter.prepare` does. Raises `SceneUnsupported`."""
    names = [mechanism.joints[joint].name for joint in mechanism.driven]
    mechanism, xml = described(mechanism, method)
    model = compiled_model(xml)
    if mechanism.stops_until is not None:
        model = copy.copy(model)  # others share the compiled model, whose limits act
    data = mujoco.MjData(model)
    begin(model, data, mechanism)
    seen = seen_states(mechanism, xml, method.option("model") == "three-hinges")
    if mechanism.stops_until is None:
        stepper: Stepper = Stepper(model, data, seen)
    else:
        stepper = limits.Releasing(model, data, seen, limits.released_after(mechanism.stops_until, method.timestep))
    return driving.driven(stepper, names) if names else stepper


def described(mechanism: Mechanism, method: Method) -> tuple[Mechanism, str]:
    """Return the mechanism that the model of a method simulates, and its XML. Raises `SceneUnsupported`."""
    if touches(mechanism):
        return mechanism, gripping.document(mechanism, method)
    chosen = dict(method.options)
    mechanism_models.check(mechanism, chosen.get("model"))
    if chosen.get("model") == "free-bodies":
        mechanism = mechanism_models.free_bodies(mechanism)
    xml = document(mechanism, method.timestep, method.integrator, chosen)
    if elastic := tuple(joint for joint in limits.limited(mechanism, chosen) if joint.stops and not joint.stops.rigid):
        inverses = limits.inverse_inertias(compiled_model(xml), elastic)
        xml = document(mechanism, method.timestep, method.integrator, chosen, inverses)
    return mechanism, xml


def seen_states(mechanism: Mechanism, xml: str, hinges: bool = False) -> Callable[[Array], Array]:
    """Return the function from n states (n, nq + nv) of a model to the states (n, bodies, 13) of the bodies of a mechanism.

    `xml` is the XML of the model, and `hinges` is whether three hinges replace a ball in it.
    """
    return states_of(compiled_model(frames_xml(mechanism, xml, hinges)), [body.name for body in mechanism.bodies])


def frames_xml(mechanism: Mechanism, xml: str, hinges: bool) -> str:
    """Return the XML of the model from which the poses of bodies come: `xml` itself, unless there are bodies without mass."""
    from bodycheck.adapters.mujoco.massless import with_masses  # it imports the exact arithmetic, which only mechanisms need

    whole = with_masses(mechanism)
    # Poses depend neither on the time step and the integrator nor on the options of constraints.
    return xml if whole is mechanism else document(whole, 0.001, "Euler", {"model": "three-hinges"} if hinges else {})


def script(mechanism: Mechanism, method: Method, duration: float, samples: int) -> str:
    """Return a script for MuJoCo alone, as `Scripts.script` does. Raises `SceneUnsupported`."""
    if mechanism.stops_until is not None:
        raise SceneUnsupported("stops that cease to act, in a script for the engine alone")
    drive, names = scripts.controls_of(mechanism, method), [mechanism.joints[joint].name for joint in mechanism.driven]
    mechanism, xml = described(mechanism, method)
    xml_of_frames = frames_xml(mechanism, xml, method.option("model") == "three-hinges")
    model = compiled_model(xml)
    data = mujoco.MjData(model)
    begin(model, data, mechanism)
    return SCRIPT.format(
        future=scripts.FUTURE,
        sampling=scripts.sampling(method.timestep, duration, samples),
        bodies=[body.name for body in mechanism.bodies],
        xml=scripts.embedded(xml),
        qpos=scripts.written(data.qpos),
        qvel=scripts.written(data.qvel),
        applied=scripts.written(data.qfrc_applied),
        source=scripts.source(conjugate, rotate, states_of),
        frames=SAME_FRAMES if xml_of_frames == xml else OWN_FRAMES.format(xml=xml_of_frames),
        driven=DRIVEN.format(controls=drive, source=scripts.source(driving.Actuated), names=names) if drive else "",
        loop=scripts.mechanism_loop(
            scripts.driven_advance("mujoco.mj_step(model, data, following - done)") if drive else ADVANCE,
            "states(np.concatenate([data.qpos, data.qvel])[None])[0]",
        )
        + ("mujoco.set_mjcb_passive(None)\n" if drive else ""),
    )


def begin(model: mujoco.MjModel, data: mujoco.MjData, mechanism: Mechanism) -> None:
    """Set the initial coordinates and velocities of a mechanism in MuJoCo's data, and its constant forces."""
    coordinates, origins, joint_of = starts(mechanism), frames(mechanism), mechanism.joint_of
    for index, joint in enumerate(joint_of):
        if joint is not None and joint.type == "fixed":
            continue
        first = first_joint(model, mechanism.bodies[index], joint)
        at, by = model.jnt_qposadr[first], model.jnt_dofadr[first]
        if joint is None or model.jnt_type[first] == mujoco.mjtJoint.mjJNT_FREE:
            # The coordinates of a free joint are along the axes of the world, not along the axes of the joint's frame.
            start = origins[index]
            position, velocity = [*start.position, *start.quaternion], [*start.velocity, *start.angular_velocity]
        else:
            parts = coordinates[mechanism.joints.index(joint)]
            if joint.type == "spherical" and model.jnt_type[first] == mujoco.mjtJoint.mjJNT_HINGE:
                parts = mechanism_models.hinge_motion(*parts)
            position, velocity = (part.tolist() for part in parts)
        data.qpos[at : at + len(position)], data.qvel[by : by + len(velocity)] = position, velocity
        if joint is not None and joint.effort:
            data.qfrc_applied[by] = joint.effort


def first_joint(model: mujoco.MjModel, body: JointedBody, joint: Joint | None) -> int:
    """Return the number of the first of MuJoCo's joints that make up the joint of a body; if it is None, the body is free."""
    if joint is None:
        return int(model.body_jntadr[model.body(body.name).id])
    number = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, joint.name)
    return number if number >= 0 else int(model.joint(names_of_parts(joint, hinges=True)[0]).id)


def states_of(model: mujoco.MjModel, names: Sequence[str]) -> Callable[[Array], Array]:
    """Return the function from n states (n, nq + nv) of a model to those of bodies (n, bodies, 13), which are given by name."""
    data, bodies = mujoco.MjData(model), [model.body(name).id for name in names]
    roots = model.body_rootid[bodies]

    def states(seen: Array) -> Array:
        places, attitudes, twists, origins = (np.empty((len(seen), len(bodies), size)) for size in (3, 4, 6, 3))
        for row, coordinates in enumerate(seen):
            data.qpos[:], data.qvel[:] = coordinates[: model.nq], coordinates[model.nq :]
            mujoco.mj_kinematics(model, data)
            mujoco.mj_comPos(model, data)
            mujoco.mj_comVel(model, data)
            places[row], attitudes[row] = data.xipos[bodies], data.xquat[bodies]
            twists[row], origins[row] = data.cvel[bodies], data.subtree_com[roots]
        spin = twists[..., :3]
        velocity = twists[..., 3:] + np.cross(spin, places - origins)
        return np.concatenate([places, attitudes, velocity, rotate(conjugate(attitudes), spin)], axis=-1)

    return states
