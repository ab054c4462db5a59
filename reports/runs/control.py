"""Controllers and stops of joints in words."""

from bodycheck.reference.mechanisms.control import Controller, Samples, Signal, Sine, Stops
from bodycheck.reference.mechanisms.mechanism import Joint, Mechanism
from bodycheck.reports.quantities import count, listing, number

#: The most controllers that are described individually.
MOST_TOLD = 6


def controllers(mechanism: Mechanism) -> str:
    """Return the description of the controllers: each of them, or their number if there are many."""
    sentences = [_controller(mechanism.joints[each.joint], each) for each in mechanism.controllers[:MOST_TOLD]]
    if (more := len(mechanism.controllers) - MOST_TOLD) > 0:
        sentences.append(f"and {count(more, 'further controller')}")
    return "; ".join(sentences)


def stops(these: Stops, unit: str) -> str:
    """Return the description of the stops of a joint. unit: of its coordinate."""
    places = listing([number(end) for end in (these.lower, these.upper) if end is not None])
    if these.rigid:
        assert these.restitution is not None
        kind = f"rigid, restitution {number(these.restitution)}"
    else:
        kind = f"elastic, {number(these.stiffness)} {_per(unit)} and {number(these.damping)} {_per(unit, ' s')}"
    return f"{'a stop' if None in (these.lower, these.upper) else 'stops'} at {places} {unit} ({kind})"


def unit_of(joint: Joint) -> str:
    """Return the unit of the coordinate of a joint."""
    return "m" if joint.type == "prismatic" else "rad"


def _controller(joint: Joint, controller: Controller) -> str:
    unit = unit_of(joint)
    force = "N" if unit == "m" else "N m"
    parts = []
    if controller.law == "pd":
        gains = {"kp": controller.kp, "kd": controller.kd, "ki": controller.ki}
        parts += [f"{name} {number(gain)}" for name, gain in gains.items() if gain]
        parts.append(f"target {_signal(controller.target, unit)}")
        if controller.target_velocity != 0:
            parts.append(f"target velocity {_signal(controller.target_velocity, f'{unit}/s')}")
    if controller.law == "effort" or controller.effort != 0:
        parts.append(f"effort {_signal(controller.effort, force)}")
    if controller.effort_limit is not None:
        parts.append(f"at most {number(controller.effort_limit)} {force}")
    if controller.no_load_speed is not None:
        parts.append(f"no-load speed {number(controller.no_load_speed)} {unit}/s")
    law = "pd law" if controller.law == "pd" else "feed-forward"
    law = f"continuous {law}" if controller.rate is None else f"{law} at {number(controller.rate)} Hz"
    late = f", {count(controller.delay, 'period')} late" if controller.delay else ""
    return f"{joint.name}: {law}{late}: {', '.join(parts)}"


def _signal(signal: Signal, unit: str) -> str:
    match signal:
        case Sine(amplitude, angular_frequency, _, offset):
            around = f"{number(offset)} + " if offset else ""
            return f"{around}{number(amplitude)} {unit} times a sine of {number(angular_frequency)} rad/s"
        case Samples(times, values, between):
            held = "held" if between == "hold" else "linear"
            return f"from {number(min(values))} to {number(max(values))} {unit}, {held} between {count(len(times), 'instant')}"
    return f"{number(signal)} {unit}"


def _per(unit: str, more: str = "") -> str:
    return f"N{more}/m" if unit == "m" else f"N m{more}/rad"
