"""Print a truth and its certificate to stdout."""

from collections.abc import Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from operator import itemgetter
from typing import Any

import numpy as np

from bodycheck.console import mechanism_truths
from bodycheck.console.options import View
from bodycheck.console.output import say, tell
from bodycheck.console.tables import Column, attribute, show
from bodycheck.figures.bounds import rounded_up
from bodycheck.figures.columns import bounds_of
from bodycheck.figures.conservation import angular_momentum, rotational_energy, total_energy
from bodycheck.figures.definition import Comparison
from bodycheck.reference.certified import Certificate
from bodycheck.reference.contact.motion import EventKind
from bodycheck.reference.mechanisms.mechanism import WORLD, AnyScene, Mechanism
from bodycheck.reference.requirements import touches
from bodycheck.reference.trajectory import Array
from bodycheck.reference.truths import Truth


@dataclass(frozen=True)
class Instant:
    """A state of a truth with the bounds of its errors: time (s), vectors as in `Trajectory`, bounds in rad and m."""

    t: float
    position: Array
    quaternion: Array
    velocity: Array
    angular_velocity: Array
    truth_error: float
    truth_position_error: float


def _vector(name: str, head: str, goes: int) -> Column[Instant]:
    """Return the column of a vector; rows are sorted by its length."""

    def values(instant: Instant) -> Array:
        found: Array = getattr(instant, name)
        return found

    def text(instant: Instant) -> str:
        return " ".join(f"{value:.9g}" for value in values(instant))

    return Column(name, head, text, lambda instant: float(np.linalg.norm(values(instant))), goes)


def _bound(name: str, head: str) -> Column[Instant]:
    def value(instant: Instant) -> float:
        found: float = getattr(instant, name)
        return found

    return Column(name, head, lambda instant: f"{rounded_up(value(instant), 2):.2g}", value)


#: What happens in the events of bodies that touch, in words.
EVENTS: dict[EventKind, str] = {
    "impact": "{} hits",
    "roll": "{} begins to roll",
    "slip": "{} begins to slip",
    "rest": "{} comes to rest",
    "tip": "{} begins to tip",
}

#: Most events that are printed.
MOST_EVENTS = 8

#: The bounds that the table of a truth lacks.
OTHER_BOUNDS = ("velocity", "angular_velocity", "energy", "angular_momentum")

#: The columns of the table of a truth.
STATES = (
    attribute("t", "t s", "g"),
    _vector("position", "position m", 1),
    _vector("quaternion", "quaternion w x y z", 2),
    _vector("velocity", "velocity m/s", 4),
    _vector("angular_velocity", "angular velocity (body) rad/s", 3),
    _bound("truth_error", "error rad"),
    _bound("truth_position_error", "error m"),
)


def columns_of(scene: AnyScene) -> Sequence[Column[Any]]:
    """Return the columns of the table of the truth of a scene."""
    return mechanism_truths.columns(scene) if isinstance(scene, Mechanism) else STATES


def print_truth(truth: Truth, most_rows: int, view: View) -> None:
    """Print the states at no more than `most_rows` evenly chosen instants, the model and the methods that computed them."""
    trajectory, bounds = truth.trajectory, truth.bounds
    chosen = np.unique(np.linspace(0, len(trajectory) - 1, min(most_rows, len(trajectory))).astype(int))
    if isinstance(truth.scene, Mechanism):
        mechanism_truths.print_states(truth.scene, truth, chosen.tolist(), view)
    else:
        states = (trajectory.position, trajectory.quaternion, trajectory.velocity, trajectory.angular_velocity)
        columns = (trajectory.t, *states, bounds.error, bounds.position_error)
        show(STATES, [Instant(*(values[i] for values in columns)) for i in chosen], view)
    left_out = f"; {len(chosen)} of {len(trajectory)} instants, --json prints all" if len(chosen) < len(trajectory) else ""
    say(_other_bounds(truth))
    tell(f"model {truth.model} ({truth.reason}), backend {truth.backend}{left_out}")
    _print_events(truth)
    if isinstance(truth.scene, Mechanism) and truth.scene.plane is None:
        mechanism_truths.print_growth(truth)
    if truth.witnesses:
        tell(f"compared with {'; '.join(truth.witnesses)}")
    if any("dop853" in witness for witness in truth.witnesses) and find_spec("heyoka") is None:
        tell("SciPy integrated in double precision, as heyoka is not installed: pip install 'bodycheck[multiprecision]'")


def _other_bounds(truth: Truth) -> str:
    """Return the largest bounds of the figures that the table of a truth lacks, on two lines of less than 80 characters."""
    known = {name: f"{rounded_up(float(np.nanmax(values)), 2):.2g}" for name, values in bounds_of(truth).items()}
    velocity, rate, energy, momentum = (known.get(f"truth_{name}_error", "not known") for name in OTHER_BOUNDS)
    return (
        f"velocity error at most {velocity} m/s, angular velocity error {rate} rad/s,\n"
        f"energy error {energy}, angular momentum error {momentum}, both relative"
    )


def _print_events(truth: Truth) -> None:
    """Print what happens to bodies that touch, as far as a reader follows it, and what bodies at rest bear."""
    scene, end = truth.scene, float(truth.trajectory.t[-1])
    names = [body.name for body in scene.bodies] if isinstance(scene, Mechanism) else ["the body"]
    for event in truth.events[:MOST_EVENTS]:
        speed = f" at {event.normal_speed:.9g} m/s" if event.kind == "impact" else ""
        tell(f"{EVENTS[event.kind].format(names[event.body])}{speed} at t = {event.time:.12g} s, within {event.error:.1e} s")
    if (more := len(truth.events) - MOST_EVENTS) > 0:
        tell(f"{more} more up to t = {truth.events[-1].time:.9g} s, --json prints all")
    for pair in truth.interfaces:
        one, other = ("the plane" if place == WORLD else names[place] for place in pair.bodies)
        tell(f"{one} bears {other} with {pair.load:.9g} N")
    lost = np.flatnonzero(np.isnan(truth.bounds.position_error))
    if touches(scene) and len(lost):
        at = float(truth.trajectory.t[lost[0]])
        tell(f"mechanics gives no motion, but inequalities alone, from t = {at:g} s to {end:g} s: nan")


def print_certificate(certificate: Certificate) -> None:
    """Print how much the methods of computing a truth differ up to some instants, and how well the truth conserves energy."""
    truth = certificate.truth
    if not certificate.differences:
        return
    t = truth.trajectory.t
    chosen = np.unique(np.searchsorted(t, np.linspace(0, t[-1], 5)[1:]))

    def figures(values: Array) -> tuple[str, ...]:
        return tuple(f"{values[i]:.1e}" for i in chosen)

    say("\nlargest attitude difference so far, rad")
    rows = [(f"{one} | {other}", *figures(apart)) for (one, other), apart in certificate.differences.items()]
    rows += [
        ("printed bound of the truth's error", *figures(truth.bounds.error)),
        ("certified bound", *figures(certificate.bound)),
    ]
    heads = [f"until {t[i]:g} s" for i in chosen]
    columns = [Column(head, head, itemgetter(place), goes=len(heads) - place) for place, head in enumerate(heads, start=1)]
    show([Column("ways", "ways", itemgetter(0), wraps=True), *columns], rows)
    if certificate.certified:
        tell(f"certified: {certificate.bound[-1]:.1e} rad, measured against arithmetic of {certificate.digits} digits")
    if certificate.growth is not None and not isinstance(truth.scene, Mechanism):
        tell(f"an error at one instant grows up to {certificate.growth.max():.2g}-fold until a later one")
    compared = Comparison(truth, truth.trajectory)
    if isinstance(truth.scene, Mechanism):
        tell(f"drift of the energy of the truth itself, relative: {total_energy(compared).max():.1e}")
        return
    energy, rotational, momentum = (
        f"{compute(compared).max():.1e}" for compute in (total_energy, rotational_energy, angular_momentum)
    )
    tell(f"drifts of the truth itself, relative: energy {energy}, rotational energy {rotational}, angular momentum {momentum}")
