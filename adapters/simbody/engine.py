"""The adapter of Simbody by OpenSim: the model of a scene, and the loop of its steps."""

import ctypes
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import nullcontext, suppress
from dataclasses import dataclass, replace
from importlib import metadata
from typing import Any

import numpy as np
import opensim

from bodycheck.adapters.contract import (
    ACCURACY,
    KINDS,
    Engine,
    EngineDiverged,
    Integrator,
    Kind,
    Method,
    Role,
    SensingSimulation,
    Simulation,
    Strides,
    Usage,
    Work,
    choice,
    single,
    states,
)
from bodycheck.adapters.links import Link
from bodycheck.adapters.mechanisms import in_body_axes
from bodycheck.adapters.quiet import no_stderr
from bodycheck.adapters.simbody import INSTALLATION, driving, mechanisms, sensing, touching
from bodycheck.adapters.simbody.attitude import poses
from bodycheck.adapters.simbody.libraries import ACCURACY_IN_USE, COUNTS, REALIZATIONS, STEPS_ATTEMPTED, STEPS_TAKEN, told
from bodycheck.adapters.simbody.models import DRAG, described, started
from bodycheck.adapters.stepping import Controlled, Normalised, NormalisedControl, Taking, TakingControl
from bodycheck.adapters.touching import corners
from bodycheck.reference.kinematics import conjugate, normalise, rotate
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.requirements import touches
from bodycheck.reference.scene import Scene
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.trajectory import Array

# OpenSim logs each call to stdout and to a file in the working directory.
opensim.Logger.setLevelString("Off")
opensim.Logger.removeFileSink()

#: The integrator that Simbody has from SUNDIALS. It writes its errors to standard error, and is not offered on a plane.
CPODES = "CPodes"

#: Simbody's integrators by their names in OpenSim's `Manager`, with the orders that Simbody's documentation claims and the
#: numbers of evaluations of the accelerations in one step.
CLAIMS: dict[str, tuple[int | None, int | None]] = {
    "ExplicitEuler": (1, 1),
    "SemiExplicitEuler2": (1, 2),
    "Verlet": (2, None),
    "RungeKutta2": (2, 2),
    "RungeKutta3": (3, 3),
    "RungeKuttaMerson": (4, 5),
    "RungeKuttaFeldberg": (5, 6),
    CPODES: (None, None),
}

#: The largest number of steps in one call. Without this limit, CPodes complains on stderr after 500 steps.
STEP_LIMIT = 2**31 - 1

#: The number of steps that a manager records at once, which take 1.2 GB. Fewer would change the method: CPodes, a multistep
#: method, starts anew after a part, and 2400 steps of the flip in three parts have an error that is larger by half.
RECORDED = 6000

#: The beginning of the names of integrators in `Manager`.
PREFIX = "IntegratorMethod_"


def integrators() -> tuple[Integrator, ...]:
    """Return the integrators of the installed release."""
    here = [name.removeprefix(PREFIX) for name in dir(opensim.Manager) if name.startswith(PREFIX)]
    names = sorted(here, key=lambda name: [*CLAIMS, name].index(name))
    options = {"settings": choice("engine")} | ({"accuracy": ACCURACY} if COUNTS else {})
    flight = KINDS - {"plane", "contact"}
    return tuple(
        Integrator(name, *CLAIMS.get(name, (None, None)), kinds=flight if name == CPODES else KINDS, options=options)
        for name in names
    )


def defaults() -> dict[str, str]:
    """Return the default integrator of a manager, and its accuracy if Simbody's library has the function that returns it."""
    model = opensim.Model()
    state = model.initSystem()
    manager = opensim.Manager(model)
    manager.initialize(state)  # before this, Simbody has no accuracy
    names = {getattr(opensim.Manager, PREFIX + integrator.name): integrator.name for integrator in integrators()}
    tolerance = {"tolerance": f"{told(manager, ACCURACY_IN_USE, ctypes.c_double):g}"} if COUNTS else {}
    return {"integrator": names[manager.getIntegratorMethod()], **tolerance}


def roles(defaults: Mapping[str, str]) -> dict[Role, dict[Kind, Usage]]:
    """Return the method of a manager whose integrator is not changed, from the defaults. OpenSim recommends no integrator."""
    if "tolerance" not in defaults:
        return {}
    method = f"{defaults['integrator']}:accuracy={defaults['tolerance']},settings=engine"
    page = "https://simtk.org/api_docs/opensim/api_docs/classOpenSim_1_1Manager.html"
    return {"default": dict.fromkeys(KINDS, Usage(method, None, page))}


engine = Engine(
    name="simbody",
    distribution=INSTALLATION.distribution,
    version=metadata.version(INSTALLATION.distribution),
    integrators=integrators(),
    models=frozenset({"gravity", "translation", "rotation", "contact", "friction"})
    | DRAG
    | mechanisms.MODELS
    | touching.MODELS,
    variants=dict.fromkeys(
        ("flight", "mechanism"), tuple(f"{integrator.name}:settings=engine" for integrator in integrators())
    ),
    defaults=defaults(),
    roles=roles(defaults()),
    reads=("step",),
)

lacking, contact_terms = sensing.lacking, touching.contact_terms

#: The friction law of contacts.
contact_law = corners


#: The functions of OpenSim that steps call from Python.
calls = ((opensim.Manager, "integrate"),)


@dataclass
class Simbody:
    """A model of one scene or mechanism, stepped by OpenSim's manager.

    Attributes
    ----------
    manager, model
        OpenSim's manager, and its model. They are destroyed in this order, because the manager uses the model until it is
        destroyed.
    method
        The method.
    seen
        Returns a copy of the numbers (k,) that describe a state of the model.
    rows
        Converts the numbers (n, k) of n states to rows (n, 13) in the columns of `Simulation.advance`, or (n, bodies, 13).
    taken
        The number of steps taken by `advance`.
    earlier
        The numbers of steps taken and rejected before the manager began anew.
    """

    manager: Any
    model: Any
    method: Method
    seen: Callable[[Any], Array]
    rows: Callable[[Array], Array]
    taken: int = 0
    earlier: tuple[int, int] = (0, 0)

    def advance(self, strides: Strides) -> Array:
        """Return the states (1, n, bodies, 13) after each of n strides, as `Simulation.advance` does.

        Quaternions may have any norm.
        """
        seen: list[Array] = []
        for stride in strides.tolist():
            try:
                seen.append(self.at((self.taken + stride) * self.method.timestep))
            except EngineDiverged as signal:
                signal.states = single(self.rows(np.array([*seen, self.seen(self.manager.getState())])))
                raise
            self.taken += stride
        return single(self.rows(np.array(seen)))

    def at(self, time: float) -> Array:
        """Step to a time (s), where a step ends, and return the numbers that describe the state; raises `EngineDiverged`."""
        self.integrate(self.manager, time)
        return self.seen(self.manager.getState())

    def between(self, times: Array) -> Iterator[Array]:
        """Yield the numbers that describe the states at ascending times (n,), in s, without ending a step of the manager there.

        A manager goes to the last time and records the ends of its own steps. Each state is computed by another manager, from
        the end of the last step before its time. A recorded state takes some 0.2 MB. If a manager takes more than
        `RECORDED` steps, which are counted first, it records them in parts, and ends a step where a part ends. Raises
        `EngineDiverged`.
        """
        start = self.manager.getState()
        counting = managed(self.model, start, self.method)
        with suppress(EngineDiverged):  # it is raised after the states before it
            self.integrate(counting, float(times[-1]))
        for part in np.array_split(times, min(len(times), 1 + told(counting, STEPS_TAKEN) // RECORDED)):
            recording = managed(self.model, start, self.method, record=True)
            yield from self._recorded(recording, part)
            start = recording.getState()

    def _recorded(self, manager: Any, times: Array) -> Iterator[Array]:
        """Yield the numbers that describe the states at ascending times (n,), in s, between the recorded steps of a manager."""
        failed = None
        try:
            self.integrate(manager, float(times[-1]))
        except EngineDiverged as signal:
            failed = signal
        ends, last = manager.getStatesTrajectory(), 0
        side = managed(self.model, ends.get(0), self.method)
        for time in times.tolist():
            while last + 1 < ends.getSize() and ends.get(last + 1).getTime() <= time:
                last += 1
            state = ends.get(last)
            if state.getTime() < time:
                if failed is not None and last + 1 == ends.getSize():
                    raise failed
                side.initialize(state)
                self.integrate(side, time)
                state = side.getState()
            yield self.seen(state)

    def integrate(self, manager: Any, time: float) -> None:
        """Let a manager step to a time (s), where a step ends, unless it is there already. Raises `EngineDiverged`."""
        if time <= manager.getState().getTime():
            return
        # The C code of CPodes writes to stderr the same message that the exception contains.
        with no_stderr() if self.method.integrator == CPODES else nullcontext():
            try:
                manager.integrate(time)
            except RuntimeError as error:
                # The C++ function and the place in its source are before the message.
                words = " ".join(str(error).split())
                text = f"Simbody: {words.partition('SimTK Exception')[2].partition(': ')[2] or words}"
                raise EngineDiverged(text) from error

    def begin(self, state: Any) -> None:
        """Let the manager begin anew at a state, and keep the work before it."""
        if self.method.accuracy is not None:
            work = self.work()
            self.earlier = work.steps, work.rejected or 0
        self.manager.initialize(state)

    def controlled(self) -> Controlled:
        """Return the simulation of a method with error control."""
        return Controlled(self.method.timestep, self.at, self.rows, self.work, self.between)

    def work(self) -> Work:
        """Return the work of the integrator so far."""
        taken, attempted, realizations = (told(self.manager, name) for name in (STEPS_TAKEN, STEPS_ATTEMPTED, REALIZATIONS))
        # A manager that begins anew counts its steps from zero, but not its realizations.
        earlier_steps, earlier_rejected = self.earlier
        return Work(earlier_steps + taken, earlier_rejected + attempted - taken, realizations)


def prepare(scenes: Sequence[AnyScene], method: Method) -> Simulation:
    """Return the simulation of one scene, as `Adapter.prepare` does."""
    (scene,) = scenes
    if touches(scene):
        steps = together(touching.built(scene, method), method)
        return steps if method.accuracy is None else steps.controlled()
    if isinstance(scene, Mechanism):
        return jointed(scene, method)
    return simulation(scene, method)


def prepare_links(links: Sequence[Link], scene: Scene, method: Method) -> Simulation:
    """Return the simulation of a free body that is made of links, as `Links.prepare_links` does."""
    return simulation(scene, method, links)


def jointed(mechanism: Mechanism, method: Method) -> Simulation:
    """Return the simulation of a mechanism. Raises `SceneUnsupported`."""
    built = mechanisms.built(mechanism, method)
    steps, read, exert = assembled(mechanism, built, method)
    if not mechanism.driven:
        return steps if method.accuracy is None else steps.controlled()
    return driven(steps, read, exert)


def assembled(
    mechanism: Mechanism, built: mechanisms.Built, method: Method
) -> tuple[Simbody, Callable[[], tuple[Array, Array]], Callable[[Array], None]]:
    """Return the steps of a mechanism, and the functions that read its driven joints and exert efforts on them."""
    state = mechanisms.started(mechanism, built, method.option("settings") != "engine")
    first, seen = opensim.State(state), mechanisms.seer(mechanism, built)
    steps = Simbody(managed(built.model, state, method), built.model, method, seen, in_body_axes)

    def exert(efforts: Array) -> None:
        steps.begin(driving.overridden(first, steps.manager.getState(), built.actuators, efforts))

    def read() -> tuple[Array, Array]:
        return driving.motion(steps.manager.getState(), built.driven)

    return steps, read, exert


def driven(steps: Simbody, read: Callable[[], tuple[Array, Array]], exert: Callable[[Array], None]) -> Simulation:
    """Return the simulation of a mechanism whose joints are driven, from all that `assembled` returns."""
    if steps.method.accuracy is None:
        return Taking(steps, read, exert)
    return TakingControl(in_one(steps), read, exert)


def in_one(steps: Simbody) -> Controlled:
    """Return the simulation of a method with error control whose steps end at samples too.

    Efforts change, and sensors are read, at the ends of steps of the one manager.
    """
    return replace(steps.controlled(), between=None)


def together(touched: touching.Touching, method: Method) -> Simbody:
    """Return the steps of bodies that touch."""
    state = touching.started(touched, method.option("settings") != "engine")
    seen = mechanisms.seer_of(touched.model, touched.bodies, [(0.0, 0.0, 0.0)] * len(touched.bodies))
    return Simbody(managed(touched.model, state, method), touched.model, method, seen, in_body_axes)


def interface_loads(scene: AnyScene, method: Method, steps: int) -> dict[tuple[int, int], Array]:
    """Return the normal forces between pairs that touch after each of n steps, as `InterfaceLoads.interface_loads` does."""
    touched = touching.built(scene, method)
    simulation = together(touched, method)
    by_pair = {pair: np.zeros(steps) for pair in touched.forces}
    for step in range(steps):
        simulation.at((step + 1) * method.timestep)
        for pair, load in touched.loads(simulation.manager.getState()).items():
            by_pair[pair][step] = load
    return {pair: loads for pair, loads in by_pair.items() if loads.any()}


def simulation(scene: Scene, method: Method, links: Sequence[Link] = ()) -> Normalised:
    """Return the simulation of a scene with its body, or with links in place of it. Raises `SceneUnsupported`."""
    steps = alone(scene, described(scene, links), method)
    return Normalised(steps) if method.accuracy is None else NormalisedControl(steps.controlled())


def alone(scene: Scene, model: Any, method: Method) -> Simbody:
    """Return the steps of a model of a scene. Quaternions may have any norm."""
    quaternions = method.option("settings") != "engine"
    state = started(scene, model, quaternions)

    def rows(seen: Array) -> Array:
        position, attitude = poses(seen[:, :7], quaternions)
        return states(position, attitude, seen[:, 10:], rotate(conjugate(normalise(attitude)), seen[:, 7:10]))

    return Simbody(managed(model, state, method), model, method, coordinates, rows)


def prepare_sensing(scene: AnyScene, sensors: Sequence[Sensor], method: Method) -> SensingSimulation:
    """Return the simulation of a scene with sensors, as `Sensing.prepare_sensing` does."""
    if touches(scene):
        touched = touching.built(scene, method)
        reading = sensing.reader(touched.model, sensing.on_touching(touched, sensors))
        steps = together(touched, method)
        return SensingSimulation(steps if method.accuracy is None else in_one(steps), lambda: reading(steps.manager.getState()))
    if isinstance(scene, Mechanism):
        built = mechanisms.built(scene, method)
        reading = sensing.reader(built.model, sensing.on_joints(scene, built, sensors))
        steps, read, exert = assembled(scene, built, method)
        undriven = steps if method.accuracy is None else in_one(steps)
        simulation = driven(steps, read, exert) if scene.driven else undriven
        return SensingSimulation(simulation, lambda: reading(steps.manager.getState()))
    model = described(scene)
    reading = sensing.reader(model, sensing.on_body(model, sensors))
    steps = alone(scene, model, method)
    return SensingSimulation(
        Normalised(steps) if method.accuracy is None else NormalisedControl(in_one(steps)),
        lambda: reading(steps.manager.getState()),
    )


def coordinates(state: Any) -> Array:
    """Return the coordinates and velocities in a state of a model."""
    return np.concatenate([state.getQ().to_numpy(), state.getU().to_numpy()])


def managed(model: Any, state: Any, method: Method, record: bool = False) -> Any:
    """Return OpenSim's manager of a model, which starts at a state.

    Its steps have a fixed size, or are chosen by error control if the method has an accuracy. record: whether it records the
    states at the ends of its steps.
    """
    manager = opensim.Manager(model)
    manager.setIntegratorMethod(getattr(opensim.Manager, PREFIX + method.integrator))
    if method.accuracy is None:
        manager.setIntegratorFixedStepSize(method.timestep)
    else:
        manager.setIntegratorAccuracy(method.accuracy)
        manager.setIntegratorMaximumStepSize(method.timestep)
    manager.setIntegratorInternalStepLimit(STEP_LIMIT)
    manager.setWriteToStorage(False)
    manager.setPerformAnalyses(False)
    manager.setRecordStatesTrajectory(record)
    manager.initialize(state)
    return manager
