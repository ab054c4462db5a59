"""The truth of a scene of bodies that touch: the motion by its way, converted to the world and to doubles, with all bounds.

The truth is compared with its witness (`contact.witness`), which starts from the scene by code of its own. Where the two differ
by more than the bounds of both allow, in a state or in the time of an event, the bound of the truth grows by the difference.
"""

from dataclasses import replace

import numpy as np

from bodycheck.reference.bodies import initial
from bodycheck.reference.bounds import EPS, STATES, Bounds
from bodycheck.reference.contact.motion import ContactMotion, Event
from bodycheck.reference.contact.problem import turn_of
from bodycheck.reference.contact.ways import motion_of
from bodycheck.reference.contact.witness.ways import second
from bodycheck.reference.kinematics import multiply, normalise, rotate
from bodycheck.reference.mechanisms import kinematics, ways
from bodycheck.reference.mechanisms.coordinates import JointMotion
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.scene import Vector, vector_of
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truths import Computed, Truth
from bodycheck.reference.witness import (
    Instant,
    WideArray,
    Witness,
    as_way,
    conserved_errors,
    contradictions,
    event_distances,
)

#: The number of roundings of a state in its conversion to the world and to doubles, relative to its size.
PRINTED_ROUNDINGS = 4.0

#: The name of the software in results.
BACKEND = "numpy"


def computed_contact(scene: AnyScene, times: Array, *, vouched: bool = True) -> Computed:
    """The truth of a scene of bodies that touch at ascending times (n,) >= 0 (s). Raises the same exceptions as `truth.truth`.

    vouched: whether the motion is compared with its witness. If not, or if no witness can follow the motion, the bounds are
    those of its way alone.
    """
    times = np.asarray(times, dtype=float)
    motion, turn = motion_of(scene, times), turn_of(scene)
    states = _from_file(scene, _in_world(motion, turn, times))
    errors = _errors(motion, states)
    events = tuple(_event_in_world(event, turn) for event in motion.events)
    trajectory = states if isinstance(scene, Mechanism) else states.body(0)
    bounds = _bounds(scene, trajectory, errors)
    own_events = tuple(Instant(event.kind, event.time, event.error, event.body) for event in events)
    witness = second(scene, times) if vouched else None
    vouched_bounds = bounds
    if witness is not None:
        beyond = contradictions(as_way("", trajectory, bounds), witness)
        if any(apart.any() for apart in beyond.values()):
            vouched_bounds = _bounds(scene, trajectory, {name: errors[name] + beyond[name] for name in STATES})
        events = _vouched_events(events, own_events, witness, float(times.max(initial=0.0)))
    truth = Truth(
        scene,
        trajectory,
        vouched_bounds,
        motion.model,
        motion.reason,
        BACKEND,
        (*((motion.witness,) if motion.witness else ()), *((witness.name,) if witness else ())),
        joints=_joints(scene, trajectory) if isinstance(scene, Mechanism) else None,
        events=events,
        friction=motion.friction,
        interfaces=motion.interfaces,
    )
    ends = () if motion.end is None else (motion.end,)
    return Computed(truth, bounds, (witness,) if witness else (), (*own_events, *ends))


def _bounds(scene: AnyScene, trajectory: Trajectory, errors: dict[str, Array]) -> Bounds:
    """The bounds of all figures from those of the states (n,), by the names of `bounds.STATES`."""
    if isinstance(scene, Mechanism):
        return ways.bounds_of(scene, trajectory, _joints(scene, trajectory).position, errors)
    return Bounds(**errors, **conserved_errors(scene, trajectory, **errors))


def _joints(scene: Mechanism, trajectory: Trajectory) -> JointMotion:
    """The coordinates of the joints, on which the fingers are that grip a body."""
    if scene.joints:
        return kinematics.joints(scene, trajectory)
    return JointMotion(np.zeros((len(trajectory), 0)), np.zeros((len(trajectory), 0)))


def _vouched_events(
    events: tuple[Event, ...], own_events: tuple[Instant, ...], witness: Witness, last: float
) -> tuple[Event, ...]:
    """The events of a truth, whose errors grow where its witness has them at other instants. last: the last instant (s)."""
    if witness.events is None:
        return events
    apart = event_distances(own_events, witness.events, last)
    return tuple(replace(event, error=event.error + each) for event, each in zip(events, apart, strict=True))


def _from_file(scene: AnyScene, trajectory: Trajectory) -> Trajectory:
    """A motion whose known states at t = 0 are those of the scene, without the roundings of the way that computed it."""
    begins = (trajectory.t == 0)[:, None] & ~np.isnan(trajectory.position)
    start = initial(scene)
    attitude = normalise(start.quaternion)
    opposite = (attitude * trajectory.quaternion).sum(axis=-1, keepdims=True) < 0
    return Trajectory(
        trajectory.t,
        np.where(begins, start.position, trajectory.position),
        np.where(begins[..., :1], np.where(opposite, -attitude, attitude), trajectory.quaternion),
        np.where(begins, start.velocity, trajectory.velocity),
        np.where(begins, start.angular_velocity, trajectory.angular_velocity),
    )


def _in_world(motion: ContactMotion, turn: WideArray, times: Array) -> Trajectory:
    """Convert a motion along the axes of the plane to a trajectory in the world, in doubles. turn: from plane to world."""
    return Trajectory(
        times,
        rotate(turn, motion.position).astype(float),
        multiply(turn, motion.quaternion).astype(float),
        rotate(turn, motion.velocity).astype(float),
        motion.spin.astype(float),
    )


def _errors(motion: ContactMotion, trajectory: Trajectory) -> dict[str, Array]:
    """The bounds of the errors of states: those of the way, which are zero at t = 0, plus the roundings to doubles."""
    sizes = {
        "error": np.ones(len(trajectory)),
        "position_error": _largest(trajectory.position),
        "velocity_error": _largest(trajectory.velocity),
        "angular_velocity_error": _largest(trajectory.angular_velocity),
    }
    at_start = (trajectory.t == 0) & ~np.isnan(motion.errors["error"])
    return {name: np.where(at_start, 0.0, motion.errors[name]) + PRINTED_ROUNDINGS * EPS * sizes[name] for name in STATES}


def _largest(vectors: Array) -> Array:
    """The largest lengths (n,), over all bodies, of vectors (b, n, 3)."""
    return np.asarray(np.linalg.norm(vectors, axis=-1).max(axis=0))


def _event_in_world(event: Event, turn: WideArray) -> Event:
    return replace(
        event,
        error=event.error + EPS * event.time,  # the time is rounded to a double
        position=_vector(turn, event.position),
        velocity=_vector(turn, event.velocity),
        spin=_vector(turn, event.spin),
    )


def _vector(turn: WideArray, components: Vector) -> Vector:
    return vector_of(rotate(turn, np.array(components, dtype=turn.dtype)))
