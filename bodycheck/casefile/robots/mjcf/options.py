"""The settings of an MJCF file for its simulation that belong to its mechanics (<option>)."""

from dataclasses import dataclass

from bodycheck.casefile.robots.mjcf.settings import word
from bodycheck.casefile.robots.numbers import many, number, numbers, positive
from bodycheck.reference.scene import Vector
from bodycheck.robots.elements import Element

#: What each flag switches off that is of the mechanics of a case.
FLAGS = {
    "constraint": ("equality", "frictionloss", "limit", "contact"),
    **{
        flag: (flag,)
        for flag in ("equality", "frictionloss", "limit", "contact", "spring", "damper", "gravity", "actuation", "clampctrl")
    },
}

#: Attributes of a medium, which acts if one of them is not zero.
MEDIUM = ("density", "viscosity")


@dataclass(frozen=True)
class Options:
    """The settings of all <option> elements together.

    Attributes
    ----------
    gravity
        The gravitational acceleration, world (m/s^2).
    timestep
        The time step (s); None if the file states none.
    off
        What flags switch off: values of `FLAGS`.
    idle_groups
        The groups of actuators that are switched off.
    medium
        The element that states the medium; None if there is none.
    """

    gravity: Vector = (0.0, 0.0, -9.81)
    timestep: float | None = None
    off: frozenset[str] = frozenset()
    idle_groups: frozenset[float] = frozenset()
    medium: Element | None = None


def options(root: Element) -> Options:
    """Return the settings of an MJCF file. Raises `BadInput` if they cannot be read."""
    gravity, timestep = (0.0, 0.0, -9.81), None
    flags: dict[str, bool] = {}
    idle_groups: tuple[float, ...] = ()
    medium: dict[str, tuple[float, Element]] = {}
    for option in root.all("option"):
        x, y, z = numbers(option, "gravity", (3,), gravity)
        gravity = x, y, z
        if "timestep" in option.attributes:
            timestep = positive(option, "timestep")
        idle_groups = many(option, "actuatorgroupdisable", idle_groups)
        for name in MEDIUM:
            if name in option.attributes:
                medium[name] = number(option, name), option
        for flag in option.all("flag"):
            for name in FLAGS:
                if name in flag.attributes:
                    flags[name] = word(flag, name, "enable", ("enable", "disable")) == "disable"
    off = frozenset(part for name, disabled in flags.items() if disabled for part in FLAGS[name])
    stated = [option for value, option in medium.values() if value]
    gravity = (0.0, 0.0, 0.0) if "gravity" in off else gravity
    return Options(gravity, timestep, off, frozenset(idle_groups), stated[0] if stated else None)
