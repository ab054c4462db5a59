"""The contract between bodycheck and the adapter of an engine: a module, or any object, with the attributes of `Adapter`.

An adapter describes its engine in one record, `Engine`, and builds a `Simulation` from scenes by one function, `prepare`. The
record says as data which scenes the engine can model, with which integrators, and how many of them together. Everything else is
optional, and an adapter leaves out what its engine does not have: `Models` for several models of a scene, `ContactLaw`,
`ContactLoad` and `InterfaceLoads` for what its contacts do, `Scripts` for a run as a script for the engine alone, and `Calls`
for the functions of the engine which its steps call. `bodycheck.adapters.links.Links` is for engines that take a body as links
welded together, and `bodycheck.adapters.robot_reading.RobotModels` for engines that read files of robots.
`bodycheck.adapters.offers` handles for all adapters misspelled methods, scenes that an engine cannot model, and several scenes
for an engine that steps one scene at a time.

Scenes and states follow the conventions of `bodycheck.reference.scene`. An adapter converts them to and from the conventions
of its engine. It imports its engine and this package, but nothing of cases, truth or reports.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from bodycheck.adapters.method import KINDS as KINDS
from bodycheck.adapters.method import Kind as Kind
from bodycheck.adapters.method import Method as Method
from bodycheck.adapters.method import Option as Option
from bodycheck.adapters.method import Range as Range
from bodycheck.adapters.method import choice as choice
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.requirements import touches
from bodycheck.reference.scene import Plane, Scene
from bodycheck.reference.trajectory import Array

Strides = NDArray[np.int64]

#: What may differ between scenes that an engine steps together: mass, moments, axes and shape of the body; the gravity.
Varied = Literal["body", "gravity"]


@dataclass(frozen=True)
class Integrator:
    """An integrator of an engine.

    Parameters
    ----------
    name
        The name that the engine itself uses.
    order
        The order of the error in the time step on smooth motion that the engine or a textbook claims; None if nobody does.
    evaluations
        The number of evaluations of the accelerations in one step; None if it is not known.
    kinds
        The kinds of scene for which the integrator is offered; empty if the installed release lacks it.
    options
        The options of the integrator by their keys.
    demonstrates
        What the integrator is there to demonstrate, as a phrase; empty for an integrator that users choose.
    """

    name: str
    order: int | None = None
    evaluations: int | None = None
    kinds: frozenset[Kind] = KINDS
    options: Mapping[str, Option] = field(default_factory=dict)
    demonstrates: str = ""


@dataclass(frozen=True)
class Engine:
    """The properties of an engine that do not depend on a scene.

    Parameters
    ----------
    name
        The name by which bodycheck finds the adapter.
    distribution, version
        The package that installs the engine, as pip names it, and the engine's own version.
    integrators
        All integrators that the adapter knows.
    models
        The requirements of a scene that the engine can model, by the field names of
        `bodycheck.reference.requirements.Requirements`, and those of mechanisms, by the names in
        `bodycheck.reference.requirements.MechanismRequirements`.
    variants
        Spellings of methods with options, by kind of scene. If the user names no method, they are run with the integrators.
    precision, device
        The precision and the device of the engine's arithmetic.
    batch
        The number of scenes per call of `prepare` from which batching pays off; 1 if the engine steps one scene at a time. An
        engine whose `batch` is larger takes any number of scenes that differ in their initial states and in what `varies` has.
    varies
        What may differ between such scenes besides their initial states; see `Adapter.prepare`.
    defaults
        What the engine itself chooses where a user does not: "integrator", "timestep" and "tolerance", as far as it has them,
        with values and units such as {"timestep": "0.002 s"}.
    """

    name: str
    distribution: str
    version: str
    integrators: tuple[Integrator, ...]
    models: frozenset[str]
    variants: Mapping[Kind, tuple[str, ...]] = field(default_factory=dict)
    precision: Literal["float64", "float32"] = "float64"
    device: Literal["cpu", "cuda"] = "cpu"
    batch: int = 1
    varies: frozenset[Varied] = frozenset()
    defaults: Mapping[str, str] = field(default_factory=dict)


class SceneUnsupported(Exception):
    """The engine refuses a model, or cannot model something that a scene or a method requires; the text says what."""


class EngineDiverged(Exception):
    """The engine itself stopped or reset a simulation of one scene; the text says what it signalled, and when.

    A simulation of several scenes does not raise it; see `Simulation.advance`. The attribute `states` (1, k, bodies, 13) holds
    the states after the first k strides, of which the last is the state at the signal. It is empty if the engine does not
    report them.
    """

    def __init__(self, text: str) -> None:
        super().__init__(text)
        self.states: Array = np.empty((1, 0, 1, 13))


class EngineReset(EngineDiverged):
    """The engine reports that it has reset the simulation to a state of its own choice."""


class Simulation(Protocol):
    """An engine's model of scenes, with its current state. Building it is set-up; only `advance` is timed."""

    def advance(self, strides: Strides) -> Array:
        """Advance the simulation, and return the states (scenes, n, bodies, 13) after each of n strides.

        The array `strides` (n,) holds the numbers of steps, >= 0, from each sample to the next; the first stride begins at the
        current state. The columns of the states are position (world, m), quaternion (w x y z, body to world, of norm 1),
        velocity (world, m/s) and angular velocity (body, rad/s). The returned array is a copy.

        A simulation of one scene raises `EngineDiverged` where its engine gives up. One of several scenes does not raise it, so
        that a scene that fails does not take the others with it: from the engine's signal on, the states of that scene are NaN,
        and the others are what they are without it.
        """
        ...


@runtime_checkable
class Signals(Protocol):
    """A simulation of several scenes whose engine can give some of them up."""

    @property
    def signals(self) -> Mapping[int, str]:
        """The signals of the engine so far, with their times, by the indices of the scenes that it gave up."""
        ...


@runtime_checkable
class Normalising(Protocol):
    """A simulation that normalises the quaternions of its engine, which does not do so; see `stepping.Normalised`."""

    @property
    def quaternion_norm_error(self) -> float:
        """The largest deviation from 1 of the norm of a quaternion, as the engine returned it, in all states so far."""
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

        The caller has checked the method against `engine`, and what the scenes require against `Engine.models`: an adapter
        gets only the kinds of scene that its record names. It gets one scene, but for an engine whose `batch` is larger than 1.
        That may get several free bodies which differ in their initial states and in what `Engine.varies` names, and require the
        same: all or none of them move, turn, or have gravity.

        The states of a mechanism are those of its bodies, in their order: the position and velocity of the centre of mass, the
        attitude of the body's frame, and the angular velocity along its axes. Where bodies touch, no coefficient of friction
        is infinite. Raises `SceneUnsupported`.
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
        A description of what this model contains and the next smaller one does not.
    """

    method: str
    adds: str


@runtime_checkable
class Models(Protocol):
    """An adapter that can model a scene in several ways."""

    def models(self, scene: AnyScene, integrator: str) -> Mapping[str, Model]:
        """Return the models of a scene on which an integrator can be run, by name, from the smallest to the largest.

        The smallest model is exact except for the error of the time steps. The mapping is empty if there is no choice.
        """
        ...


@runtime_checkable
class ContactLaw(Protocol):
    """An adapter that knows the law of friction of its contacts, for a body that lies flat on a level plane."""

    def contact_law(self, scene: Scene, method: Method) -> Plane | None:
        """Return the friction that a method's contacts with the scene's plane would produce if they were rigid.

        The result is the scene's plane with the law, the pressure and the coefficient of the contacts; None if the reference
        has no such law.
        """
        ...


@runtime_checkable
class ContactLoad(Protocol):
    """An adapter whose engine reports the load of a body that lies flat on a level plane."""

    def contact_load(self, scene: Scene, method: Method, steps: int) -> Array | None:
        """Return the normal force (n,), in N, between body and plane in each of n steps; None if the method has none to report.

        Raises `SceneUnsupported` and `EngineDiverged`.
        """
        ...


@runtime_checkable
class InterfaceLoads(Protocol):
    """An adapter whose engine reports the loads between bodies that touch a plane and each other in any way."""

    def interface_loads(self, scene: AnyScene, method: Method, steps: int) -> Mapping[tuple[int, int], Array]:
        """Return the normal forces (n,), in N, between pairs that touch, in each of n steps.

        The keys are the indices of two bodies, the lower first; that of the plane is `WORLD`. A pair that never touches may be
        left out. Raises `SceneUnsupported` and `EngineDiverged`.
        """
        ...


@runtime_checkable
class Scripts(Protocol):
    """An adapter that can write what a run does as a script for its engine alone."""

    def script(self, scene: AnyScene, method: Method, duration: float, samples: int) -> str:
        """Return a Python script that takes the steps of a run and prints its states as CSV to standard output.

        The script imports the engine and NumPy, but nothing of bodycheck. The columns are `bodycheck.adapters.scripts.COLUMNS`,
        and the states those of `Simulation.advance` to the last bit, at the ends of the steps that are nearest to evenly
        spaced instants. The rows of a mechanism have the name of a body after the time, the bodies in their order at each
        instant: the columns are `bodycheck.adapters.scripts.MECHANISM_COLUMNS`.

        Parameters
        ----------
        scene, method
            The scene and the method, which the caller has checked as for `Adapter.prepare`.
        duration, samples
            The duration (s), which is the last instant, and the number of instants, from 0 on.

        Raises
        ------
        SceneUnsupported
            If the engine cannot model the scene, or there is no such script of the method.
        """
        ...


@runtime_checkable
class Calls(Protocol):
    """An adapter that names the functions of its engine which its steps call from Python.

    With them the time of the engine is told apart from that of the Python loop around it.
    """

    @property
    def calls(self) -> Sequence[tuple[Any, str]]:
        """Pairs of an object, which is a module or a class, and the name of a function in it that is looked up at each call."""
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
    """Return scenes that are single bodies, of which alone an engine gets several together."""
    bodies = [scene for scene in scenes if isinstance(scene, Scene)]
    assert len(bodies) == len(scenes)  # a mechanism is simulated by itself
    return bodies


def states(position: Any, quaternion: Any, velocity: Any, angular_velocity: Any) -> Array:
    """Return rows (n, 13) of states from their parts (n, 3), (n, 4), (n, 3) and (n, 3), in this order."""
    return np.concatenate([position, quaternion, velocity, angular_velocity], axis=1, dtype=np.float64)


def single(rows: Array) -> Array:
    """Return the states (1, n, bodies, 13) of one scene, from its rows (n, bodies, 13), or (n, 13) of its only body."""
    return rows[None] if rows.ndim == 3 else rows[None, :, None, :]
