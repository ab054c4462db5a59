"""Figures of a run: their names, units and meanings, and how they are computed from a comparison with the truth."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from bodycheck.figures.column import Column, Kind
from bodycheck.reference.bodies import bodies, motions
from bodycheck.reference.bounds import Bounds
from bodycheck.reference.contact.impacts import Impact, impacts
from bodycheck.reference.contact.meetings import Meeting, meetings
from bodycheck.reference.contact.motion import Event, Interface
from bodycheck.reference.contact.observables import stays
from bodycheck.reference.contact.touching import Touching, pushes_on, touching
from bodycheck.reference.contact_observables import measured_stop
from bodycheck.reference.mechanisms import kinematics
from bodycheck.reference.mechanisms import observables as mechanism_observables
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.mechanisms.observables import MechanismObservables
from bodycheck.reference.observables import Observables
from bodycheck.reference.observables import observe as observe_body
from bodycheck.reference.planar import Stop
from bodycheck.reference.requirements import touches
from bodycheck.reference.scene import Scene, Sphere
from bodycheck.reference.scenes import Scenes
from bodycheck.reference.sensors.readings import Sensed
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truths import Truth

#: The presence of the column of a figure: with a value in every completed run, as a column in every table, or as a column only
#: in tables in which a run has a value.
Presence = Literal["every run", "every table", "where measured"]

#: An instant whose distance from an impact, relative to the time of the impact, is below this may be before or after it.
ROUNDED_TIME = 1e-12


@dataclass(frozen=True)
class Load:
    """The load on the plane while a body slides: mean and peak in weights of the body, and fraction of steps with load."""

    mean_load: float
    peak_load: float
    time_in_contact: float


@dataclass(frozen=True)
class InterfaceLoad:
    """The load in a run between two bodies that should rest on each other, or between a body and the plane.

    Attributes
    ----------
    bodies
        The indices of the bodies, the smaller first.
    load
        The mean normal force (N) over the steps from 1 s on, or from half of the run on if that is earlier.
    losses
        The number of times that the force vanishes in these steps.
    """

    bodies: tuple[int, int]
    load: float
    losses: int


#: The indices of two bodies, in ascending order.
Pair = tuple[int, int]

#: Energies and momenta of one body, or of the bodies of a mechanism.
AnyObservables = Observables | MechanismObservables


def observe(scene: AnyScene | Scenes, trajectory: Trajectory) -> AnyObservables:
    """Return the energies and momenta of any scene at every instant of a trajectory."""
    if isinstance(scene, Mechanism):
        return mechanism_observables.observe(scene, trajectory)
    return observe_body(scene, trajectory)


class Exact(Protocol):
    """The exact values for comparisons with runs: the truth of a scene, `Truth`, or the truths of m scenes in free flight.

    For several scenes, the first axis of all arrays is the scenes, except for the common instants. For a mechanism, the first
    axis of the states is its bodies.
    """

    @property
    def scene(self) -> AnyScene | Scenes:
        """The scene, or the scenes."""
        ...

    @property
    def trajectory(self) -> Trajectory:
        """The exact states."""
        ...

    @property
    def bounds(self) -> Bounds:
        """Bounds of their errors."""
        ...

    @property
    def stop(self) -> Stop | None:
        """The stop of a body that slides to rest."""
        ...


@dataclass(frozen=True, eq=False)
class Comparison:
    """A run's trajectory and the truth at the same instants, from which figures are computed.

    The states of a mechanism have the bodies as their first axis. Runs of several scenes are compared at once if the first axis
    of the arrays of truth and trajectory is the scenes. The results then have this axis too. For each scene they are equal to
    the results of comparing it alone, to the last bit.

    Attributes
    ----------
    truth
        The truth of the scene, at the instants of the trajectory.
    trajectory
        The states of the run at n instants.
    load
        The load on the plane; None without a plane, or if the engine does not measure it.
    quaternion_norm_error
        The largest deviation from 1 of the norm of a quaternion, as the engine returned it; (m,) for m scenes; None if it is
        not known.
    interfaces
        The loads between bodies that rest; None if the engine does not report them.
    sensors, sensed
        The sensors of the case, and their readings in the run; None if the engine reads none.
    """

    truth: Exact
    trajectory: Trajectory
    load: Load | None = None
    quaternion_norm_error: float | Array | None = None
    interfaces: tuple[InterfaceLoad, ...] | None = None
    sensors: tuple[Sensor, ...] = ()
    sensed: Sensed | None = None

    @property
    def scene(self) -> AnyScene | Scenes:
        """The scene of the truth."""
        return self.truth.scene

    @property
    def conserves(self) -> bool:
        """True if energy and angular momentum are conserved, as they are in several scenes, which are all in free flight."""
        return isinstance(self.scene, Scenes) or self.scene.conserves

    @property
    def on_plane(self) -> Scene | None:
        """The scene, if it has a plane."""
        return self.scene if isinstance(self.scene, Scene) and self.scene.plane is not None else None

    @property
    def mechanism(self) -> Mechanism | None:
        """The scene, if it is a mechanism."""
        return self.scene if isinstance(self.scene, Mechanism) else None

    @cached_property
    def seen(self) -> AnyObservables:
        """Energies and momenta of the run."""
        return observe(self.scene, self.trajectory)

    @cached_property
    def expected(self) -> AnyObservables:
        """Energies and momenta of the truth."""
        return observe(self.scene, self.truth.trajectory)

    @cached_property
    def joints(self) -> tuple[Array, Array]:
        """The joint coordinates (n, c) of a mechanism in the run and in the truth, by the same formula."""
        assert isinstance(self.scene, Mechanism)
        seen, exact = (kinematics.joints(self.scene, motion).position for motion in (self.trajectory, self.truth.trajectory))
        return seen, exact

    def of_bodies(self, values: Array) -> Array:
        """Return the largest (n,) of values (b, n) over the bodies of a mechanism; for other scenes, `values`."""
        return values if self.mechanism is None else np.asarray(values.max(axis=0))

    @cached_property
    def touching(self) -> tuple[Touching, ...]:
        """The bodies in contact in a scene; empty if there are none, or one body lies flat on a level plane."""
        return () if isinstance(self.scene, Scenes) or not touches(self.scene) else touching(self.scene)

    @cached_property
    def motions(self) -> tuple[tuple[Trajectory, Trajectory], ...]:
        """The motions of each body of a scene in the run and in the truth; empty for several scenes."""
        if isinstance(self.scene, Scenes):
            return ()
        return tuple(zip(motions(self.scene, self.trajectory), motions(self.scene, self.truth.trajectory), strict=True))

    @property
    def events(self) -> tuple[Event, ...]:
        """The events of the truth."""
        return self.truth.events if isinstance(self.truth, Truth) else ()

    @property
    def exact_interfaces(self) -> tuple[Interface, ...]:
        """The exact loads between bodies that rest."""
        return self.truth.interfaces if isinstance(self.truth, Truth) else ()

    @cached_property
    def impacts(self) -> tuple[tuple[Impact, ...], ...]:
        """The impacts of the run on the plane, by body."""
        return self._on_plane([run for run, _ in self.motions], self.meetings)

    @cached_property
    def exact_impacts(self) -> tuple[tuple[Impact, ...], ...]:
        """The impacts of the truth on the plane, by body, measured as those of the run."""
        return self._on_plane([exact for _, exact in self.motions], self.exact_meetings)

    def _on_plane(self, moved: Sequence[Trajectory], met: Mapping[Pair, tuple[Meeting, ...]]) -> tuple[tuple[Impact, ...], ...]:
        """Return the impacts of bodies on the plane, by body, without those of two bodies on each other."""
        if isinstance(self.scene, Scenes):
            return ()
        scene, by_body = self.scene, []
        for index, body in enumerate(self.touching):
            others = [hit for pair, hits in met.items() if index in pair for hit in hits]
            hits = impacts(body, moved[index], scene.gravity, pushes_on(scene, index))
            alone = (hit for hit in hits if not any(hit.start < each.end and each.start < hit.end for each in others))
            by_body.append(tuple(alone))
        return tuple(by_body)

    @cached_property
    def meetings(self) -> dict[Pair, tuple[Meeting, ...]]:
        """The impacts of the run in which two bodies hit each other, by the pairs of bodies that do in the truth."""
        return self._meetings([run for run, _ in self.motions])

    @cached_property
    def exact_meetings(self) -> dict[Pair, tuple[Meeting, ...]]:
        """The impacts of the truth in which two bodies hit each other, measured as those of the run."""
        return self._meetings([exact for _, exact in self.motions])

    def _meetings(self, moved: Sequence[Trajectory]) -> dict[Pair, tuple[Meeting, ...]]:
        scene = self.scene
        pairs = {(event.body, event.other) for event in self.events if event.kind == "impact" and event.body < event.other}
        if isinstance(scene, Scenes) or not pairs:
            return {}
        radii = [body.shape.radius if isinstance(body.shape, Sphere) else math.nan for body in bodies(scene)]
        # The largest changes by a plane are those of a sphere that slips on it and of one that flies.
        unseen = 0.0 if scene.plane is None else 2 * scene.gravity * (1 + scene.plane.friction)
        return {
            (one, other): meetings(moved[one], moved[other], radii[one] + radii[other], unseen) for one, other in sorted(pairs)
        }

    @cached_property
    def between_events(self) -> NDArray[np.bool_] | None:
        """Whether run and truth have had the same impacts at each instant (n,); None if the truth has no impacts.

        Velocities jump at impacts, and are compared at these instants only, but not between an impact of the truth and the same
        impact of the run. Once the truth no longer bounces, velocities are compared at all instants, because bounces of the run
        are then errors.
        """
        if not (self.meetings or any(event.ends_flight for event in self.events)):
            return None
        between = np.full(len(self.trajectory), True)
        for index, body in enumerate(self.touching):
            exact_impacts = [event.time for event in self.events if event.ends_flight and event.body == index]
            if exact_impacts:
                settled = stays(body, self.motions[index][1], self.truth.bounds.velocity_error)
                between &= _alike(self.trajectory.t, exact_impacts, self.impacts[index], settled)
        never = np.zeros(len(self.trajectory), dtype=bool)
        for pair, seen in self.meetings.items():
            exact_impacts = [event.time for event in self.events if (event.body, event.other) == pair]
            between &= _alike(self.trajectory.t, exact_impacts, seen, never)
        return between

    @cached_property
    def stop(self) -> Stop:
        """The stop of the run of one scene."""
        assert isinstance(self.scene, Scene)
        return measured_stop(self.scene, self.trajectory)


def _alike(t: Array, there: Sequence[float], seen: Sequence[Impact | Meeting], settled: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return whether a run has had the impacts of the truth (n,). settled (n,): whether the truth no longer bounces."""
    had, should = (np.searchsorted(times, t, side="right") for times in (np.array([hit.time for hit in seen]), np.array(there)))
    alike = np.asarray((had == should) | settled)
    for time, hit in zip(there, seen, strict=False):
        first, last = sorted((time, hit.time))
        alike &= ((t <= hit.start) | (t >= hit.end)) & ((t < first) | (t >= last))
        alike &= (t < hit.time) | (t > hit.start)  # a body with a late impact falls below the plane
        alike &= np.abs(t - time) > ROUNDED_TIME * time
    return alike


@dataclass(frozen=True)
class Scales:
    """Sizes of the numbers whose differences are figures, from which the effect of rounding is estimated.

    Attributes
    ----------
    length, speed, angle, rate, duration
        Sizes of positions (m), velocities (m/s), angles (rad), angular velocities (rad/s) and times (s).
    energy, rotational_energy, angular_momentum
        Largest energies and angular momentum, divided by the sizes to which their drifts and errors are relative.
    """

    length: float
    speed: float
    angle: float
    rate: float
    duration: float
    energy: float
    rotational_energy: float
    angular_momentum: float


@dataclass(frozen=True, kw_only=True)
class Figure(Column):
    """A column with a figure of a run: everything that bodycheck knows about it.

    Attributes
    ----------
    compute
        Function from a comparison to the figure: an array (n,) of non-negative values if `largest` is set, else a number. For
        several scenes it returns arrays (m, n) or (m,), so it must index trajectories from the last axes. It returns None if
        the figure does not exist in the scene or was not measured.
    scale
        Function from `Scales` to the size of the numbers whose difference is the figure, in the figure's unit.
    limited
        Whether a case file may limit the figure.
    presence
        In which runs and tables the column has a value.
    ideal
        The value of a run without any error.
    most
        Function from the last instant of a run (s) to the largest value that the figure can have, in its unit; infinite if
        there is none. A limit at or above it cannot fail.
    bounded_by
        Name of the column with the bound of the truth's own error in the figure; empty if there is none.
    of_truth
        Whether the figure describes the truth and not the engine.
    jumps
        Whether the figure is a difference of velocities, which jump at impacts: it is left out at instants at which run and
        truth have not had the same impacts.
    revision
        The number of the figure's definition. It rises by 1 when the same run gets another value, so that values of baselines
        with different definitions are not compared.
    formerly
        The definition of the figure in the previous revision, in words.
    tabled, plotted
        Whether a report shows the figure in the table of a case, and whether it plots the figure over time.
    """

    kind: Kind = "number"
    compute: Callable[[Comparison], Array | float | None]
    scale: Callable[[Scales], float] = lambda _: 1.0
    limited: bool = True
    presence: Presence = "where measured"
    ideal: float = 0.0
    most: Callable[[float], float] = lambda _: math.inf
    bounded_by: str = ""
    of_truth: bool = False
    jumps: bool = False
    revision: int = 1
    formerly: str = ""
    tabled: bool = True
    plotted: bool = False
