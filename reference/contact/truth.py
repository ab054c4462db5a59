"""The truth of a scene of bodies that touch: the motion by its way, converted to the world and to doubles, with all bounds."""

from dataclasses import replace

import numpy as np

from bodycheck.reference.bounds import EPS, STATES, Bounds
from bodycheck.reference.contact.motion import ContactMotion, Event
from bodycheck.reference.contact.problem import problem
from bodycheck.reference.contact.ways import contact_motion
from bodycheck.reference.kinematics import multiply, rotate
from bodycheck.reference.mechanisms import ways
from bodycheck.reference.mechanisms.coordinates import JointMotion
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.scene import Vector, vector_of
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truths import Computed, Truth
from bodycheck.reference.witness import WideArray, conserved_errors

#: The number of roundings of a state in its conversion to the world and to doubles, relative to its size.
PRINTED_ROUNDINGS = 4.0

#: The name of the software in results.
BACKEND = "numpy"


def computed_contact(scene: AnyScene, times: Array) -> Computed:
    """The truth of a scene with a plane at ascending times (n,) >= 0 (s). Raises the same exceptions as `truth.truth`."""
    task = problem(scene)
    motion = contact_motion(task, np.asarray(times, dtype=float))
    trajectory = _in_world(motion, task.turn, np.asarray(times, dtype=float))
    errors = _errors(motion, trajectory)
    joints = None
    if isinstance(scene, Mechanism):
        none = np.zeros((len(times), 0))
        joints = JointMotion(none, none)
        bounds = ways.bounds_of(scene, trajectory, none, errors)
    else:
        trajectory = trajectory.body(0)
        bounds = Bounds(**errors, **conserved_errors(scene, trajectory, **errors))
    truth = Truth(
        scene,
        trajectory,
        bounds,
        motion.model,
        motion.reason,
        BACKEND,
        (motion.witness,) if motion.witness else (),
        joints=joints,
        events=tuple(_event_in_world(event, task.turn) for event in motion.events),
        friction=motion.friction,
        interfaces=motion.interfaces,
    )
    return Computed(truth, bounds, ())


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
    """The bounds of the errors of states: the bounds of the way, plus the roundings to doubles."""
    sizes = {
        "error": np.ones(len(trajectory)),
        "position_error": _largest(trajectory.position),
        "velocity_error": _largest(trajectory.velocity),
        "angular_velocity_error": _largest(trajectory.angular_velocity),
    }
    return {name: motion.errors[name] + PRINTED_ROUNDINGS * EPS * sizes[name] for name in STATES}


def _largest(vectors: Array) -> Array:
    """The largest lengths (n,), over all bodies, of vectors (b, n, 3)."""
    return np.asarray(np.linalg.norm(vectors, axis=-1).max(axis=0))


def _event_in_world(event: Event, turn: WideArray) -> Event:
    return replace(
        event,
        position=_vector(turn, event.position),
        velocity=_vector(turn, event.velocity),
        spin=_vector(turn, event.spin),
    )


def _vector(turn: WideArray, components: Vector) -> Vector:
    return vector_of(rotate(turn, np.array(components, dtype=turn.dtype)))
