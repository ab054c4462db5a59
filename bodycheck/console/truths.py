"""Print a truth and its cross-check to stdout."""

from collections.abc import Sequence
from importlib.util import find_spec
from operator import itemgetter

import numpy as np

from bodycheck.casefile.content import Case
from bodycheck.console.options import View
from bodycheck.console.output import say, tell
from bodycheck.console.tables import Column, show
from bodycheck.console.truth_states import columns, instants
from bodycheck.figures.bounds import rounded_up
from bodycheck.figures.columns import bounds_of
from bodycheck.figures.conservation import angular_momentum, rotational_energy, total_energy
from bodycheck.figures.definition import Comparison
from bodycheck.reference.bodies import bodies
from bodycheck.reference.certified import Certificate
from bodycheck.reference.contact.motion import EventKind
from bodycheck.reference.mechanisms.mechanism import WORLD, Mechanism
from bodycheck.reference.requirements import touches
from bodycheck.reference.sensors.readings import SensorTruth
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.trajectory import Array
from bodycheck.reference.truths import Truth

#: The events of bodies in contact, in words.
EVENTS: dict[EventKind, str] = {
    "impact": "{} hits",
    "roll": "{} begins to roll",
    "slip": "{} begins to slip",
    "rest": "{} comes to rest",
    "tip": "{} begins to tip",
    "turn": "{} begins to turn about its contacts",
}

#: The largest number of printed events.
MOST_EVENTS = 8

#: The bounds of errors that are not in the table of a truth.
OTHER_BOUNDS = ("velocity", "angular_velocity", "energy", "angular_momentum")

#: The typical rounding error of an angle (rad) in double precision.
ROUNDING = 1e-16


def print_truth(truth: Truth, most_rows: int, view: View) -> None:
    """Print the states at no more than `most_rows` evenly chosen instants, the model and the methods that computed them."""
    trajectory = truth.trajectory
    chosen = np.unique(np.linspace(0, len(trajectory) - 1, min(most_rows, len(trajectory))).astype(int))
    show(columns(truth.scene), instants(truth, chosen.tolist()), view)
    left_out = f"; {len(chosen)} of {len(trajectory)} instants, --json prints all" if len(chosen) < len(trajectory) else ""
    say(_other_bounds(truth))
    tell(f"model {truth.model} ({truth.reason}), backend {truth.backend}{left_out}")
    _print_events(truth)
    if isinstance(truth.scene, Mechanism) and truth.scene.plane is None:
        _print_growth(truth)
    if truth.witnesses:
        tell(f"compared with {'; '.join(truth.witnesses)}")
    if any("dop853" in witness for witness in truth.witnesses) and find_spec("heyoka") is None:
        tell("SciPy integrated in double precision, as heyoka is not installed: pip install 'bodycheck[multiprecision]'")


def print_sensors(case: Case, readings: Sequence[SensorTruth]) -> None:
    """Print the largest reading of each sensor of a case and the bound of its error, or why there is no truth of it."""
    for sensor, each in zip(case.sensors, readings, strict=True):
        if each.reason:
            tell(f"sensor {sensor.name}: not modelled: {each.reason}")
            continue
        parts, units = [], _units(case, sensor)
        for unit in dict.fromkeys(units):
            rows = [row for row, one in enumerate(units) if one == unit]
            known = ~np.isnan(each.values[:, 0])
            largest, bound = (values[known][:, rows].max(initial=0.0) for values in (np.abs(each.values), each.bounds))
            parts.append(f"at most {largest:.6g} {unit}, error at most {rounded_up(float(bound), 2):.2g}")
        left_out = f"; {each.left_out} of {len(each.values)} instants are those of impacts" if each.left_out else ""
        tell(f"sensor {sensor.name}: {'; '.join(parts)}{left_out}")


def _units(case: Case, sensor: Sensor) -> tuple[str, ...]:
    """Return the unit of each component of a sensor of a case."""
    if sensor.type != "joint_effort":
        return sensor.form.units
    assert isinstance(case.scene, Mechanism)
    assert sensor.joint is not None  # a sensor of a joint
    return ("N",) if case.scene.joints[sensor.joint].type == "prismatic" else ("N m",)


def _other_bounds(truth: Truth) -> str:
    """Return the largest bounds that are not in the table of a truth, on two lines of less than 80 characters."""
    known = {name: f"{rounded_up(float(np.nanmax(values)), 2):.2g}" for name, values in bounds_of(truth).items()}
    velocity, rate, energy, momentum = (known.get(f"truth_{name}_error", "not known") for name in OTHER_BOUNDS)
    return (
        f"velocity error at most {velocity} m/s, angular velocity error {rate} rad/s,\n"
        f"energy error {energy}, angular momentum error {momentum}, both relative"
    )


def _print_growth(truth: Truth) -> None:
    """Print the growth of errors, when a rounding error is no longer small, and until when the motion is known."""
    from bodycheck.reference.mechanisms.truth import KNOWN, known_until  # this imports all methods for truths

    t = truth.trajectory.t
    if truth.growth is not None:
        tell(f"an error of the initial angles has grown up to {truth.growth.max():.2g}-fold by t = {t[-1]:g} s")
        lost = np.flatnonzero(truth.growth * ROUNDING >= KNOWN)
        if len(lost):
            tell(f"one of {ROUNDING:.0e} rad reaches {KNOWN:.0e} rad at t = {t[lost[0]]:g} s")
    until, end = known_until(truth), float(t[-1])
    if until == end:
        tell(f"all angles and attitudes are known within {KNOWN:.0e} rad")
    else:
        tell(f"known within {KNOWN:.0e} rad {'at no instant' if until is None else f'until t = {until:g} s'}")


def _print_events(truth: Truth) -> None:
    """Print the first events of bodies in contact, and the loads that bodies at rest bear."""
    scene, end = truth.scene, float(truth.trajectory.t[-1])
    names = [body.name if isinstance(scene, Mechanism) else "the body" for body in bodies(scene)]
    for event in truth.events[:MOST_EVENTS]:
        speed = f" at {event.normal_speed:.9g} m/s" if event.ends_flight else ""
        tell(f"{EVENTS[event.kind].format(names[event.body])}{speed} at t = {event.time:.12g} s, within {event.error:.1e} s")
    if (more := len(truth.events) - MOST_EVENTS) > 0:
        tell(f"{more} more up to t = {truth.events[-1].time:.9g} s, --json prints all")
    for pair in truth.interfaces:
        one, other = ("the plane" if index == WORLD else names[index] for index in pair.bodies)
        tell(f"{one} bears {other} with {pair.load:.9g} N")
    lost = np.flatnonzero(np.isnan(truth.bounds.position_error))
    if touches(scene) and len(lost):
        at = float(truth.trajectory.t[lost[0]])
        tell(f"mechanics gives no motion, but inequalities alone, from t = {at:g} s to {end:g} s: nan")


def print_proof(certificate: Certificate) -> None:
    """Print the proof of a truth, or why there is none, with the word that says how well the truth is known otherwise."""
    proof = certificate.enclosure
    if proof is not None:
        until = "yes" if proof.until is None else f"until {proof.until:.4g} s ({proof.reason})"
        tell(
            f"enclosed: {until}, within {proof.distance:.2g} rad of the printed doubles; proof: {proof.way}, "
            f"{proof.bits} bits, {proof.seconds:.1f} s"
        )
    elif certificate.others:
        tell(f"enclosed: no ({certificate.not_enclosed}); cross-checked within {certificate.distance:.1g} rad")
    else:
        tell(f"enclosed: no ({certificate.not_enclosed}); estimated, since no other way follows this motion")


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
        ("bound by the most accurate other way", *figures(certificate.bound)),
    ]
    heads = [f"until {t[i]:g} s" for i in chosen]
    columns = [Column(head, head, itemgetter(index), goes=len(heads) - index) for index, head in enumerate(heads, start=1)]
    show([Column("ways", "ways", itemgetter(0), wraps=True), *columns], rows)
    if certificate.certified and certificate.others:
        tell(
            f"cross-checked: all ways agree within their bounds, and the truth is at most {certificate.bound[-1]:.1e} rad off "
            f"by the most accurate other way, in arithmetic of {certificate.digits} digits"
        )
    if certificate.growth is not None and not isinstance(truth.scene, Mechanism):
        tell(f"an error at one instant grows up to {certificate.growth.max():.2g}-fold until a later one")
    if touches(truth.scene):
        return  # friction and impacts change the energy
    compared = Comparison(truth, truth.trajectory)
    if isinstance(truth.scene, Mechanism):
        tell(f"drift of the energy of the truth itself, relative: {total_energy(compared).max():.1e}")
        return
    energy, rotational, momentum = (
        f"{compute(compared).max():.1e}" for compute in (total_energy, rotational_energy, angular_momentum)
    )
    tell(f"drifts of the truth itself, relative: energy {energy}, rotational energy {rotational}, angular momentum {momentum}")
