"""The axes along which the study of extremes varies a case until engines break.

A new axis is one entry of `AXES`: the grammar of case files, their JSON Schema and their checks, the study, its pages and the
table in docs/cases.md follow. Two files are renewed by commands:

    bodycheck schema > cases/case.schema.json
    python docs/tables.py
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from bodycheck.adapters.method import DEFAULT_TIMESTEP
from bodycheck.casefile.content import MAX_STEPS, Case
from bodycheck.casefile.mechanisms.axes import VARIATIONS, grown
from bodycheck.casefile.values import Factors, NonNegativeValues, Ratios, Values
from bodycheck.reference.kinematics import rotate
from bodycheck.reference.mechanisms.mechanism import AnyScene, alone
from bodycheck.reference.scene import Body, Scene, State, Vector

#: The axes that change how a case is run, but not its scene.
OF_THE_RUN = ("timestep", "steps")


@dataclass(frozen=True)
class Axis:
    """An axis of the study of extremes.

    Attributes
    ----------
    name
        The key in the table `[extremes]` of a case file, and the value of the column `axis`.
    title
        The axis as reports call it.
    meaning
        What the values of the axis are, as a phrase.
    values
        The annotation of the values in the grammar of case files.
    change
        Function from a case of one body and a value to the case with this value; the functions for mechanisms are in
        `mechanisms.axes`.
    unit
        The SI unit, empty for a pure number.
    remark
        Additional information for the grammar and the documentation, for example which quantities stay the same.
    missing
        Returns why a scene of one body cannot be varied along the axis; None if it can.
    refused
        Returns the rule that a value breaks in a case of the given duration (s); None if it breaks none.
    """

    name: str
    title: str
    meaning: str
    values: Any
    change: Callable[[Case, float], Case]
    unit: str = ""
    remark: str = ""
    missing: Callable[[Scene], str | None] = lambda _: None
    refused: Callable[[float, float], str | None] = lambda _value, _duration: None

    def varied(self, case: Case, value: float) -> Case:
        """Return a case of one body or of a mechanism, changed to have a value."""
        variation = VARIATIONS.get(self.name)
        if variation is None or isinstance(case.scene, Scene):
            return self.change(case, value)
        return replace(case, scene=variation.change(case.scene, value))

    def lacking(self, scene: AnyScene) -> str | None:
        """Return why a scene of one body or a mechanism cannot be varied along the axis; None if it can."""
        if isinstance(scene, Scene):
            return self.missing(scene)
        if (variation := VARIATIONS.get(self.name)) is not None:
            return variation.missing(scene)
        return None if self.name in OF_THE_RUN else "only of one body, not of a mechanism"

    @property
    def description(self) -> str:
        """The meaning with the unit and the remark."""
        return "".join((self.meaning, self.unit and f", {self.unit}", self.remark and f"; {self.remark}"))


def spin(case: Case, value: float) -> Case:
    """Return the case with an initial angular velocity of this size (rad/s) in the same direction."""
    initial = alone(case.scene).initial
    return _with_state(case, replace(initial, angular_velocity=_scaled(initial.angular_velocity, value)))


def speed(case: Case, value: float) -> Case:
    """Return the case with an initial velocity of this size (m/s) in the same direction."""
    initial = alone(case.scene).initial
    return _with_state(case, replace(initial, velocity=_scaled(initial.velocity, value)))


def steps(case: Case, value: float) -> Case:
    """Return the case with a duration of this many default time steps."""
    return replace(case, duration=round(value) * DEFAULT_TIMESTEP)


def distance(case: Case, value: float) -> Case:
    """Return the case with the initial position moved by this distance (m) along x."""
    initial = alone(case.scene).initial
    x, y, z = initial.position
    return _with_state(case, replace(initial, position=(x + value, y, z)))


def gravity(case: Case, value: float) -> Case:
    """Return the case with this gravity (m/s^2)."""
    return replace(case, scene=replace(alone(case.scene), gravity=value))


def friction(case: Case, value: float) -> Case:
    """Return the case with this coefficient of friction of the plane."""
    plane = alone(case.scene).plane
    assert plane is not None  # a case file that has this axis without a plane is refused
    return replace(case, scene=replace(alone(case.scene), plane=replace(plane, friction=value)))


def mass(case: Case, value: float) -> Case:
    """Return the case with this mass (kg) of the same shape; the moments change in proportion."""
    body = alone(case.scene).body
    return _with_body(case, replace(body, mass=value, moments=_times(body.moments, value / body.mass)))


def size(case: Case, value: float) -> Case:
    """Return the case with all lengths of the body multiplied by this factor at the same density.

    The mass changes with the cube of the factor, and the moments with its fifth power.

    A body on a plane still lies on it.
    """
    body, initial = alone(case.scene).body, alone(case.scene).initial
    shape = None if body.shape is None else grown(body.shape, value)
    if alone(case.scene).plane is not None:
        x, y, z = initial.position
        case = _with_state(case, replace(initial, position=(x, y, z * value)))
    return _with_body(case, Body(body.mass * value**3, _times(body.moments, value**5), shape, body.axes))


def moment_ratio(case: Case, value: float) -> Case:
    """Return the case with the body stretched along its principal axis K until C / (A + B) has this value.

    The value is 1 for a disc perpendicular to K, and tends to 0 for a needle.

    With the second moments S_x, S_y, S_z of the mass, the principal moments are A = S_y + S_z, B = S_x + S_z and C = S_x + S_y.
    A stretch changes S_z alone, so that A + B >= C holds for every value. The shape, which has no effect in free flight, is
    dropped.
    """
    body = alone(case.scene).body
    a, b, c = body.moments
    along = c / 2 * (1 / value - 1)
    return _with_body(case, replace(body, moments=((c + a - b) / 2 + along, (c + b - a) / 2 + along, c), shape=None))


def separatrix(case: Case, value: float) -> Case:
    """Return the case with the same spin about the axis of the middle moment, and a wobble about the axis of the least.

    The wobble is this fraction of the spin.

    The closer the value is to 0, the closer the motion is to the separatrix: the time between flips grows as ln(1 / value).
    """
    body, initial = alone(case.scene).body, alone(case.scene).initial
    least, middle, _ = sorted(range(3), key=body.moments.__getitem__)
    rates = np.zeros(3)
    rates[middle] = math.hypot(*initial.angular_velocity)
    rates[least] = value * rates[middle]
    x, y, z = rotate(np.array(body.axes), rates).tolist()
    return _with_state(case, replace(initial, angular_velocity=(x, y, z)))


def _without_spin(scene: Scene) -> str | None:
    return None if any(scene.initial.angular_velocity) else "the body has no angular velocity to scale"


def _without_speed(scene: Scene) -> str | None:
    return None if any(scene.initial.velocity) else "the body has no velocity to scale"


def _without_plane(scene: Scene) -> str | None:
    return "the scene has no plane" if scene.plane is None else None


def _on_plane(scene: Scene) -> str | None:
    return "not possible for a body on a plane" if scene.plane is not None else None


def _without_middle_moment(scene: Scene) -> str | None:
    moments = scene.body.moments
    return f"the body has no intermediate principal axis; its moments are {moments}" if len(set(moments)) < 3 else None


def _long_or_short(timestep: float, duration: float) -> str | None:
    fits = duration / MAX_STEPS <= timestep <= duration
    return None if fits else f"a step must divide the duration into 1 to {MAX_STEPS:.0e} steps"


def _few_or_many(steps: float, _: float) -> str | None:
    return None if 1 <= steps <= MAX_STEPS else f"from 1 to {MAX_STEPS:.0e} are allowed"


#: All axes by name, in the order of the grammar.
AXES: dict[str, Axis] = {
    axis.name: axis
    for axis in (
        Axis(
            name="spin",
            title="Spin",
            meaning="size of the initial angular velocity",
            unit="rad/s",
            remark="its direction is kept",
            values=Values,
            change=spin,
            missing=_without_spin,
        ),
        Axis(
            name="timestep",
            title="Time step",
            meaning="time step",
            unit="s",
            remark="with spin, every spin is tried with every step",
            values=Values,
            change=lambda case, _: case,  # the time step belongs to the method
            refused=_long_or_short,
        ),
        Axis(
            name="steps",
            title="Steps",
            meaning=f"length of the run in steps of {DEFAULT_TIMESTEP * 1e3:g} ms",
            remark=f"at most {MAX_STEPS:.0e}",
            values=Values,
            change=steps,
            refused=_few_or_many,
        ),
        Axis(
            name="moment_ratio",
            title="C / (A + B)",
            meaning="C / (A + B), changed by stretching the body along its principal axis K",
            remark="1 is a disc across K, towards 0 a needle, at least 1e-20; C and the mass are kept",
            values=Ratios,
            change=moment_ratio,
            missing=_on_plane,
        ),
        Axis(
            name="mass",
            title="Mass",
            meaning="mass",
            unit="kg",
            remark="the moments change in proportion",
            values=Values,
            change=mass,
        ),
        Axis(
            name="size",
            title="Relative size",
            meaning="factor of all lengths of the body at the same density",
            remark="from 1e-10 to 1e10; the mass goes with the cube, the moments with the fifth power",
            values=Factors,
            change=size,
        ),
        Axis(
            name="distance",
            title="Distance from the origin",
            meaning="distance by which the start is moved from the origin along x",
            unit="m",
            values=Values,
            change=distance,
        ),
        Axis(
            name="gravity",
            title="Gravity",
            meaning="gravity",
            unit="m/s^2",
            values=NonNegativeValues,
            change=gravity,
        ),
        Axis(
            name="friction",
            title="Friction",
            meaning="Coulomb's coefficient of the plane",
            values=NonNegativeValues,
            change=friction,
            missing=_without_plane,
        ),
        Axis(
            name="speed",
            title="Speed",
            meaning="size of the initial velocity",
            unit="m/s",
            remark="its direction is kept",
            values=Values,
            change=speed,
            missing=_without_speed,
        ),
        Axis(
            name="separatrix",
            title="Wobble, relative to the spin",
            meaning="wobble about the axis of the least moment, relative to a spin about the axis of the middle moment",
            remark="the spin is that of the case; the time between flips grows as the logarithm of the inverse wobble",
            values=Ratios,
            change=separatrix,
            missing=lambda scene: _without_spin(scene) or _on_plane(scene) or _without_middle_moment(scene),
        ),
    )
}


#: The axes of a case without a table [extremes], as far as it can be varied along them, with their values.
DEFAULT_AXES: dict[str, tuple[float, ...]] = {
    "timestep": (0.0005, 0.002, 0.01, 0.05),
    "steps": (100, 1000),
    "gravity": (0.0, 9.81, 98.1),
    "spin": (1.0, 10.0, 100.0),
    "speed": (1.0, 10.0, 100.0),
}


def default_axes(case: Case) -> tuple[tuple[str, tuple[float, ...]], ...]:
    """Return the axes of a case without a table [extremes], with their values, in the form of `Case.extremes`."""
    axes = (
        (name, tuple(value for value in values if AXES[name].refused(value, case.duration) is None))
        for name, values in DEFAULT_AXES.items()
        if AXES[name].lacking(case.scene) is None
    )
    return tuple((name, values) for name, values in axes if values)


def _with_state(case: Case, initial: State) -> Case:
    return replace(case, scene=replace(alone(case.scene), initial=initial))


def _with_body(case: Case, body: Body) -> Case:
    return replace(case, scene=replace(alone(case.scene), body=body))


def _scaled(vector: Vector, size: float) -> Vector:
    return _times(vector, size / math.hypot(*vector))


def _times(vector: Vector, factor: float) -> Vector:
    x, y, z = vector
    return x * factor, y * factor, z * factor
