"""Make one run of a case in an engine with a method, in this process."""

import math
import time
from dataclasses import replace
from typing import Literal

import numpy as np

from bodycheck import conversion
from bodycheck.adapters import offers, registry
from bodycheck.adapters.contract import (
    Adapter,
    Contact,
    EngineDiverged,
    EngineReset,
    Method,
    Normalising,
    SceneUnsupported,
    Simulation,
    Strides,
)
from bodycheck.adapters.engine_name import in_words
from bodycheck.adapters.method import DEFAULT_TIMESTEP
from bodycheck.casefile.case import Case, check_case
from bodycheck.figures.definition import Load
from bodycheck.reference.contact_observables import measured_stop
from bodycheck.reference.inertia import angular_momentum
from bodycheck.reference.kinematics import geodesic_angle
from bodycheck.reference.observables import observe
from bodycheck.reference.scene import Plane, Scene
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truth import missing_model
from bodycheck.running.outcome import Completed, Crashed, Diverged, Outcome, Run, Unsupported, crash
from bodycheck.running.plan import check_timestep
from bodycheck.running.process_state import TO_NEAREST, rounding

#: Largest number of steps for which the load of a contact is measured, which takes about ten times as long as stepping.
MAX_LOAD_STEPS = 20_000

#: Smallest motion per step that is visible in single precision, relative to the position or in rad.
VISIBLE_MOTION = 1e-6

#: Largest distance of a quaternion's norm from 1. The rounding of single precision is a tenth of it.
UNIT_TOLERANCE = 1e-6

#: Largest deviation of a state at t = 0 from that of the scene: an angle (rad), and of vectors relative to the larger of their
#: length and 1. Single precision is within a tenth of it, and a wrong axis, frame, sign or order of a quaternion is beyond it.
START_TOLERANCE = 1e-4

#: Ratio of the kinetic energy to the largest possible one, above which a run has diverged.
DIVERGED_ENERGY_RATIO = 100.0
#: The outcome of a run that leaves the rounding of numbers changed, so that the instants of its states are others too.
OTHER_ROUNDING = Crashed("it changed how its process rounds floating-point numbers")


class AdapterFault(Exception):
    """What an adapter returned cannot be the states of its engine; the text says why."""


def simulate(case: Case, engine: str, integrator: str, timestep: float = DEFAULT_TIMESTEP) -> Run:
    """Run a case in an engine. The outcome of the run contains its errors; exceptions of an engine are not passed on.

    Parameters
    ----------
    case
        The case.
    engine
        The name of the engine.
    integrator
        The spelling of a method: the integrator and its options, as in `Euler:cone=elliptic`.
    timestep
        The time step (s).

    Raises
    ------
    EngineMissing
        If the engine is not installed or has no adapter.
    BadInput
        If the engine has no such integrator, option or value, the time step is not possible, or one of them is no text or no
        number.
    TypeError
        If the case is not a `Case`.
    """
    check_case(case)
    engine = conversion.name("--engine", engine)
    method = Method.parse(conversion.name("--integrator", integrator), conversion.number("--timestep", timestep))
    offers.check(registry.load(engine).engine, method)
    check_timestep(case, timestep)
    return run(case, engine, method)


def run(case: Case, engine: str, method: Method) -> Run:
    """Run a case with a method of an engine. Raises `EngineMissing` as `simulate` does."""
    adapter = registry.load(engine)
    law: Plane | None = None
    try:
        if case.scene.plane is not None and isinstance(adapter, Contact):
            law = adapter.contact_law(case.scene, method)
        steps = sampling_steps(case.instants, method.timestep)
        outcome = outcome_in(adapter, engine, case.scene, method, steps)
    except (Exception, SystemExit) as error:  # an engine may raise anything
        outcome = ended_by(error, in_words(engine, adapter.engine.version), case.name)
    return Run(case.name, engine, adapter.engine.version, method, where_rounded_to_nearest(outcome), law, case.scene)


def ended_by(error: BaseException, engine: str, case: str) -> Outcome:
    """Return the outcome of a run that an exception ended. engine: in words, with its version. case: its name."""
    match error:
        case SceneUnsupported():
            return Unsupported(str(error))
        case EngineDiverged():
            return Diverged(str(error))
        case AdapterFault():
            return Crashed(f"the adapter of {engine} is at fault in the case {case}: {error}")
        case _:
            return crash(error)


def where_rounded_to_nearest(outcome: Outcome) -> Outcome:
    """Return the outcome of a run that has just ended; it counts for nothing if the engine changed how numbers are rounded."""
    return outcome if rounding() == TO_NEAREST else OTHER_ROUNDING


def outcome_in(adapter: Adapter, engine: str, scene: Scene, method: Method, steps: Strides) -> Outcome:
    """Return the outcome of a run of a scene, sampled after numbers of steps (n,). Raises whatever the engine raises."""
    named = in_words(engine, adapter.engine.version)
    if (lacking := offers.not_offered(adapter.engine, scene, method)) is not None:
        return Unsupported(f"{named} {lacking}")
    if (missing := missing_model(scene)) is not None:
        return Unsupported(f"the reference does not model {missing}")
    if (lacking := offers.not_modelled(adapter.engine, scene)) is not None:
        return Unsupported(f"{named} {lacking}")
    outcome = _advance(offers.prepare(adapter, [scene], method), scene, method, steps)
    if scene.plane is None or not isinstance(outcome, Completed) or not isinstance(adapter, Contact):
        return outcome
    return replace(outcome, load=_load(adapter, scene, method, outcome))


def _load(adapter: Contact, scene: Scene, method: Method, outcome: Completed) -> Load | None:
    """Measure the load of the contact in a separate run, which is not timed, until the body stops, or until the end."""
    stop = round(measured_stop(scene, outcome.trajectory).time / method.timestep)
    load = adapter.contact_load(scene, method, min(stop or outcome.steps, MAX_LOAD_STEPS))
    if load is None or len(load) == 0 or scene.gravity == 0:
        return None
    weight = scene.body.mass * scene.gravity
    return Load(float(load.mean()) / weight, float(load.max()) / weight, float((load > 0).mean()))


def sampling_steps(instants: Array, timestep: float) -> Strides:
    """Return the numbers of steps (m,), without duplicates, whose ends are closest to instants (n,), in s."""
    return np.unique(np.rint(instants / timestep).astype(np.int64))


def _advance(simulation: Simulation, scene: Scene, method: Method, steps: Strides) -> Outcome:
    strides = np.diff(steps, prepend=0)
    with np.errstate(all="ignore"):  # a run that overflows is judged by its states
        start = time.perf_counter()
        try:
            states = simulation.advance(strides)
        except EngineDiverged as error:
            signal: Literal["gave up", "reset"] = "reset" if isinstance(error, EngineReset) else "gave up"
            return Diverged(str(error), signal, trajectory_of(steps, method, error.states[0, :, 0]))
        wall_time = time.perf_counter() - start
    return outcome_of(rows_of(states, 1, len(steps))[0], simulation, scene, method, steps, wall_time)


def outcome_of(rows: Array, simulation: object, scene: Scene, method: Method, steps: Strides, wall_time: float) -> Outcome:
    """Return the outcome of a run whose engine went to the end.

    Parameters
    ----------
    rows
        The states (n, 13) of the body, in the columns of `Simulation.advance`.
    simulation
        The simulation of the scene, or anything else that is `Normalising` if the adapter normalised the quaternions.
    scene, method
        What was run.
    steps
        The numbers of steps (n,) from the start to each state.
    wall_time
        The wall time (s) of stepping.

    Raises
    ------
    AdapterFault
        If the rows cannot be the states of the engine.
    """
    trajectory = trajectory_of(steps, method, rows)
    if (diverged := _divergence(scene, trajectory)) is not None:
        return diverged
    norm_error = _norm_error(trajectory)
    _check_start(scene, trajectory)
    if (diverged := _standstill(scene, trajectory, method.timestep)) is not None:
        return diverged
    if isinstance(simulation, Normalising):
        norm_error = max(norm_error, simulation.quaternion_norm_error)
    return Completed(trajectory, int(steps[-1]), wall_time, quaternion_norm_error=norm_error)


def rows_of(states: object, scenes: int, count: int) -> Array:
    """Return the rows (scenes, count, 13) of states in an engine's own type of array.

    Raises `AdapterFault` if they are not those of so many scenes at so many instants.
    """
    if isinstance(states, np.ma.MaskedArray):
        raise AdapterFault("its states are a masked array")
    array = np.asarray(states)
    if array.dtype.kind not in "fiu":
        raise AdapterFault(f"its states are of the type {array.dtype}, not real numbers")
    if array.shape != (scenes, count, 1, 13):
        raise AdapterFault(f"its states have the shape {array.shape}, not {(scenes, count, 1, 13)}")
    return array.astype(np.float64)[:, :, 0]


def trajectory_of(steps: Strides, method: Method, rows: Array) -> Trajectory:
    """Return the trajectory of states (..., k, 13) after the first k of some numbers of steps (n,)."""
    t = steps[: rows.shape[-2]].astype(np.float64) * method.timestep
    return Trajectory(t, rows[..., :3], rows[..., 3:7], rows[..., 7:10], rows[..., 10:])


def _divergence(scene: Scene, trajectory: Trajectory) -> Diverged | None:
    """Find the first instant at which a state is not finite or has an impossible kinetic energy; None if there is none."""
    t = trajectory.t
    states = (trajectory.position, trajectory.quaternion, trajectory.velocity, trajectory.angular_velocity)
    finite = np.isfinite(np.hstack(states)).all(axis=1)
    if not finite.all():
        return Diverged(f"not a number at t = {t[np.argmin(finite)]:.6g} s", trajectory=trajectory)
    with np.errstate(all="ignore"):  # states that cannot be may overflow
        kinetic = observe(scene, trajectory).kinetic_energy
    most = _largest_kinetic_energy(scene, float(t[-1]))
    beyond = kinetic > DIVERGED_ENERGY_RATIO * most
    if most > 0 and beyond.any():
        first = int(np.argmax(beyond))
        reason = f"kinetic energy {kinetic[first] / most:.3g} times the most possible at t = {t[first]:.6g} s"
        return Diverged(reason, trajectory=trajectory)
    return None


def _norm_error(trajectory: Trajectory) -> float:
    """Return the largest deviation from 1 of the norm of a quaternion.

    Raises `AdapterFault` if it is none of an attitude, since an adapter normalises what its engine does not.
    """
    norms = np.hypot.reduce(trajectory.quaternion, axis=1)
    off = np.abs(norms - 1)
    if (off > UNIT_TOLERANCE).any():
        first = int(np.argmax(off > UNIT_TOLERANCE))
        raise AdapterFault(f"its quaternion has the norm {norms[first]:.8g}, not 1, at t = {trajectory.t[first]:.6g} s")
    return float(off.max())


def _check_start(scene: Scene, trajectory: Trajectory) -> None:
    """Raise `AdapterFault` if the run does not begin at the state of the scene, as with a wrong frame or order."""
    if trajectory.t[0] != 0:
        return
    initial = scene.initial
    pairs = {
        "position": (trajectory.position[0], initial.position),
        "velocity": (trajectory.velocity[0], initial.velocity),
        "angular velocity": (trajectory.angular_velocity[0], initial.angular_velocity),
    }
    for name, (got, asked) in pairs.items():
        if math.dist(got, asked) > START_TOLERANCE * max(1.0, math.hypot(*asked)):
            raise AdapterFault(f"at t = 0 its {name} is {got.tolist()}, not {list(asked)}")
    turned = float(geodesic_angle(trajectory.quaternion[0], np.array(initial.quaternion)))
    if turned > START_TOLERANCE:
        raise AdapterFault(f"at t = 0 its attitude is {turned:.3g} rad from that of the scene")


def _standstill(scene: Scene, trajectory: Trajectory, timestep: float) -> Diverged | None:
    """Return `Diverged` if the states are equal to the last bit at all samples although the body must move; else None.

    With velocity v the position changes by v h in a step h, and with spin w the attitude turns by |w| h, for any forces. A body
    at rest falls if nothing supports it. Motion that rounding can hide and full turns between samples do not count.
    """
    states = np.hstack([trajectory.position, trajectory.quaternion, trajectory.velocity, trajectory.angular_velocity])
    if len(states) < 2 or (states != states[0]).any():
        return None
    position, velocity = trajectory.position[0], trajectory.velocity[0]
    spin = math.hypot(*trajectory.angular_velocity[0])
    with np.errstate(all="ignore"):  # numbers that overflow are not judged
        moves = (np.abs(velocity) * timestep > VISIBLE_MOTION * np.abs(position)).any()
        turns = spin * timestep > VISIBLE_MOTION and (np.abs(np.sin(spin * np.diff(trajectory.t) / 2)) > VISIBLE_MOTION).any()
    falls = scene.plane is None and scene.gravity > 0 and not velocity.any()
    if not (moves or turns or falls):
        return None
    return Diverged("the state never changes although the body moves", trajectory=trajectory)


def _largest_kinetic_energy(scene: Scene, duration: float) -> float:
    """Return an upper bound of the kinetic energy (J): that of a fall for the whole duration, and of the least moment."""
    speed = math.hypot(*scene.initial.velocity) + scene.gravity * duration
    momentum = math.hypot(*angular_momentum(scene.body, np.array(scene.initial.angular_velocity)))
    return scene.body.mass * speed**2 / 2 + momentum**2 / (2 * min(scene.body.moments))
