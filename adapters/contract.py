"""The contract between bodycheck and the adapter of an engine: a module, or any object, with the attributes of `Adapter`.

An adapter describes its engine in one record, `Engine`, and builds a `Simulation` from scenes by one function, `prepare`. The
record says as data which scenes the engine can model, with which integrators, and how many scenes it steps together. Everything
else is optional: an adapter does not implement the protocols that its engine cannot serve. `Models` is for several models of a
scene; `ContactLaw`, `ContactLoad` and `InterfaceLoads` are for the friction law and the forces of contacts; `Sensing` is for
its sensors; `Scripts` is for a run as a script for the engine alone; `Calls` names the functions of the engine that steps call.
`bodycheck.adapters.links.Links` is for engines that take a body as links welded together, and
`bodycheck.adapters.robot_reading.RobotModels` for engines that read files of robots. For all adapters,
`bodycheck.adapters.offers` handles misspelled methods, scenes that an engine cannot model, and several scenes for an engine
that steps one scene at a time.

Scenes and states follow the conventions of `bodycheck.reference.scene`. An adapter converts them to and from the conventions
of its engine. It imports its engine and this package, but no module of cases, truth or reports.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from bodycheck.adapters.engine_record import Engine as Engine
from bodycheck.adapters.engine_record import Integrator as Integrator
from bodycheck.adapters.engine_record import Role as Role
from bodycheck.adapters.engine_record import Usage as Usage
from bodycheck.adapters.engine_record import Varied as Varied
from bodycheck.adapters.method import ACCURACY as ACCURACY
from bodycheck.adapters.method import KINDS as KINDS
from bodycheck.adapters.method import Kind as Kind
from bodycheck.adapters.method import Method as Method
from bodycheck.adapters.method import Option as Option
from bodycheck.adapters.method import Range as Range
from bodycheck.adapters.method import choice as choice
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.requirements import touches
from bodycheck.reference.scene import Plane, Scene
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.trajectory import Array

Strides = NDArray[np.int64]


class SceneUnsupported(Exception):
    """The engine refuses a model, or cannot model a requirement of a scene or a method; the text says which."""


class EngineDiverged(Exception):
    """The engine itself stopped or reset a simulation of one scene; the text contains the engine's signal and its time.

    A simulation of several scenes does not raise it; see `Simulation.advance`. The attribute `states` (1, k, bodies, 13) holds
    the states after the first k strides; the last of them is the state at the signal. It is empty if the engine does not
    report these states.
    """

    def __init__(self, text: str) -> None:
        super().__init__(text)
        self.states: Array = np.empty((1, 0, 1, 13))


class EngineReset(EngineDiverged):
    """The engine reports that it has reset the simulation to a state that the engine chose."""


class Simulation(Protocol):
    """An engine's model of scenes, with its current state. Building it is set-up; only `advance` is timed."""

    def advance(self, strides: Strides) -> Array:
        """Advance the simulation, and return the states (scenes, n, bodies, 13) after each of n strides.

        The array `strides` (n,) holds the numbers of steps, >= 0, from each sample to the next; the first stride begins at the
        current state. The columns of the states are position (world, m), quaternion (w x y z, body to world, of norm 1),
        velocity (world, m/s) and angular velocity (body, rad/s). The returned array is a copy.

        A simulation of one scene raises `EngineDiverged` if its engine gives up. A simulation of several scenes does not raise
        it, so that a scene that fails does not affect the others: from the engine's signal on, the states of the failed scene
        are NaN, and the states of the other scenes are the same as without it.
        """
        ...


@runtime_checkable
class Signals(Protocol):
    """A simulation of several scenes whose engine can give some of them up."""

    @property
    def signals(self) -> Mapping[int, str]:
        """The signals of the engine so far, with their times, keyed by the indices of the scenes that the engine gave up."""
        ...


@dataclass(frozen=True)
class Work:
    """The work of an engine since the start of a simulation with error control.

    Parameters
    ----------
    steps, rejected, evaluations
        The numbers of steps taken, of rejected steps, and of evaluations of the accelerations; None for what is not counted.
    """

    steps: int
    rejected: int | None
    evaluations: int | None


@runtime_checkable
class ErrorControlled(Simulation, Protocol):
    """A simulation of one scene with a method that has the option `accuracy`; see `bodycheck.adapters.stepping.Controlled`.

    The engine chooses its own steps. `advance` reaches multiples of the largest step.
    """

    def reach(self, times: Array) -> Array:
        """Return the states (1, n, bodies, 13) at ascending times (n,), in s, exactly, in the columns of `Simulation.advance`.

        The samples leave the engine's own steps alone where that is possible. Raises `EngineDiverged` if the engine gives up.
        """
        ...

    def finish(self, time: float) -> None:
        """Step to a time (s), where a step ends, without samples between. Raises `EngineDiverged`."""
        ...

    @property
    def work(self) -> Work:
        """The work since the start."""
        ...


#: When the efforts of driven joints are computed: at the stages of the integrator, or between steps; empty if none is driven.
Efforts = Literal["", "between steps", "at stages"]

#: The law of continuous controllers: the efforts (j,) at a time (s), of coordinates (j,) and velocities (j,) of driven joints.
Law = Callable[[float, Array, Array], Array]


@runtime_checkable
class Driven(Simulation, Protocol):
    """A simulation of one mechanism whose driven joints take efforts between strides.

    The arrays (j,) have the joints of `Mechanism.driven`, in their order. The harness computes the laws of controllers and,
    with the option `limits=effort`, the efforts of elastic stops; the simulation knows neither.
    """

    def state(self) -> tuple[Array, Array]:
        """Return the present coordinates (j,) and velocities (j,) of the driven joints."""
        ...

    def apply(self, efforts: Array) -> None:
        """Exert efforts (j,) from now on, in addition to all other efforts in the joints, until the next call."""
        ...


@runtime_checkable
class Staged(Driven, Protocol):
    """A simulation whose engine lets a law be evaluated at each evaluation of its accelerations, also within a step."""

    def obey(self, law: Law) -> None:
        """Exert from now on the efforts of a law, evaluated at the time and state of each stage of the integrator."""
        ...


@dataclass(frozen=True)
class SensingSimulation:
    """A simulation of one scene, and the function that reads its sensors.

    Parameters
    ----------
    simulation
        The simulation, as of `Adapter.prepare`: if joints of the scene are driven, it is `Driven`.
    read
        Returns a copy of the present reading (k,) of each sensor, in the order of the sensors, in SI units. It is called at the
        start and between strides. A reading has the components of `Sensor.form`, and is NaN where the engine has none yet. With
        the option `sensors=step`, the default, it is what the engine has after a step, and at the start what it has after it
        was reset. With `sensors=forward` the engine first computes all quantities of its present state again, by its own
        function.
    """

    simulation: Simulation
    read: Callable[[], tuple[Array, ...]]


@runtime_checkable
class Normalising(Protocol):
    """A simulation that normalises quaternions because its engine does not; see `stepping.Normalised`."""

    @property
    def quaternion_norm_error(self) -> float:
        """The largest deviation from 1, in all states so far, of the norm of a quaternion as the engine returned it."""
        ...


@runtime_checkable
class Adapter(Protocol):
    """The adapter of one engine. `isinstance` checks only that the attributes exist."""

    @property
    def engine(self) -> Engine:
        """The properties of the engine that do not depend on a scene."""
        ...

    def prepare(self, scenes: Sequence[AnyScene], method: Method) -> Simulation:
        """Return a simulation of the smallest models of the scenes, at t = 0, compiled and warmed up.

        The caller has checked the method against `engine`, and the requirements of the scenes against `Engine.models`: an
        adapter receives only the kinds of scene that its record names. It receives one scene, unless its `batch` is larger
        than 1. It may then receive several free bodies that differ only in their initial states and in the properties that
        `Engine.varies` names, and that have the same requirements: all or none of them move, turn, or have gravity.

        The states of a mechanism are the states of its bodies, in their order: the position and velocity of the centre of mass,
        the attitude of the body's frame, and the angular velocity along the axes of this frame. If bodies touch, no coefficient
        of friction is infinite. Raises `SceneUnsupported` if the engine cannot model a scene or refuses its model.
        """
        ...


@dataclass(frozen=True)
class Model:
    """A model of a scene.

    Parameters
    ----------
    method
        The spelling of the method that selects this model.
    adds
        A description of what this model contains that the next smaller model does not.
    """

    method: str
    adds: str


@runtime_checkable
class Models(Protocol):
    """An adapter that can model a scene in several ways."""

    def models(self, scene: AnyScene, integrator: str) -> Mapping[str, Model]:
        """Return the models of a scene that an integrator can step, keyed by name, from the smallest to the largest.

        The smallest model is exact except for the error of the time steps. The mapping is empty if there is only one model.
        """
        ...


@runtime_checkable
class ContactLaw(Protocol):
    """An adapter that knows the law of friction of its contacts, for a body that lies flat on a level plane."""

    def contact_law(self, scene: Scene, method: Method) -> Plane | None:
        """Return the friction that a method's contacts with the scene's plane would produce if they were rigid.

        The result is the scene's plane with the friction law, the pressure distribution and the coefficient of the contacts;
        None if the reference does not have their law.
        """
        ...


@runtime_checkable
class ContactLoad(Protocol):
    """An adapter whose engine reports the load of a body that lies flat on a level plane."""

    def contact_load(self, scene: Scene, method: Method, steps: int) -> Array | None:
        """Return the normal force (n,), in N, between body and plane in each of n steps; None if the method does not report it.

        Raises `SceneUnsupported` and `EngineDiverged`.
        """
        ...


@runtime_checkable
class InterfaceLoads(Protocol):
    """An adapter whose engine reports the loads between bodies that touch a plane and each other in any way."""

    def interface_loads(self, scene: AnyScene, method: Method, steps: int) -> Mapping[tuple[int, int], Array]:
        """Return the normal forces (n,), in N, between pairs that touch, in each of n steps.

        The keys are the indices of two bodies, the lower first; the index of the plane is `WORLD`. A pair that never touches
        may be left out. Raises `SceneUnsupported` and `EngineDiverged`.
        """
        ...


@runtime_checkable
class ContactTerms(Protocol):
    """An adapter whose engine has other contact laws than scenes state, or other coefficients than those of their pairs."""

    def contact_terms(self, scene: AnyScene, method: Method) -> str:
        """Return what the engine is handed in the place of a scene's friction and restitution; empty if it has exactly these.

        The text is a noun phrase with numbers, such as "friction of a box of two directions; restitution 0.5 as a spring of
        2.5e4 N/m and a damper of 11 N s/m".
        """
        ...


@runtime_checkable
class Sensing(Protocol):
    """An adapter whose engine reads sensors, or quantities that it calls so. `Engine.reads` says when it can read them.

    A simulation with sensors is a run of its own, so that sensors change neither the states nor the cost of a run without them.
    The adapter hands over what the engine gives, along the axes and with the sign that the engine gives it: what differs from
    the meaning of a type of sensor is a finding, which an adapter must not correct.
    """

    def lacking(self, scene: AnyScene, sensor: Sensor, method: Method) -> str | None:
        """Return why the engine does not read a sensor with a method; None if it does.

        The text is a predicate whose subject is the engine, such as "has no sensor of contact forces".
        """
        ...

    def prepare_sensing(self, scene: AnyScene, sensors: Sequence[Sensor], method: Method) -> SensingSimulation:
        """Return a simulation of a scene with sensors at t = 0, reset, compiled and warmed up, as `Adapter.prepare` does.

        The caller has checked that the engine reads each of the sensors. Raises `SceneUnsupported`.
        """
        ...


@runtime_checkable
class Scripts(Protocol):
    """An adapter that can write a run as a script that needs only its engine."""

    def script(self, scene: AnyScene, method: Method, duration: float, samples: int) -> str:
        """Return a Python script that takes the steps of a run and prints its states as CSV to standard output.

        The script imports the engine and NumPy, but nothing of bodycheck. The columns are `bodycheck.adapters.scripts.COLUMNS`.
        The states equal the states of `Simulation.advance` to the last bit, at the ends of the steps that are nearest to evenly
        spaced instants. A mechanism has a row for each body at each instant, in the order of the bodies, with the name of the
        body after the time: the columns are `bodycheck.adapters.scripts.MECHANISM_COLUMNS`.

        Parameters
        ----------
        scene, method
            The scene and the method, which the caller has checked as for `Adapter.prepare`.
        duration, samples
            The duration (s), which is the last instant, and the number of instants, from 0 on.

        Raises
        ------
        SceneUnsupported
            If the engine cannot model the scene, or the adapter cannot write a script of the method.
        """
        ...


@runtime_checkable
class Calls(Protocol):
    """An adapter that names the functions of its engine that its steps call from Python.

    They allow the time of the engine to be measured apart from the time of the Python loop around it.
    """

    @property
    def calls(self) -> Sequence[tuple[Any, str]]:
        """Pairs of a module or a class, and the name of a function in it, which is looked up at each call."""
        ...


def kind_of(scene: AnyScene) -> Kind:
    """Return the kind of a scene."""
    if touches(scene):
        return "contact"
    if isinstance(scene, Mechanism):
        return "mechanism"
    if scene.plane is not None:
        return "plane"
    return "drag" if scene.drag else "flight"


def single_bodies(scenes: Sequence[AnyScene]) -> list[Scene]:
    """Return the scenes, which must be single bodies: an engine steps several scenes together only if they are."""
    bodies = [scene for scene in scenes if isinstance(scene, Scene)]
    assert len(bodies) == len(scenes)  # a mechanism is simulated by itself
    return bodies


def states(position: Any, quaternion: Any, velocity: Any, angular_velocity: Any) -> Array:
    """Return rows (n, 13) of states from positions (n, 3), quaternions (n, 4), velocities (n, 3), angular velocities (n, 3)."""
    return np.concatenate([position, quaternion, velocity, angular_velocity], axis=1, dtype=np.float64)


def single(rows: Array) -> Array:
    """Return the states (1, n, bodies, 13) of one scene, from its rows (n, bodies, 13), or (n, 13) if it has a single body."""
    return rows[None] if rows.ndim == 3 else rows[None, :, None, :]
