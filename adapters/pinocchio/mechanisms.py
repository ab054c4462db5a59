"""Step mechanisms by Pinocchio's algorithms. The module `mechanism_model` builds them.

The accelerations are those of the articulated-body algorithm (`aba`), and with loops those of its dynamics with constraints
(`constraintDynamics`), which give the two points of a loop the same acceleration. The option `baumgarte` adds a correction of
the gap and of its rate. Neither algorithm supports Pinocchio's mimic joints. With these, the accelerations are the solution of
the equations of motion, whose mass matrix and forces `rnea` gives, which does support them. So does `crba`, but its mass matrix
is wrong in Pinocchio 4.1.0 if a joint that follows another one carries two branches (`claims/pinocchio/mimic_dynamics.py`).

Pinocchio takes armature from the model. All other effects in joints are forces that users of Pinocchio add to `tau`. They are
evaluated with each acceleration: damping, springs, efforts, and dry friction of constant size against the velocity.
This friction is zero at rest, and near rest it changes its sign in each step, so that a joint that should stay at rest
trembles, and creeps if another force loads it.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from bodycheck.adapters import mechanism_models
from bodycheck.adapters.contract import Method, Option, Range, SceneUnsupported
from bodycheck.adapters.pinocchio.driving import Actuated, Forces, Indices
from bodycheck.adapters.pinocchio.joints import UNIVERSE
from bodycheck.adapters.pinocchio.mechanism_model import Built, built
from bodycheck.adapters.pinocchio.schemes import SCHEMES, Acceleration
from bodycheck.adapters.stepping import Loop, TakingLaws
from bodycheck.reference.kinematics import rotate
from bodycheck.reference.mechanisms import exact
from bodycheck.reference.mechanisms.coordinates import VELOCITIES
from bodycheck.reference.mechanisms.mechanism import WORLD, Mechanism
from bodycheck.reference.trajectory import Array

#: The requirements of a mechanism that Pinocchio models.
MODELS = frozenset(
    {
        *("mechanisms", "gravity", "loops", "armature", "joint damping", "joint springs", "joint friction", "joint efforts"),
        *(f"{type} joints" for type in ("revolute", "prismatic", "ball", "free", "fixed", "planar", "universal")),
        *("point masses", "massless bodies", "mimic joints", "controllers"),
    }
)

#: The options of each scheme for a mechanism.
OPTIONS = {
    "baumgarte": Option(
        "two numbers >= 0: the stiffness (1/s^2) and the damping (1/s) of the correction of loops",
        numbers=((Range(0), Range(0)),),
        kinds=frozenset({"mechanism"}),
    )
}

#: The accuracy, the regularisation and the largest number of iterations of `constraintDynamics`. The regularisation allows for
#: redundant constraints, and the iterations remove its effect. With a much smaller regularisation, the rounding of redundant
#: constraints, divided by it, remains in the accelerations. With a much larger one, the iterations do not remove its effect
#: near singular positions.
ACCURACY = (1e-14, 1e-6, 20)

#: Pinocchio's data contain about eight arrays whose sizes are the third power of the number of velocities, and the largest
#: number of bytes that they may have.
TENSORS, MOST_MEMORY = 8, 2 * 2**30

#: The ends of a loop: a joint and the point (3,) in its frame (m), twice.
Ends = tuple[int, Array, int, Array]


@dataclass(frozen=True, eq=False)
class Assembled:
    """A mechanism that is stepped in Pinocchio.

    Attributes
    ----------
    simulation
        The simulation, which takes efforts if joints are driven.
    loop
        The loop of its steps.
    data
        The data of the model in which the accelerations are computed.
    acceleration
        The accelerations.
    """

    simulation: Loop[tuple[Array, Array]] | TakingLaws
    loop: Loop[tuple[Array, Array]]
    data: pin.Data
    acceleration: Acceleration


def prepare(mechanism: Mechanism, method: Method) -> Loop[tuple[Array, Array]] | TakingLaws:
    """Return the simulation of a mechanism at t = 0, as `Adapter.prepare` does. Raises `SceneUnsupported`."""
    mechanism = modelled(mechanism, method)
    return assembled(mechanism, built_for(mechanism, method), method).simulation


def built_for(mechanism: Mechanism, method: Method) -> Built:
    """Return the mechanism that `modelled` returns on the joints of a method. Raises `SceneUnsupported`."""
    _, body_twist = SCHEMES[method.integrator]
    return built(mechanism, body_twist, method.option("model") == "three-hinges")


def assembled(mechanism: Mechanism, built_mechanism: Built, method: Method) -> Assembled:
    """Return a mechanism that is stepped by a method. Raises `SceneUnsupported`."""
    scheme, _ = SCHEMES[method.integrator]
    model, nq = built_mechanism.model, built_mechanism.model.nq
    check_memory(model)
    data, numbers = model.createData(), joint_numbers(mechanism, built_mechanism)
    joints = Actuated(forces_of(*numbers), *driven_joints(mechanism, built_mechanism), len(numbers[0]), method.timestep)
    forces = joints.total if mechanism.driven else joints.forces
    if built_mechanism.followers:
        acceleration = coupled(model, data, with_followers(forces, *rules_of(built_mechanism)))
    elif mechanism.loops:
        acceleration = constrained(model, data, forces, ends_of(mechanism, built_mechanism), gains_of(method), ACCURACY)
    else:
        acceleration = unconstrained(model, data, forces)
    step, rows = np.full(model.nv, method.timestep), states_of(model, data, built_mechanism.places, centres_of(mechanism))
    loop = Loop(
        (built_mechanism.q, built_mechanism.v),
        lambda state: joints.count(scheme(model, acceleration, *state, step)),
        lambda state: np.concatenate(state),
        lambda seen: rows(seen[:, :nq], seen[:, nq:]),
    )
    if not mechanism.driven:
        return Assembled(loop, loop, data, acceleration)
    of_all = all_joints(*rules_of(built_mechanism)) if built_mechanism.followers else in_model
    simulation = TakingLaws(loop, lambda: joints.state(*of_all(*loop.state)), joints.apply, joints.obey)
    return Assembled(simulation, loop, data, acceleration)


def check_memory(model: pin.Model) -> None:
    """Raise `SceneUnsupported` for a model whose data need more than `MOST_MEMORY` bytes, which might end the process."""
    if (needed := TENSORS * 8 * model.nv**3) > MOST_MEMORY:
        size = f"{needed / 2**30:.1f} GiB"
        raise SceneUnsupported(
            f"{model.nv} velocities of joints: Pinocchio's data of such a mechanism take some {size} of memory"
        )


def modelled(mechanism: Mechanism, method: Method) -> Mechanism:
    """Return the mechanism that the model of a method simulates.

    Raises `SceneUnsupported` for a model that the mechanism does not have, for the option `baumgarte` without loops, for loops
    in a release without constraints between two bodies, and for loops together with mimic joints.
    """
    mechanism_models.check(mechanism, method.option("model"))
    if method.option("model") == "free-bodies":
        mechanism = mechanism_models.free_bodies(mechanism)
    if method.option("baumgarte") and not mechanism.loops:
        raise SceneUnsupported(f"the option baumgarte={method.option('baumgarte')} for a mechanism without loops")
    if mechanism.loops and not hasattr(pin, "RigidConstraintModel"):
        raise SceneUnsupported(f"loops: Pinocchio {pin.__version__} has no constraints between two bodies")
    if mechanism.loops and any(joint.mimic for joint in mechanism.joints):
        raise SceneUnsupported("loops together with mimic joints, which Pinocchio's constraintDynamics does not support")
    return mechanism


def indices_of(mechanism: Mechanism, built_mechanism: Built) -> list[tuple[int, int]]:
    """Return the first indices of each joint in the coordinates and in the velocities of all joints.

    The coordinates and velocities of joints that follow others are behind those of the model.
    """
    model, first = built_mechanism.model, list(built_mechanism.first)
    for number, follower in enumerate(built_mechanism.followers):
        first[follower.of_mechanism] = model.nq + number, model.nv + number
    return first


def driven_joints(mechanism: Mechanism, built_mechanism: Built) -> tuple[Indices, Indices]:
    """Return the indices of the driven joints in the coordinates and in the velocities of all joints."""
    indices = indices_of(mechanism, built_mechanism)
    in_q, in_v = np.array([indices[joint] for joint in mechanism.driven], dtype=np.int64).reshape(-1, 2).T
    return in_q, in_v


def joint_numbers(mechanism: Mechanism, built_mechanism: Built) -> tuple[Array, Array, Array, Array, Array, Indices]:
    """Return efforts, dampings, stiffnesses, rests and frictions of joints, and the indices in q of their coordinates.

    All are arrays (nv + k,): first those of the velocities, then those of the k joints that follow others, whose coordinates
    are behind those in q.
    """
    model, followers = built_mechanism.model, built_mechanism.followers
    effort, damping, stiffness, rest, friction = (np.zeros(model.nv + len(followers)) for _ in range(5))
    position = np.zeros(model.nv + len(followers), dtype=np.int64)
    for joint, (in_q, in_v) in zip(mechanism.joints, indices_of(mechanism, built_mechanism), strict=True):
        of_joint = slice(in_v, in_v + VELOCITIES[joint.type])
        damping[of_joint], friction[of_joint], effort[of_joint] = joint.damping, joint.friction, joint.effort
        stiffness[of_joint], rest[of_joint], position[of_joint] = joint.stiffness, joint.rest, in_q
    return effort, damping, stiffness, rest, friction, position


def forces_of(effort: Array, damping: Array, stiffness: Array, rest: Array, friction: Array, position: Indices) -> Forces:
    """Return the forces on joints as a function of their coordinates and velocities, from the numbers of `joint_numbers`."""
    if not (damping.any() or stiffness.any() or friction.any()):
        return lambda q, v, passed: effort
    rubbing = bool(friction.any())

    def forces(q: Array, v: Array, passed: float) -> Array:
        total = effort - damping * v - stiffness * (q[position] - rest)
        return total - friction * np.sign(v) if rubbing else total

    return forces


def rules_of(built_mechanism: Built) -> tuple[Array, Array, Indices, Indices]:
    """Return the ratios and offsets (k,) of joints that follow others, and the indices in q and v of those that they follow."""
    followers, first = built_mechanism.followers, built_mechanism.first
    ratio, offset = (np.array([getattr(each, name) for each in followers]) for name in ("ratio", "offset"))
    in_q, in_v = np.array([first[follower.of_mechanism] for follower in followers]).T
    return ratio, offset, in_q, in_v


def all_joints(ratio: Array, offset: Array, in_q: Indices, in_v: Indices) -> Callable[[Array, Array], tuple[Array, Array]]:
    """Return the function from q and v to the coordinates and velocities of all joints, of which the last k follow others."""
    return lambda q, v: (np.concatenate([q, ratio * q[in_q] + offset]), np.concatenate([v, ratio * v[in_v]]))


def in_model(q: Array, v: Array) -> tuple[Array, Array]:
    """Return q and v, which are the coordinates and velocities of all joints if none follows another."""
    return q, v


def with_followers(forces: Forces, ratio: Array, offset: Array, in_q: Indices, in_v: Indices) -> Forces:
    """Return the forces (nv,) as a function of q and v, from those on all joints, of which the last k follow others.

    The force on a joint that follows another acts on the other with the ratio of their velocities.
    """

    extended = all_joints(ratio, offset, in_q, in_v)

    def total(q: Array, v: Array, passed: float) -> Array:
        of_all = forces(*extended(q, v), passed)
        on_model = of_all[: len(v)].copy()
        np.add.at(on_model, in_v, ratio * of_all[len(v) :])
        return on_model

    return total


def coupled(model: pin.Model, data: pin.Data, forces: Forces) -> Acceleration:
    """Return the accelerations of a mechanism with mimic joints: the solution of its equations of motion."""
    still, units = np.zeros(model.nv), np.eye(model.nv)

    def acceleration(q: Array, v: Array, passed: float) -> Array:
        at_rest = pin.rnea(model, data, q, still, still).copy()
        inertia = np.array([pin.rnea(model, data, q, still, unit) - at_rest for unit in units])
        return np.linalg.solve(inertia, forces(q, v, passed) - pin.rnea(model, data, q, v, still))

    return acceleration


def unconstrained(model: pin.Model, data: pin.Data, forces: Forces) -> Acceleration:
    """Return the accelerations of a mechanism without loops by the articulated-body algorithm."""
    return lambda q, v, passed: pin.aba(model, data, q, v, forces(q, v, passed))


def ends_of(mechanism: Mechanism, built_mechanism: Built) -> tuple[Ends, ...]:
    """Return the two ends of each loop."""
    places = {WORLD: (UNIVERSE, pin.SE3.Identity()), **dict(enumerate(built_mechanism.places))}
    ends = []
    for loop in mechanism.loops:
        (one, first), (other, second) = (places[body] for body in loop.bodies)
        points = (frame.act(np.array(point)) for frame, point in zip((first, second), loop.points, strict=True))
        ends.append((one, next(points), other, next(points)))
    return tuple(ends)


def gains_of(method: Method) -> tuple[float, float] | None:
    """Return the gains of the correction of loops, 1/s^2 and 1/s; None if the method has no correction."""
    if (gains := method.option("baumgarte")) is None:
        return None
    stiffness, damping = map(float, gains.split())
    return stiffness, damping


def constrained(
    model: pin.Model,
    data: pin.Data,
    forces: Forces,
    ends: Sequence[Ends],
    gains: tuple[float, float] | None,
    accuracy: tuple[float, float, int],
) -> Acceleration:
    """Return the accelerations of a mechanism with loops, whose ends are given."""
    constraints, datas = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
    for one, point, other, second in ends:
        pair = one, pin.SE3(np.eye(3), point), other, pin.SE3(np.eye(3), second)
        constraint = pin.RigidConstraintModel(pin.ContactType.CONTACT_3D, model, *pair, pin.ReferenceFrame.LOCAL)
        if gains is not None and hasattr(constraint, "setBaumgarteCorrectorParameters"):
            constraint.setBaumgarteCorrectorParameters(pin.BaumgarteCorrectorParameters(*gains))
        elif gains is not None:  # before Pinocchio 4 each axis had gains of its own
            constraint.corrector.Kp[:], constraint.corrector.Kd[:] = gains
        constraints.append(constraint)
        datas.append(constraint.createData())
    try:
        pin.initConstraintDynamics(model, data, constraints, datas)
    except TypeError:  # before Pinocchio 4 it did not take the data of the constraints
        pin.initConstraintDynamics(model, data, constraints)
    settings = pin.ProximalSettings(*accuracy)
    return lambda q, v, passed: pin.constraintDynamics(
        model, data, q, v, forces(q, v, passed), constraints, datas, settings
    ).copy()


def centres_of(mechanism: Mechanism) -> Array:
    """Return the centres of mass (bodies, 3), each in the frame of its body (m)."""
    return np.array([exact.nearest_inertia(body).centre for body in mechanism.bodies])


def states_of(
    model: pin.Model, data: pin.Data, places: Sequence[tuple[int, pin.SE3]], centres: Array
) -> Callable[[Array, Array], Array]:
    """Return the function from q (n, nq) and v (n, nv) at n instants to the states (n, bodies, 13) of bodies.

    places: the joint of each body, and the body's frame in that of the joint. centres: (bodies, 3) in the bodies' frames (m).
    """

    def rows(q: Array, v: Array) -> Array:
        poses, twists = np.empty((len(q), len(centres), 7)), np.empty((len(q), len(centres), 6))
        for row in range(len(q)):
            pin.forwardKinematics(model, data, q[row], v[row])
            for body, (joint, frame) in enumerate(places):
                poses[row, body] = pin.SE3ToXYZQUAT(data.oMi[joint] * frame)
                twists[row, body] = frame.actInv(data.v[joint]).vector
        attitude, spin = poses[..., [6, 3, 4, 5]], twists[..., 3:]
        position = poses[..., :3] + rotate(attitude, np.broadcast_to(centres, spin.shape))
        velocity = rotate(attitude, twists[..., :3] + np.cross(spin, centres))
        return np.concatenate([position, attitude, velocity, spin], axis=-1)

    return rows
