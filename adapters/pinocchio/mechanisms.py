"""Step mechanisms by Pinocchio's algorithms. The module `mechanism_model` builds them.

The accelerations are those of the articulated-body algorithm (`aba`), and with loops those of its dynamics with constraints
(`constraintDynamics`), which keep the points of a loop together in their accelerations. The option `baumgarte` adds a
correction of what has come apart since.

Pinocchio takes armature from the model. What else acts on joints is forces that its users add to `tau`, and so they are added
here, evaluated with each acceleration: damping, springs, constant efforts, and dry friction of constant size against the
velocity. At rest such a friction is zero and changes its sign in each step, so that a joint that mechanics holds at rest
trembles, and creeps where another force loads it.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
import pinocchio as pin

from bodycheck.adapters.contract import Method, Option, Range, SceneUnsupported
from bodycheck.adapters.pinocchio.joints import UNIVERSE
from bodycheck.adapters.pinocchio.mechanism_model import Built, built
from bodycheck.adapters.pinocchio.schemes import SCHEMES, Acceleration
from bodycheck.adapters.stepping import Loop
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
        "point masses",
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

#: Accuracy, regularisation and most iterations of `constraintDynamics`, as in Pinocchio's examples of closed chains. The
#: regularisation allows for constraints that say the same twice, and the iterations remove its effect.
ACCURACY, REGULARISATION, ITERATIONS = 1e-14, 1e-10, 20


def prepare_mechanism(mechanism: Mechanism, method: Method) -> Loop[tuple[Array, Array]]:
    """Return the simulation of a mechanism at t = 0, as `Mechanisms.prepare_mechanism` does. Raises `SceneUnsupported`."""
    scheme, body_twist = SCHEMES[method.integrator]
    if method.option("baumgarte") and not mechanism.loops:
        raise SceneUnsupported(f"the option baumgarte={method.option('baumgarte')} for a mechanism without loops")
    made = built(mechanism, body_twist)
    model, nq = made.model, made.model.nq
    forces = joint_forces(mechanism, made)
    acceleration = constrained(mechanism, made, forces, method) if mechanism.loops else unconstrained(made, forces)
    step = np.full(model.nv, method.timestep)
    rows = states_of(mechanism, made)
    return Loop(
        (made.q, made.v),
        lambda state: scheme(model, acceleration, *state, step),
        lambda state: np.concatenate(state),
        lambda seen: rows(seen[:, :nq], seen[:, nq:]),
    )


def joint_forces(mechanism: Mechanism, made: Built) -> Callable[[Array, Array], Array]:
    """Return the forces (nv,) of damping, springs, dry friction and constant efforts as a function of q and v."""
    effort, damping, stiffness, rest, friction = (np.zeros(made.model.nv) for _ in range(5))
    position = np.zeros(made.model.nv, dtype=np.int64)
    for joint, (in_q, in_v) in zip(mechanism.joints, made.first, strict=True):
        own = slice(in_v, in_v + VELOCITIES[joint.type])
        damping[own], friction[own], effort[own] = joint.damping, joint.friction, joint.effort
        stiffness[own], rest[own], position[own] = joint.stiffness, joint.rest, in_q
    if not (damping.any() or stiffness.any() or friction.any()):
        return lambda q, v: effort
    rubbing = bool(friction.any())

    def forces(q: Array, v: Array) -> Array:
        total = effort - damping * v - stiffness * (q[position] - rest)
        return total - friction * np.sign(v) if rubbing else total

    return forces


def unconstrained(made: Built, forces: Callable[[Array, Array], Array]) -> Acceleration:
    """Return the accelerations of a mechanism without loops by the articulated-body algorithm."""
    model, data = made.model, made.model.createData()
    return lambda q, v: pin.aba(model, data, q, v, forces(q, v))


def constrained(mechanism: Mechanism, made: Built, forces: Callable[[Array, Array], Array], method: Method) -> Acceleration:
    """Return the accelerations of a mechanism with loops. Raises `SceneUnsupported` in a release without such dynamics."""
    if not hasattr(pin, "RigidConstraintModel"):
        raise SceneUnsupported(f"loops: Pinocchio {pin.__version__} has no constraints between two bodies")
    model, data = made.model, made.model.createData()
    constraints, datas = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
    places = {WORLD: (UNIVERSE, pin.SE3.Identity()), **dict(enumerate(made.places))}
    for loop in mechanism.loops:
        ends = list[object]()
        for body, point in zip(loop.bodies, loop.points, strict=True):
            joint, frame = places[body]
            ends += [joint, pin.SE3(np.eye(3), frame.act(np.array(point)))]
        one = pin.RigidConstraintModel(pin.ContactType.CONTACT_3D, model, *ends, pin.ReferenceFrame.LOCAL)
        if given := method.option("baumgarte"):
            set_correction(one, *map(float, given.split()))
        constraints.append(one)
        datas.append(one.createData())
    try:
        pin.initConstraintDynamics(model, data, constraints, datas)
    except TypeError:  # before Pinocchio 4 it did not take the data of the constraints
        pin.initConstraintDynamics(model, data, constraints)
    settings = pin.ProximalSettings(ACCURACY, REGULARISATION, ITERATIONS)
    return lambda q, v: pin.constraintDynamics(model, data, q, v, forces(q, v), constraints, datas, settings).copy()


def set_correction(constraint: Any, stiffness: float, damping: float) -> None:
    """Set the gains of the correction of a constraint: the stiffness (1/s^2) and the damping (1/s)."""
    if hasattr(pin, "BaumgarteCorrectorParameters") and hasattr(constraint, "setBaumgarteCorrectorParameters"):
        constraint.setBaumgarteCorrectorParameters(pin.BaumgarteCorrectorParameters(stiffness, damping))
        return
    # Before Pinocchio 4 each axis had gains of its own.
    constraint.corrector.Kp[:] = stiffness
    constraint.corrector.Kd[:] = damping


def states_of(mechanism: Mechanism, made: Built) -> Callable[[Array, Array], Array]:
    """Return the function from q (n, nq) and v (n, nv) at n instants to the states (n, bodies, 13) of the bodies."""
    model, data = made.model, made.model.createData()
    centres = np.array([exact.nearest_inertia(body).centre for body in mechanism.bodies])

    def rows(q: Array, v: Array) -> Array:
        poses, twists = np.empty((len(q), len(centres), 7)), np.empty((len(q), len(centres), 6))
        for row in range(len(q)):
            pin.forwardKinematics(model, data, q[row], v[row])
            for body, (joint, frame) in enumerate(made.places):
                poses[row, body] = pin.SE3ToXYZQUAT(data.oMi[joint] * frame)
                twists[row, body] = frame.actInv(data.v[joint]).vector
        attitude, spin = poses[..., [6, 3, 4, 5]], twists[..., 3:]
        position = poses[..., :3] + rotate(attitude, np.broadcast_to(centres, spin.shape))
        velocity = rotate(attitude, twists[..., :3] + np.cross(spin, centres))
        return np.concatenate([position, attitude, velocity, spin], axis=-1)

    return rows
