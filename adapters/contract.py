"""The contract between bodycheck and the adapter of an engine: a module, or any object, with the attributes of `Adapter`.

An adapter says in one record, `Engine`, what is known without a scene, and makes a `Simulation` of scenes. It may have more:
models of a scene that grow (`Models`), the friction law and the load of its contacts (`Contact`). What it does not have it
leaves out. Misspelled methods, scenes that the engine cannot model, and several scenes for an engine that steps one at a time
are handled once for all adapters (`bodycheck.adapters.offers`).

An adapter converts at its border, nowhere else: scenes come in and states go out in the conventions of
`bodycheck.reference.scene`, whatever the engine's own are. It imports its engine and this package, nothing of cases, truth or
reports.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from bodycheck.adapters.method import Method as Method
from bodycheck.reference.scene import Plane, Scene
from bodycheck.reference.trajectory import Array

Strides = NDArray[np.int64]

#: Kinds of scene for which engines offer different integrators: free flight, flight against drag, and a body on a plane.
Kind = Literal["flight", "drag", "plane"]
KINDS: frozenset[Kind] = frozenset({"flight", "drag", "plane"})


@dataclass(frozen=True)
class Option:
    """An option of an integrator.

    Parameters
    ----------
    allowed
        The allowed values in words, for messages.
    read
        Raises `ValueError` for a value that is not allowed.
    kinds
        The kinds of scene in which the option means something.
    """

    allowed: str
    read: Callable[[str], object] = str
    kinds: frozenset[Kind] = KINDS


@dataclass(frozen=True)
class Integrator:
    """An integrator of an engine.

    Parameters
    ----------
    name
        By the engine's own name.
    order
        Of the error in the time step on smooth motion, as the engine or a textbook claims; None where nothing is claimed.
    evaluations
        Of the accelerations in one step; None where the number is not known.
    kinds
        The kinds of scene for which it is offered; none where the installed release lacks it.
    options
        By their keys.
    """

    name: str
    order: int | None = None
    evaluations: int | None = None
    kinds: frozenset[Kind] = KINDS
    options: Mapping[str, Option] = field(default_factory=dict)


@dataclass(frozen=True)
class Engine:
    """What is known of an engine without a scene.

    Parameters
    ----------
    name
        The name by which bodycheck finds the adapter.
    distribution
        The package that installs the engine, as pip names it.
    version
        The engine's own version.
    integrators
        All that the adapter knows.
    models
        What of a scene it can model, by the names of `bodycheck.reference.requirements.Requirements`.
    variants
        Methods with options that are run, besides the integrators, where no method is asked for: spellings by kind of scene.
    precision, device
        Of the engine's arithmetic.
    batch
        The number of scenes in one call of `prepare` from which the engine gains; 1 where it steps one scene at a time.
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


class SceneUnsupported(Exception):
    """The engine cannot model something that a scene or a method requires, or refuses the model; the text says what."""


class EngineDiverged(Exception):
    """The engine itself gave up or started over; the text says what it signalled, and when.

    states: (scenes, k, bodies, 13) after the first k strides, the last of them that in which the signal left the engine; none
    where the engine cannot tell.
    """

    def __init__(self, text: str) -> None:
        super().__init__(text)
        self.states: Array = np.empty((1, 0, 1, 13))


class EngineReset(EngineDiverged):
    """The engine says that it started over, from a state of its own."""


class Simulation(Protocol):
    """An engine's model of scenes, standing at some instant. Building it is set-up; only `advance` is timed."""

    def advance(self, strides: Strides) -> Array:
        """Step on, and return the states (scenes, n, bodies, 13) after each of n strides.

        strides: (n,) numbers of steps >= 0 from each sample to the next, the first from where the simulation stands.
        Columns: position (world, m), quaternion (w x y z, body to world), velocity (world, m/s), angular velocity
        (body, rad/s). The array is a copy. Raises `EngineDiverged`.
        """
        ...


@runtime_checkable
class Adapter(Protocol):
    """One engine. `isinstance` only looks whether the attributes are there."""

    @property
    def engine(self) -> Engine:
        """What is known without a scene."""
        ...

    def prepare(self, scenes: Sequence[Scene], method: Method) -> Simulation:
        """The smallest models of the scenes, at t = 0, compiled and warm.

        An engine whose `batch` is 1 is given one scene. The method has been checked against `engine`, and the scenes against
        `engine.models`. Raises `SceneUnsupported`.
        """
        ...


@dataclass(frozen=True)
class Model:
    """A model of a scene. method: the spelling of the method that asks for it. adds: what it has that the last one has not."""

    method: str
    adds: str


@runtime_checkable
class Models(Protocol):
    """An adapter that can model a scene in several ways."""

    def models(self, scene: Scene, integrator: str) -> Mapping[str, Model]:
        """The models of a scene on which an integrator can be run, by name, in order of growth.

        The first is the smallest that is exact but for the steps. Empty where there is no choice.
        """
        ...


@runtime_checkable
class Contact(Protocol):
    """An adapter that knows what its contacts do."""

    def contact_law(self, scene: Scene, method: Method) -> Plane | None:
        """The friction that a method's contacts with the scene's plane would make if they were rigid.

        That is the scene's plane with the law, the pressure and the coefficient of the contacts; None where these are none of
        the reference's.
        """
        ...

    def contact_load(self, scene: Scene, method: Method, steps: int) -> Array | None:
        """The normal force (n,), N, between body and plane in each of n steps; None where the engine cannot tell.

        Raises as `Adapter.prepare` and `Simulation.advance` do.
        """
        ...


def kind_of(scene: Scene) -> Kind:
    """The kind of a scene."""
    if scene.plane is not None:
        return "plane"
    return "drag" if scene.drag else "flight"


def choice(*words: str, kinds: frozenset[Kind] = KINDS) -> Option:
    """An option that takes one of some words."""

    def read(value: str) -> str:
        if value not in words:
            raise ValueError(value)
        return value

    return Option(" or ".join(filter(None, (", ".join(words[:-1]), words[-1]))), read, kinds)


def states(position: Any, quaternion: Any, velocity: Any, angular_velocity: Any) -> Array:
    """Rows (n, 13) of states from their parts (n, 3), (n, 4), (n, 3), (n, 3)."""
    return np.concatenate([position, quaternion, velocity, angular_velocity], axis=1, dtype=np.float64)


def single(rows: Array) -> Array:
    """The states (1, n, 1, 13) of one scene with one body, from its rows (n, 13)."""
    return rows[None, :, None, :]
