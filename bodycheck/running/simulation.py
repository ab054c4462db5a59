"""Make one run of a case in an engine with a method, in this process."""

import time
from collections.abc import Callable
from dataclasses import replace
from typing import Literal

import numpy as np

from bodycheck import conversion
from bodycheck.adapters import offers, registry
from bodycheck.adapters.contract import (
    Adapter,
    ContactLaw,
    ContactLoad,
    ContactTerms,
    EngineDiverged,
    EngineReset,
    ErrorControlled,
    InterfaceLoads,
    Method,
    Normalising,
    SceneUnsupported,
    Simulation,
)
from bodycheck.adapters.engine_name import in_words
from bodycheck.adapters.scheduling import computed
from bodycheck.casefile.content import Case, check_case
from bodycheck.figures.definition import InterfaceLoad, Load
from bodycheck.processes.failures import Crashed, crash
from bodycheck.processes.process_state import TO_NEAREST, rounding
from bodycheck.reference.bodies import bodies
from bodycheck.reference.contact_observables import measured_stop
from bodycheck.reference.mechanisms.mechanism import AnyScene
from bodycheck.reference.modelled import missing_model
from bodycheck.reference.requirements import slides, touches
from bodycheck.reference.scene import Plane, Scene
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.results.outcome import NO_STEP, Completed, Diverged, Outcome, Run, Unsupported
from bodycheck.results.outcome import AdapterFault as AdapterFault
from bodycheck.running.instants import sampling_times
from bodycheck.running.roles import method_of, roles_of
from bodycheck.running.sensing import sensed
from bodycheck.running.state_checks import check_start, divergence, standstill
from bodycheck.running.states import of_scene, states_of, steps_to, trajectory_of
from bodycheck.running.stiff_joints import explained

#: Largest number of steps for which the load of a contact is measured, which takes about ten times as long as stepping.
MAX_LOAD_STEPS = 20_000

#: The time (s) from which on the loads between bodies at rest are measured, so that soft contacts have settled.
SETTLED = 1.0

#: Largest distance of a quaternion's norm from 1. The rounding of single precision is a tenth of it.
UNIT_TOLERANCE = 1e-6

#: The outcome of a method that reads sensors otherwise, in a case that has none.
WITHOUT_SENSORS = Unsupported("the option sensors=forward has no use in a case without sensors")

#: The outcome of a run that changes the rounding mode, which also changes the instants of its states.
OTHER_ROUNDING = Crashed("it changed how its process rounds floating-point numbers")


def simulate(case: Case, engine: str, integrator: str, timestep: float | None = None) -> Run:
    """Run a case in an engine. Errors of the run are in its outcome; exceptions of the engine are not raised here.

    Parameters
    ----------
    case
        The case.
    engine
        The name of the engine.
    integrator
        The spelling of a method: the integrator and its options, as in `Euler:cone=elliptic`; or `default` or `recommended`.
    timestep
        The time step (s); of a method with error control the largest step. None for the default time step, see
        `bodycheck.running.instants.default_timestep`; `default` and `recommended` have their own.

    Raises
    ------
    EngineMissing
        If the engine is not installed or has no adapter.
    BadInput
        If the engine has no such integrator, option or value, the time step is not possible, or named beside an alias, or an
        argument has the wrong type.
    TypeError
        If the case is not a `Case`.
    """
    check_case(case)
    engine = conversion.name("--engine", engine)
    step = None if timestep is None else conversion.number("--timestep", timestep)
    method = method_of(registry.load(engine).engine, case, conversion.name("--integrator", integrator), step)
    return run(case, engine, method)


def run(case: Case, engine: str, method: Method) -> Run:
    """Run a case with a method of an engine. Raises `EngineMissing` as `simulate` does."""
    adapter = registry.load(engine)
    law: Plane | None = None
    try:
        if slides(case.scene) and isinstance(adapter, ContactLaw):
            law = adapter.contact_law(case.scene, method)
        times = sampling_times(case.instants, method.sampling)
        idle = method.option("sensors") is not None and not case.sensors
        outcome = WITHOUT_SENSORS if idle else outcome_in(adapter, engine, case.scene, method, times)
        if case.sensors and isinstance(outcome, Completed):
            given = given_to_engines(case.scene, times)
            outcome = replace(outcome, readings=sensed(adapter, given, case.sensors, method, outcome.trajectory))
    except (Exception, SystemExit) as error:  # an engine may raise anything
        outcome = ended_by(error, in_words(engine, adapter.engine.version), case.name)
    record, ended = adapter.engine, where_rounded_to_nearest(outcome)
    return Run(case.name, engine, record.version, method, ended, law, case.scene, roles_of(record, case, method), case.sensors)


def ended_by(error: BaseException, engine: str, case: str) -> Outcome:
    """Return the outcome of a run that an exception ended. engine: words with version. case: name of the case."""
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
    """Return the outcome of a run that has just ended, replaced by a failure if the engine changed the rounding mode."""
    return outcome if rounding() == TO_NEAREST else OTHER_ROUNDING


def outcome_in(adapter: Adapter, engine: str, scene: AnyScene, method: Method, times: Array) -> Outcome:
    """Return the outcome of a run of a scene that is sampled at times (n,), in s. Raises whatever the engine raises.

    The times are those of `bodycheck.running.instants.sampling_times`.
    """
    outcome = motion_in(adapter, engine, scene, method, times)
    if not isinstance(outcome, Completed):
        return outcome
    given = given_to_engines(scene, times)
    if isinstance(adapter, ContactTerms) and (terms := adapter.contact_terms(given, method)):
        outcome = replace(outcome, contact_terms=terms)
    if touches(scene) and isinstance(adapter, InterfaceLoads):
        return replace(outcome, interfaces=_interfaces(adapter, scene, given, method, outcome))
    if slides(scene) and isinstance(adapter, ContactLoad):
        return replace(outcome, load=_load(adapter, scene, method, outcome))
    return outcome


def motion_in(adapter: Adapter, engine: str, scene: AnyScene, method: Method, times: Array) -> Outcome:
    """Return the outcome of a run without loads of contacts; the times (n,), in s, are multiples of a fixed time step.

    Raises whatever the engine raises.
    """
    if times[-1] == 0:
        return NO_STEP
    named = in_words(engine, adapter.engine.version)
    if (lacking := offers.not_offered(adapter.engine, scene, method)) is not None:
        return Unsupported(f"{named} {lacking}")
    if (missing := missing_model(scene)) is not None:
        return Unsupported(f"the reference does not model {missing}")
    if (lacking := offers.not_modelled(adapter.engine, scene, method)) is not None:
        return Unsupported(f"{named} {lacking}")
    given = given_to_engines(scene, times)
    simulation = offers.prepare(adapter, [given], method)
    if method.accuracy is None:
        outcome = _advance(simulation, scene, method, times)
    else:
        outcome = _reach(simulation, offers.prepare(adapter, [given], method), scene, method, times)
    if isinstance(outcome, Diverged):
        integrator = offers.integrator_of(adapter.engine, method)
        return explained(outcome, scene, method, None if integrator is None else integrator.order)
    return outcome


def given_to_engines(scene: AnyScene, times: Array) -> AnyScene:
    """Return a scene for engines: bodies in contact get finite coefficients of friction. times: of the run (n,), in s."""
    if not touches(scene):
        return scene
    from bodycheck.reference.contact.ways import finite  # the ways of contact are imported where they are needed

    return finite(scene, float(times[-1]))


def _interfaces(
    adapter: InterfaceLoads, scene: AnyScene, given: AnyScene, method: Method, outcome: Completed
) -> tuple[InterfaceLoad, ...] | None:
    """Measure the loads between bodies that should rest, in a separate run, which is not timed; None if none should rest.

    given: the scene that the engine gets.
    """
    from bodycheck.reference.contact.ways import ends  # the ways of contact are imported where they are needed

    resting = ends(scene, float(outcome.trajectory.t[-1])).interfaces
    steps = min(int(steps_to(outcome.trajectory.t, method)[-1]), MAX_LOAD_STEPS)
    if not resting or not steps:
        return None
    loads = adapter.interface_loads(given, method, steps)
    first = min(round(SETTLED / method.timestep), steps // 2)
    none = np.zeros(steps)
    return tuple(_bearing(pair.bodies, np.asarray(loads.get(pair.bodies, none), dtype=float)[first:]) for pair in resting)


def _bearing(bodies: tuple[int, int], loads: Array) -> InterfaceLoad:
    """Return the load between two bodies from the loads (n,), in N, of the steps at rest."""
    borne = loads > 0
    return InterfaceLoad(bodies, float(loads.mean()), int((borne[:-1] & ~borne[1:]).sum()))


def _load(adapter: ContactLoad, scene: Scene, method: Method, outcome: Completed) -> Load | None:
    """Measure the load of the contact in a separate run, which is not timed, until the body stops, or until the end."""
    stop = round(measured_stop(scene, outcome.trajectory).time / method.timestep)
    steps = stop or int(steps_to(outcome.trajectory.t, method)[-1])
    load = adapter.contact_load(scene, method, min(steps, MAX_LOAD_STEPS))
    if load is None or len(load) == 0 or scene.gravity == 0:
        return None
    weight = scene.body.mass * scene.gravity
    return Load(float(load.mean()) / weight, float(load.max()) / weight, float((load > 0).mean()))


def _advance(simulation: Simulation, scene: AnyScene, method: Method, times: Array) -> Outcome:
    """Return the outcome of a run with steps of fixed size."""
    strides = np.diff(steps_to(times, method), prepend=0)
    return _stepped(lambda: simulation.advance(strides), simulation, scene, method, times)


def _reach(simulation: Simulation, unsampled: Simulation, scene: AnyScene, method: Method, times: Array) -> Outcome:
    """Return the outcome of a run with error control: states from one simulation, cost and work from another.

    The other simulation goes to the end without samples between, because an engine may end a step at each sample.
    """
    assert isinstance(simulation, ErrorControlled)
    assert isinstance(unsampled, ErrorControlled)
    outcome = _stepped(lambda: simulation.reach(times), simulation, scene, method, times)
    if not isinstance(outcome, Completed):
        return outcome
    with np.errstate(all="ignore"):
        start = time.perf_counter()
        unsampled.finish(float(times[-1]))
        wall_time = time.perf_counter() - start
    work = unsampled.work
    return replace(outcome, steps=work.steps, wall_time=wall_time, rejected=work.rejected, evaluations=work.evaluations)


def _stepped(step: Callable[[], object], simulation: object, scene: AnyScene, method: Method, times: Array) -> Outcome:
    """Return the outcome of a run whose states (1, n, bodies, 13) at times (n,), in s, a function computes."""
    with np.errstate(all="ignore"):  # a run that overflows is judged by its states
        start = time.perf_counter()
        try:
            states = step()
        except EngineDiverged as error:
            signal: Literal["gave up", "reset"] = "reset" if isinstance(error, EngineReset) else "gave up"
            return Diverged(str(error), signal, trajectory_of(times, of_scene(error.states, scene)))
        wall_time = time.perf_counter() - start
    rows = of_scene(states_of(states, 1, len(times), len(bodies(scene))), scene)
    return outcome_of(rows, simulation, scene, method, times, wall_time)


def outcome_of(rows: Array, simulation: object, scene: AnyScene, method: Method, times: Array, wall_time: float) -> Outcome:
    """Return the outcome of a run in which the engine made all steps, with the number of steps of fixed size.

    Parameters
    ----------
    rows
        The states (n, 13) of the body, or (b, n, 13) of the bodies of a mechanism, in the columns of `Simulation.advance`.
    simulation
        The simulation of the scene, or anything else that is `Normalising` if the adapter normalised the quaternions.
    scene, method
        The scene and the method of the run.
    times
        The times (n,), in s, of the states.
    wall_time
        The wall time (s) of stepping.

    Raises
    ------
    AdapterFault
        If the rows cannot be the states of the engine.
    """
    trajectory = trajectory_of(times, rows)
    if (diverged := divergence(scene, trajectory)) is not None:
        return diverged
    norm_error = _norm_error(trajectory)
    check_start(scene, trajectory)
    if (diverged := standstill(scene, trajectory, method.timestep)) is not None:
        return diverged
    if isinstance(simulation, Normalising):
        norm_error = max(norm_error, simulation.quaternion_norm_error)
    steps, efforts = int(steps_to(times, method)[-1]), computed(simulation)
    return Completed(trajectory, steps, wall_time, quaternion_norm_error=norm_error, efforts=efforts)


def _norm_error(trajectory: Trajectory) -> float:
    """Return the largest deviation from 1 of the norm of a quaternion.

    Raises `AdapterFault` if the norm is not 1 within the tolerance, because an adapter must normalise quaternions.
    """
    norms = np.hypot.reduce(trajectory.quaternion, axis=-1)
    off = np.abs(norms - 1)
    if (off > UNIT_TOLERANCE).any():
        first = np.unravel_index(int(np.argmax(off > UNIT_TOLERANCE)), off.shape)
        raise AdapterFault(f"its quaternion has the norm {norms[first]:.8g}, not 1, at t = {trajectory.t[first[-1]]:.6g} s")
    return float(off.max())
