"""A truth with its bounds, and the answer for a scene without a truth."""

from dataclasses import dataclass, replace

import numpy as np

from bodycheck.reference.bounds import Bounds
from bodycheck.reference.contact.motion import Event, Interface
from bodycheck.reference.kinematics import dot
from bodycheck.reference.mechanisms.coordinates import JointMotion
from bodycheck.reference.mechanisms.mechanism import AnyScene
from bodycheck.reference.planar import Stop
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.witness import Instant, Witness

#: Name of the backend that evaluates closed forms.
CLOSED_FORM_BACKEND = "numpy"

#: Name of the backend that integrates slides.
INTEGRATION_BACKEND = "scipy-dop853"


@dataclass(frozen=True, eq=False)
class Truth:
    """The reference trajectory of a scene, and the bound of its error.

    Attributes
    ----------
    scene
        The scene.
    trajectory
        The reference trajectory at n instants, in the frame of the scene's body; for a mechanism, the trajectories of all its
        bodies.
    bounds
        Bounds of the errors of the trajectory itself at each instant.
    model
        Name of the equations that were solved.
    reason
        Why these equations are exact for the scene.
    backend
        Name of the software that solved them.
    witnesses
        Names of the independent solutions that the bounds rely on; empty if no solution is needed or can be computed.
    stop
        The instant and place where a body on a plane comes to rest; None in free flight, and if the body still moves at the
        last instant.
    joints
        The motion of the joints of a mechanism at the same instants; None for a single body.
    growth
        (n,) largest factor by which an error at t = 0 has grown, for a mechanism; None where it is not known.
    events
        The events of bodies that touch, within the instants: impacts, and the start of rolling, slipping, rest and tipping.
        Where mechanics determines no motion after or before an event, states and bounds are NaN.
    friction
        The smallest coefficient of friction with which nothing slips along a motion without slip; 0 for any other motion.
    interfaces
        The normal forces between bodies that touch and rest.
    """

    scene: AnyScene
    trajectory: Trajectory
    bounds: Bounds
    model: str
    reason: str
    backend: str
    witnesses: tuple[str, ...] = ()
    stop: Stop | None = None
    joints: JointMotion | None = None
    growth: Array | None = None
    events: tuple[Event, ...] = ()
    friction: float = 0.0
    interfaces: tuple[Interface, ...] = ()

    def __repr__(self) -> str:
        instants, error = self.trajectory.t, np.nanmax(self.bounds.error, initial=0.0)
        return f"<Truth: {self.model}, {len(instants)} instants to {instants[-1]:g} s, error at most {error:.2g} rad>"

    def at(self, times: Array) -> "Truth":
        """The part of this truth at ascending times (n,), s. Raises `ValueError` if it does not have all of them."""
        instants = self.trajectory.t
        if np.array_equal(times, instants):
            return self
        indices = np.minimum(np.searchsorted(instants, times), len(instants) - 1)
        if not len(times) or not np.array_equal(instants[indices], times):
            raise ValueError("the truth is at other instants; `bodycheck.reference.truth.at` computes it at these")
        stop = self.stop if self.stop is not None and self.stop.time <= times[-1] else None
        return replace(
            self,
            trajectory=self.trajectory.part(indices),
            bounds=self.bounds.part(indices),
            stop=stop,
            joints=None if self.joints is None else self.joints.part(indices),
            growth=None if self.growth is None else self.growth[indices],
            events=tuple(event for event in self.events if event.time <= times[-1]),
        )


@dataclass(frozen=True, eq=False)
class Computed:
    """A truth with the bounds and witnesses that its bounds come from.

    Attributes
    ----------
    truth
        The truth.
    own_bounds
        The bounds of the computation of the truth, without regard to witnesses. The bounds of the truth are larger where a
        witness contradicts it.
    witnesses
        The witnesses.
    own_events
        The events with the bounds of the computation of the truth; None if the motion has no events.
    """

    truth: Truth
    own_bounds: Bounds
    witnesses: tuple[Witness, ...]
    own_events: tuple[Instant, ...] | None = None


@dataclass(frozen=True)
class NoTruth:
    """The answer for a scene of which the reference has no truth.

    Attributes
    ----------
    reason
        Why there is none.
    limit
        The time limit (s) at which its computation was stopped; None if it was not stopped.
    crashed
        Whether its computation failed.
    """

    reason: str
    limit: float | None = None
    crashed: bool = False


def distance(one: Array, other: Array) -> Array:
    """Euclidean distances (...) between vectors (..., k)."""
    difference = one - other
    return np.asarray(np.sqrt(dot(difference, difference)))
