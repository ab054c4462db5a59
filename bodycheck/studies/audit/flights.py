"""Flights: short runs of one free body, or of bodies on joints or in contact, which are made in the present process."""

from dataclasses import dataclass, field

import numpy as np

from bodycheck.adapters import offers
from bodycheck.adapters.contract import Adapter, EngineDiverged, Method, Normalising, SceneUnsupported, Simulation
from bodycheck.adapters.links import Link, Links
from bodycheck.judging.schemes.scheme_rounding import ROUNDOFF
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array


@dataclass(frozen=True)
class Flight:
    """A short run that a probe requests.

    Parameters
    ----------
    scene
        The scene: a body, bodies on joints, or free boxes that touch a level plane and each other. If there are links, its
        initial state is the state of the frame of the first link.
    timestep
        The time step (s).
    strides
        The numbers of steps from each state to the next, the first from the start.
    links
        The links of which the body is made for the engine; empty if the engine is given the body of the scene.
    """

    scene: AnyScene
    timestep: float
    strides: tuple[int, ...]
    links: tuple[Link, ...] = ()


@dataclass(frozen=True)
class Flown:
    """The states of a flight.

    Parameters
    ----------
    states
        The states (n, 13) after each stride, in the columns of `Simulation.advance`; (n, bodies, 13) for a mechanism.
    quaternion_norm_error
        The largest deviation from 1 of the norm of a quaternion, as the engine returned it.
    """

    states: Array
    quaternion_norm_error: float


@dataclass(frozen=True)
class NotFlown:
    """The reason why the engine gave up a flight, or refused to begin it (`refused`)."""

    reason: str
    refused: bool = False


#: The result of a flight.
Result = Flown | NotFlown


@dataclass(frozen=True)
class Pilot:
    """The maker of flights with one method of one engine.

    Parameters
    ----------
    adapter
        The adapter of the engine.
    integrator
        The spelling of the method.
    timestep
        The time step (s) at which the method is audited; a probe may use other time steps.
    log
        The results of the flights that `recall` has made.
    """

    adapter: Adapter
    integrator: str
    timestep: float
    log: dict[Flight, Result] = field(default_factory=dict, compare=False, repr=False)

    @property
    def roundoff(self) -> float:
        """The unit roundoff of the precision that the adapter states; a probe may find another."""
        return ROUNDOFF[self.adapter.engine.precision]

    def fly(self, flight: Flight) -> Result:
        """Make a flight and return its result. If the engine refuses the scene or gives up, the result is `NotFlown`.

        All other exceptions are passed on.
        """
        method = Method.parse(self.integrator, flight.timestep)
        try:
            simulation = self.simulation(flight, method)
            states = np.array(simulation.advance(np.array(flight.strides, dtype=np.int64)), dtype=np.float64)[0]
        except SceneUnsupported as error:
            return NotFlown(str(error), refused=True)
        except EngineDiverged as error:
            return NotFlown(str(error))
        norms = np.linalg.norm(states[..., 3:7], axis=-1)
        off = float(np.nan_to_num(np.abs(norms - 1), nan=np.inf).max(initial=0.0))
        if isinstance(simulation, Normalising):
            off = max(off, simulation.quaternion_norm_error)
        return Flown(states if isinstance(flight.scene, Mechanism) else states[:, 0], off)

    def recall(self, flight: Flight) -> Result:
        """Return the result of a flight. It is made only at the first call, because several probes use the same flight."""
        if flight not in self.log:
            self.log[flight] = self.fly(flight)
        return self.log[flight]

    def simulation(self, flight: Flight, method: Method) -> Simulation:
        """Return a simulation of the scene of a flight. Raises `SceneUnsupported` and `EngineDiverged`."""
        scene, adapter = flight.scene, self.adapter
        if flight.links:
            assert isinstance(scene, Scene)
            if not isinstance(adapter, Links):
                raise SceneUnsupported("the adapter cannot give the engine a body as links")
            return adapter.prepare_links(flight.links, scene, method)
        if isinstance(scene, Mechanism) and scene.plane is not None:
            if "contacts" not in adapter.engine.models:
                raise SceneUnsupported("the adapter cannot give the engine free boxes that touch")
            if (lacking := offers.not_offered(adapter.engine, scene, method)) is not None:
                raise SceneUnsupported(f"{adapter.engine.name} {lacking}")
        return offers.prepare(adapter, [scene], method)
