"""What an engine's adapter offers: a module (or any object) with the functions of `Adapter`.

An adapter converts at its border, nowhere else: scenes come in and states go out in the conventions of
`bodycheck.reference.scene`, whatever the engine's own are. It knows its engine and this contract, nothing of cases,
truth or reports.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference.scene import Plane, Scene
from bodycheck.reference.trajectory import Array

Strides = NDArray[np.int64]


@dataclass(frozen=True)
class Method:
    """How an engine steps: one of its integrators, by the engine's own name, and the time step (s)."""

    integrator: str
    timestep: float


@dataclass(frozen=True)
class Claim:
    """What is to be expected of an integrator, by what its engine or its textbook says.

    order: of its error in the time step, on smooth motion; None where nothing is said.
    evaluations: of the accelerations in one step; None where that is not known.
    """

    order: int | None
    evaluations: int | None


#: Between the name of an integrator and that of one of its `models`, in the name of a method.
MODEL_OPTION = ":model="


class SceneUnsupported(Exception):
    """The engine cannot model something that the scene requires, or refuses the model; the text says what."""


class EngineDiverged(Exception):
    """The engine itself gave up or started over; the text says what it signalled, and when.

    rows: the states (k, 13) after the first k strides, the last of them that in which the signal left the engine; none where
    the engine cannot tell.
    """

    def __init__(self, text: str) -> None:
        super().__init__(text)
        self.rows: Array = np.empty((0, 13))


class EngineReset(EngineDiverged):
    """The engine says that it started over, from a state of its own."""


class Simulation(Protocol):
    """An engine's model of a scene, standing at some instant. Building it is set-up; only `advance` is timed."""

    def advance(self, strides: Strides) -> Array:
        """Step on and return the states (n, 13) after each of n strides.

        strides: (n,) numbers of steps >= 0 from each sample to the next, the first from where the simulation stands.
        Columns: position (world, m), quaternion (w x y z, body to world), velocity (world, m/s), angular velocity
        (body, rad/s). Raises `EngineDiverged`.
        """
        ...


class Adapter(Protocol):
    """One engine."""

    def version(self) -> str:
        """The engine's own version."""
        ...

    def integrators(self, scene: Scene | None = None) -> tuple[str, ...]:
        """The integrators that the installed version offers for a scene; without one, all of them."""
        ...

    def claim(self, integrator: str) -> Claim:
        """What is claimed of an integrator, whose name may have options behind a colon."""
        ...

    def unsupported(self, scene: Scene) -> str | None:
        """What the scene requires and the engine cannot model, by the names of `Requirements`; None where it can."""
        ...

    def models(self, scene: Scene, integrator: str) -> Mapping[str, str]:
        """The models of a scene on which an integrator can be run, in order of growth, and what each has more than the last.

        The first is the smallest that is exact but for the steps. One is asked for behind the integrator's name, as in
        `Euler:model=six-coordinates`. Empty where there is no choice.
        """
        ...

    def contact_law(self, scene: Scene, integrator: str) -> Plane | None:
        """The friction that an integrator's contacts with the scene's plane would make if they were rigid.

        That is the scene's plane with the law and the pressure of the contacts; None where these are none of the reference's.
        """
        ...

    def contact_load(self, scene: Scene, method: Method, steps: int) -> Array | None:
        """The normal force (n,), N, between body and plane in each of n steps; None where the engine cannot tell.

        Raises as `prepare` and `Simulation.advance` do.
        """
        ...

    def prepare(self, scene: Scene, method: Method) -> Simulation:
        """The smallest model of the scene, at t = 0. Raises `SceneUnsupported`."""
        ...


def states(position: Any, quaternion: Any, velocity: Any, angular_velocity: Any) -> Array:
    """Rows (n, 13) of `Simulation.advance` from their parts."""
    return np.concatenate([position, quaternion, velocity, angular_velocity], axis=1, dtype=np.float64)
