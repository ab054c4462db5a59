"""The modes of a driven joint, in each of which its motion is a linear system z' = A z, and the conditions of these modes.

The state z has the coordinate q, its velocity v and the number 1; for a continuous law the integral of the error, and the
values and derivatives of the signals that change; for a sampled law the effort that the controller exerts at present.

A mode lasts while its conditions, linear functions of the state, are not negative. At an instant at which some are zero, their
derivatives decide which mode follows. The motion depends continuously on such decisions: saturation and the force of an elastic
stop that ceases to push are continuous functions, a stop is engaged with a velocity outwards, dry friction brings motions
closer to each other, and the impulse of a rigid stop that is only touched is zero.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Literal

from bodycheck.reference.exact.numbers import Real
from bodycheck.reference.mechanisms.control import Controller, Stops
from bodycheck.reference.mechanisms.driven import signals
from bodycheck.reference.mechanisms.driven.events import Scan, scan_of
from bodycheck.reference.mechanisms.driven.linear import Linear, Row, State
from bodycheck.reference.mechanisms.forms.oscillator import Oscillator

#: The components of a state that every joint has.
POSITION, VELOCITY, ONE = range(3)

#: The contact of a joint with a stop.
Contact = Literal["free", "closed", "pushing", "slack"]

#: The names of the signals of a controller.
SIGNALS = ("target", "target_velocity", "effort")


@dataclass(frozen=True, eq=False)
class DrivenJoint:
    """A joint with a linear equation between events, in an arithmetic.

    Attributes
    ----------
    mp
        The arithmetic.
    plant
        The joint without controller and stops.
    controller, stops
        As in `Mechanism`; None if the joint has none.
    slots
        The first component in a state of the integral of the error ("integral"), of the present effort of a sampled law
        ("held") and of each signal of a continuous law that changes, by their names.
    size
        The number of components of a state.
    phases
        The phases so far, by their modes.
    """

    mp: Any
    plant: Oscillator
    controller: Controller | None
    stops: Stops | None
    slots: dict[str, int]
    size: int
    phases: dict["Mode", "Phase"] = field(default_factory=dict)

    @property
    def continuous(self) -> Controller | None:
        """The controller if its law is continuous."""
        return self.controller if self.controller is not None and self.controller.rate is None else None


@dataclass(frozen=True)
class Mode:
    """A mode of a driven joint.

    Attributes
    ----------
    cut
        1 and -1 where the effort of a continuous law is cut to its upper and lower bound, else 0.
    band
        The number of those of the speeds -n, 0 and n that are below the velocity, where n is the no-load speed of a continuous
        law; 0 without.
    slip
        The direction of the motion of a joint with dry friction, 0 while it sticks; None for a joint without, or at a stop.
    contact
        "free"; "closed" at a rigid stop; "pushing" or "slack" beyond an elastic stop.
    side
        1 and -1 at the upper and the lower stop; 0 if free.
    """

    cut: int = 0
    band: int = 0
    slip: int | None = None
    contact: Contact = "free"
    side: int = 0

    @property
    def moves(self) -> bool:
        """True unless the joint sticks or stays at a stop."""
        return self.contact != "closed" and self.slip != 0


@dataclass(frozen=True, eq=False)
class Phase:
    """A mode with its linear system and its conditions: linear functions of the state that are not negative while it lasts."""

    mode: Mode
    linear: Linear
    conditions: list[Row]

    @cached_property
    def scan(self) -> Scan:
        """The conditions during one step."""
        return scan_of(self.linear, self.conditions)


def phase_of(joint: DrivenJoint, mode: Mode) -> Phase:
    """The phase of a mode."""
    if mode not in joint.phases:
        joint.phases[mode] = Phase(mode, system(joint, mode), conditions(joint, mode))
    return joint.phases[mode]


def driven_joint(mp: Any, plant: Oscillator, controller: Controller | None, stops: Stops | None) -> DrivenJoint:
    """A driven joint in an arithmetic."""
    numbers = {name: mp.mpf(number) for name, number in vars(plant).items()}
    slots: dict[str, int] = {}
    size = ONE + 1
    if controller is not None and controller.rate is not None:
        slots["held"], size = size, size + 1
    elif controller is not None:
        if controller.ki:
            slots["integral"], size = size, size + 1
        for name in SIGNALS:
            if signals.constant(getattr(controller, name)) is None:
                slots[name], size = size, size + 2
    return DrivenJoint(mp, Oscillator(**numbers), controller, stops, slots, size)


def start_of(joint: DrivenJoint) -> list[Real]:
    """The state at t = 0, before an impact and before the first instant of a sampled law."""
    z = [joint.plant.start, joint.plant.velocity, joint.mp.one] + [joint.mp.zero] * (joint.size - ONE - 1)
    return with_signals(joint, z, 0.0)


def with_signals(joint: DrivenJoint, z: State, time: float) -> list[Real]:
    """The state with the signals just after a time (s), which is 0 or a break of one of them."""
    z = list(z)
    for name in SIGNALS:
        if name in joint.slots:
            slot = joint.slots[name]
            z[slot], z[slot + 1] = signals.begun(joint.mp, getattr(joint.controller, name), time)
    return z


def total(*parts: tuple[Real, Row]) -> dict[int, Real]:
    """The sum of linear functions, each times a factor; coefficients that are zero are left out."""
    sums: dict[int, Real] = {}
    for factor, row in parts:
        for column, coefficient in row.items():
            sums[column] = sums.get(column, 0) + factor * coefficient
    return {column: coefficient for column, coefficient in sums.items() if coefficient}


def signal(joint: DrivenJoint, name: str) -> Row:
    """A signal of a continuous law as a function of the state."""
    if name in joint.slots:
        return {joint.slots[name]: joint.mp.one}
    number = signals.constant(getattr(joint.controller, name))
    return {ONE: joint.mp.mpf(number)} if number else {}


def law(joint: DrivenJoint) -> Row:
    """The effort of a continuous law before its saturation."""
    mp, controller = joint.mp, joint.continuous
    assert controller is not None
    integral = {joint.slots["integral"]: mp.one} if "integral" in joint.slots else {}
    return total(
        (mp.mpf(controller.kp), signal(joint, "target")),
        (-mp.mpf(controller.kp), {POSITION: mp.one}),
        (mp.mpf(controller.kd), signal(joint, "target_velocity")),
        (-mp.mpf(controller.kd), {VELOCITY: mp.one}),
        (mp.mpf(controller.ki), integral),
        (mp.one, signal(joint, "effort")),
    )


def limit(joint: DrivenJoint, side: int, band: int) -> Row:
    """The upper (side 1) or lower (side -1) bound of the effort of a continuous law, at velocities of a band."""
    controller, mp = joint.continuous, joint.mp
    assert controller is not None
    assert controller.effort_limit is not None
    most = mp.mpf(controller.effort_limit)
    along = band - 1 if side > 0 else 2 - band
    if controller.no_load_speed is None or along < 1:
        return total((side * most, {ONE: mp.one}))
    return (
        total((side * most, {ONE: mp.one}), (-most / mp.mpf(controller.no_load_speed), {VELOCITY: mp.one}))
        if along == 1
        else {}
    )


def pressing(joint: DrivenJoint, mode: Mode) -> Row:
    """The force on the joint along its coordinate without that of dry friction and of a rigid stop (N m or N)."""
    mp, plant = joint.mp, joint.plant
    parts: list[tuple[Real, Row]] = [
        (plant.force + plant.stiffness * plant.rest, {ONE: mp.one}),
        (-plant.stiffness, {POSITION: mp.one}),
        (-plant.damping, {VELOCITY: mp.one}),
    ]
    if joint.continuous is not None:
        parts.append((mp.one, limit(joint, mode.cut, mode.band) if mode.cut else law(joint)))
    elif "held" in joint.slots:
        parts.append((mp.one, {joint.slots["held"]: mp.one}))
    if mode.contact == "pushing":
        parts.append((mp.mpf(-mode.side), push(joint, mode.side)))
    return total(*parts)


def beyond(joint: DrivenJoint, side: int) -> Row:
    """The distance beyond a stop."""
    return total((joint.mp.mpf(side), {POSITION: joint.mp.one, ONE: -place_of(joint, side)}))


def place_of(joint: DrivenJoint, side: int) -> Real:
    """The coordinate of a stop."""
    stops = stops_of(joint)
    return joint.mp.mpf(stops.upper if side > 0 else stops.lower)


def stops_of(joint: DrivenJoint) -> Stops:
    """The stops of a joint that has some."""
    assert joint.stops is not None
    return joint.stops


def sides(joint: DrivenJoint) -> list[int]:
    """The sides at which the joint has stops."""
    if joint.stops is None:
        return []
    return [side for side, end in ((1, joint.stops.upper), (-1, joint.stops.lower)) if end is not None]


def rigid_sides(joint: DrivenJoint) -> list[int]:
    """The sides at which the joint has rigid stops."""
    return sides(joint) if joint.stops is not None and joint.stops.rigid else []


def width(joint: DrivenJoint) -> Real:
    """The distance of the two stops of a joint."""
    return place_of(joint, 1) - place_of(joint, -1)


def push(joint: DrivenJoint, side: int) -> Row:
    """The effort of an elastic stop outwards of it, as long as it is positive."""
    stops = stops_of(joint)
    damping = joint.mp.mpf(side) * joint.mp.mpf(stops.damping)
    return total((joint.mp.mpf(stops.stiffness), beyond(joint, side)), (damping, {VELOCITY: joint.mp.one}))


def system(joint: DrivenJoint, mode: Mode) -> Linear:
    """The linear system of a mode."""
    mp, controller = joint.mp, joint.continuous
    rows: list[dict[int, Real]] = [{} for _ in range(joint.size)]
    if mode.moves:
        friction = {ONE: -mode.slip * joint.plant.friction} if mode.slip else {}
        rows[POSITION] = {VELOCITY: mp.one}
        rows[VELOCITY] = total((1 / joint.plant.inertia, pressing(joint, mode)), (1 / joint.plant.inertia, friction))
    if controller is not None:
        if "integral" in joint.slots:
            rows[joint.slots["integral"]] = total((mp.one, signal(joint, "target")), (-mp.one, {POSITION: mp.one}))
        for name in SIGNALS:
            if name in joint.slots:
                slot, given = joint.slots[name], getattr(controller, name)
                square = mp.mpf(signals.frequency(given)) ** 2
                rows[slot] = {slot + 1: mp.one}
                rows[slot + 1] = total((-square, {slot: mp.one}), (square * mp.mpf(getattr(given, "offset", 0)), {ONE: mp.one}))
    return Linear(mp, tuple(rows), _step(joint, rows))


def _step(joint: DrivenJoint, rows: Sequence[Row]) -> Real | None:
    """The length of the steps of a system (s): the inverse of the sum of its rates, and a whole part of the period."""
    if not any(rows):
        return None
    mp, forces = joint.mp, rows[VELOCITY]
    rate = abs(forces.get(VELOCITY, mp.zero)) + mp.sqrt(abs(forces.get(POSITION, mp.zero)))
    if "integral" in joint.slots:
        rate += mp.cbrt(abs(forces.get(joint.slots["integral"], mp.zero)))
    controller = joint.controller
    if controller is not None and controller.rate is not None:
        period = 1 / mp.mpf(controller.rate)
        return period / max(1, int(mp.ceil(rate * period)))
    for name in SIGNALS if controller is not None else ():
        rate += abs(mp.mpf(signals.frequency(getattr(controller, name))))
    return 1 / rate if rate else mp.mpf(LONGEST)


#: The length of the steps of a system without a rate (s): any motion is a polynomial.
LONGEST = 1.0


def conditions(joint: DrivenJoint, mode: Mode) -> list[Row]:
    """The linear functions of the state that are not negative while a mode lasts."""
    return [*_of_saturation(joint, mode), *_of_friction(joint, mode), *_of_stops(joint, mode)]


def _of_saturation(joint: DrivenJoint, mode: Mode) -> Iterator[Row]:
    mp, controller, speeds = joint.mp, joint.continuous, edges(joint)
    if controller is not None and controller.effort_limit is not None:
        for side in (1, -1):
            if mode.cut in (0, side):
                sense = mp.mpf(side if mode.cut == 0 else -side)
                yield total((sense, limit(joint, side, mode.band)), (-sense, law(joint)))
    if mode.band > 0:
        yield total((mp.one, {VELOCITY: mp.one, ONE: -speeds[mode.band - 1]}))
    if mode.band < len(speeds):
        yield total((-mp.one, {VELOCITY: mp.one, ONE: -speeds[mode.band]}))


def _of_friction(joint: DrivenJoint, mode: Mode) -> Iterator[Row]:
    mp = joint.mp
    if mode.slip:
        yield {VELOCITY: mp.mpf(mode.slip)}
    if mode.moves:
        return
    force = {column: part for column, part in pressing(joint, mode).items() if column != VELOCITY}
    for side in (mode.side,) if mode.contact == "closed" else (1, -1):
        yield total((joint.plant.friction, {ONE: mp.one}), (mp.mpf(side), force))


def _of_stops(joint: DrivenJoint, mode: Mode) -> Iterator[Row]:
    mp, side = joint.mp, mode.side
    if mode.contact == "free":
        for each in sides(joint):
            yield total((-mp.one, beyond(joint, each)))
    elif mode.contact in ("pushing", "slack"):
        damped = stops_of(joint).damping
        if damped:
            yield total((mp.mpf(1 if mode.contact == "pushing" else -1), push(joint, side)))
        if mode.contact == "slack" or not damped:
            yield beyond(joint, side)


def edges(joint: DrivenJoint) -> tuple[Real, ...]:
    """The velocities at which the bounds of a continuous law change their form, ascending."""
    controller = joint.continuous
    if controller is None or controller.no_load_speed is None:
        return ()
    speed = joint.mp.mpf(controller.no_load_speed)
    return -speed, joint.mp.zero, speed
