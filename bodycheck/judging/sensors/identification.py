"""Identify the convention by which an engine gives the readings of a sensor.

The readings are compared with what the sensor should read at the engine's own states, so that errors of the integrator do not
matter. A hypothesis consists of

- the source of the accelerations or velocities: exactly those of the state, or differences over the last step;
- at most one departure, such as a dropped term, from a closed list;
- the frame, and a signed permutation of its axes;
- the age of the state that was read, in steps. It is fitted; a hypothesis with differences has a whole number of steps.

The hypothesis is chosen that explains the readings best, where each choice that is not that of the type of the sensor must
explain them ten times better. A field is empty if another value of this field alone explains the readings as well.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import permutations, product
from math import ceil, hypot, inf, log10, sqrt

import numpy as np

from bodycheck.judging.sensors.jointed import contact_force, joint_effort, wrench
from bodycheck.judging.sensors.laws import Frame, Laws, Source
from bodycheck.judging.sensors.mounted import accelerometer, gyroscope, velocimeter
from bodycheck.judging.sensors.past import LAGS, Past
from bodycheck.reference.kinematics import conjugate, rotate
from bodycheck.reference.sensors.errors import parts
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.trajectory import Array

#: The ages (steps) from which the fit of an age begins, and the limits of ages.
AGES = np.arange(-1.0, 3.01, 0.5)

#: The ratio of residuals up to which two hypotheses explain readings equally well.
EQUAL = 4.0

#: The largest residual, relative to the readings, with which a hypothesis explains them.
EXPLAINED = 0.05

#: The largest uncertainty of an age (steps) that is stated.
UNCERTAIN = 0.25

#: A signed permutation: for each component of the reading, the index and the sign of the component that it equals.
Axes = tuple[tuple[int, int], ...]


@dataclass(frozen=True)
class Convention:
    """The convention that explains the readings of a sensor. A field is empty if it is not identified.

    Attributes
    ----------
    sign
        The sign, "+" or "-"; for a vector whose axes are permuted, each component as a signed axis, as in "+y -x +z".
    frame
        The frame along whose axes the readings are.
    age_steps, age_uncertainty
        The age of the state that was read, in steps, and its uncertainty.
    source
        The source of accelerations or velocities.
    note
        Departures, and what the scene cannot tell.
    """

    sign: str = ""
    frame: str = ""
    age_steps: float | None = None
    age_uncertainty: float | None = None
    source: str = ""
    note: str = ""


@dataclass(frozen=True)
class Hypothesis:
    """A hypothesis and its residual: the root of the mean square of what it leaves. frame: empty for a number."""

    source: Source
    departure: str
    frame: Frame | str
    axes: Axes
    age: float = 0.0
    residual: float = inf


def identify(past: Past, sensor: Sensor, index: int, readings: Array) -> tuple[Convention, ...]:
    """Return the convention of a sensor's readings (n, k): one, or of a wrench that of the force and that of the moment.

    index: the index of the sensor among those of the past.
    """
    values = past.values[index][past.rows]
    if sensor.type == "force_torque":
        return tuple(_identified(wrench(past, sensor, values, part), readings[:, part]) for _, part in parts(sensor))
    functions = {
        "accelerometer": accelerometer,
        "gyroscope": gyroscope,
        "velocimeter": velocimeter,
        "joint_effort": joint_effort,
        "contact_force": contact_force,
    }
    return (_identified(functions[sensor.type](past, sensor, values), readings),)


def _identified(known: Laws, readings: Array) -> Convention:
    """Return the convention that explains readings (n, k)."""
    fit = _Fit(known, readings)
    if len(fit.readings) < (len(LAGS) if fit.aged else 1):
        return Convention(note="too few readings")
    if fit.expected <= known.rounding["solver"] and fit.size <= max(known.rounding.values()):
        return Convention(note="the scene cannot tell: the sensor should read zero, and does")
    if fit.size <= known.rounding["solver"]:
        return Convention(note="reads zero")
    best = fit.best()
    if best.residual > EXPLAINED * fit.size:
        return Convention(
            note=f"no convention explains the readings; the nearest leaves {best.residual / fit.size:.2g} of them"
        )
    return fit.convention(best)


class _Fit:
    """The fit of hypotheses to readings (n, k), without the instants at which a reading or its exact value is not known."""

    def __init__(self, known: Laws, readings: Array) -> None:
        exactly = known.sources["solver"]
        self.chosen = np.isfinite(readings).all(axis=-1) & np.isfinite(exactly).all(axis=(0, -1))
        self.known, self.given, self.readings = known, readings, readings[self.chosen]
        self.aged = len(exactly) > 1
        self.size = _root_mean_square(self.readings)
        self.expected = _root_mean_square(exactly[0][self.chosen])
        self.frames: Sequence[Frame | str] = tuple(known.frames) or ("",)
        self.departures = ("", *known.departures, *known.factors)
        self.components = self.readings.shape[-1]

    def best(self) -> Hypothesis:
        """Return the hypothesis with the smallest cost. If that of the type of the sensor is exact, no other is tried."""
        plain = self.refitted(Hypothesis("solver", "", self.frames[0], self.identity))
        if plain.residual <= self.floor(plain):
            return plain
        return min(self.hypotheses(), key=self.cost)

    def hypotheses(self) -> Iterator[Hypothesis]:
        """Yield the best hypotheses of each source, departure and frame."""
        for source, departure, frame in product(self.known.sources, self.departures, self.frames):
            yield from self.of_axes(Hypothesis(source, departure, frame, self.identity))

    @property
    def identity(self) -> Axes:
        """The axes of the type of the sensor."""
        return tuple((component, 1) for component in range(self.components))

    def of_axes(self, hypothesis: Hypothesis) -> Iterator[Hypothesis]:
        """Yield a hypothesis with its own axes, with all of them reversed, and with the best axes."""
        exactly = self.at(hypothesis, self.ages(hypothesis))[:, :, None, :]  # (ages, n, 1, k)
        both = np.stack([exactly, -exactly])  # (2, ages, n, 1, k)
        squares = ((self.readings[None, None, :, :, None] - both) ** 2).mean(axis=2)  # (2, ages, k, k)
        choices = {self.identity, tuple((index, -1) for index, _ in self.identity)}
        errors = {axes: _sum(squares, axes) for axes in _signed_permutations(self.components)}
        choices.add(min(errors, key=lambda axes: float(errors[axes].min())))
        for axes in sorted(choices):
            begun = self.ages(hypothesis)[int(errors[axes].argmin())]
            yield self.fitted(replace(hypothesis, axes=axes, age=float(begun)))

    def ages(self, hypothesis: Hypothesis) -> Array:
        """Return the ages with which a hypothesis is tried."""
        if not self.aged:
            return np.zeros(1)
        return AGES if hypothesis.source == "solver" else np.arange(2.0)

    def at(self, hypothesis: Hypothesis, ages: Array) -> Array:
        """Return the readings (ages, n, k) by a hypothesis at ages (a,), in steps, with the axes in the order of the frame."""
        by_lag = self.known.sources[hypothesis.source]
        by_lag = by_lag + self.known.departures.get(hypothesis.departure, np.zeros(1))[: len(by_lag)]
        by_lag = by_lag * self.known.factors.get(hypothesis.departure, 1.0)
        if self.known.frames:
            standard, *_ = self.known.frames.values()
            turn = self.known.frames[hypothesis.frame]  # type: ignore[index]  # the frame of a vector
            world = rotate(standard[: len(by_lag)], by_lag)
            by_lag = by_lag if turn is standard else rotate(conjugate(turn[: len(by_lag)]), world)
        return np.tensordot(_weights(ages, len(by_lag)), by_lag[:, self.chosen], axes=1)

    def left(self, hypothesis: Hypothesis, age: float) -> Array:
        """Return what a hypothesis leaves of the readings (n, k) at an age (steps)."""
        order, signs = [index for index, _ in hypothesis.axes], np.array([sign for _, sign in hypothesis.axes])
        return np.asarray(self.readings - self.at(hypothesis, np.array([age]))[0][:, order] * signs)

    def fitted(self, hypothesis: Hypothesis) -> Hypothesis:
        """Return a hypothesis with its residual, and with the age that makes it smallest: a whole number if that is as good."""
        age = hypothesis.age
        if self.aged and hypothesis.source == "solver":
            for _ in range(4):  # steps of Gauss-Newton from a near age
                slope = (self.left(hypothesis, age + 1e-3) - self.left(hypothesis, age - 1e-3)) / 2e-3
                curvature = float((slope**2).sum())
                step = float((slope * self.left(hypothesis, age)).sum()) / curvature if curvature else 0.0
                age = float(np.clip(age - step, AGES[0], AGES[-1]))
        residual = _root_mean_square(self.left(hypothesis, age))
        whole = min((0.0, 1.0, 2.0), key=lambda number: abs(number - age)) if self.aged else 0.0
        of_whole = _root_mean_square(self.left(hypothesis, whole))
        if of_whole <= max(EQUAL * residual, self.floor(hypothesis)):
            return replace(hypothesis, age=whole, residual=of_whole)
        return replace(hypothesis, age=age, residual=residual)

    def floor(self, hypothesis: Hypothesis) -> float:
        """Return the rounding error of readings by a hypothesis."""
        return self.known.rounding[hypothesis.source] * self.known.factors.get(hypothesis.departure, 1.0)

    def cost(self, hypothesis: Hypothesis) -> float:
        """Return the logarithm of the residual plus 1 for each choice that is not that of the type of the sensor."""
        choices = (
            hypothesis.source != "solver",
            bool(hypothesis.departure),
            hypothesis.frame != self.frames[0],
            hypothesis.axes != self.identity,
        )
        return log10(max(hypothesis.residual, self.floor(hypothesis))) + sum(choices)

    def as_good(self, best: Hypothesis, other: Hypothesis) -> bool:
        """Return whether another hypothesis explains the readings as well as the best."""
        return other.residual <= max(EQUAL * best.residual, self.floor(best), self.floor(other))

    def convention(self, best: Hypothesis) -> Convention:
        """Return the convention of the best hypothesis, without what the readings cannot tell."""
        notes = [best.departure] if best.departure else []
        others = [one for one in self.departures if one not in ("", best.departure)] if best.departure else []
        equal = [one for one in others if self.as_good(best, self.refitted(replace(best, departure=one)))]
        if equal:
            notes = [f"one of: {', '.join((best.departure, *equal))}"]
        frame, source, untold = best.frame, str(best.source), []
        if any(self.as_good(best, self.refitted(replace(best, frame=one))) for one in self.frames if one != best.frame):
            frame = ""
            untold.append("the frame")
        sources = [one for one in self.known.sources if one != best.source]
        if any(self.as_good(best, self.refitted(replace(best, source=one))) for one in sources):
            source = ""
            untold.append("the source")
        sign, undetermined = self.sign(best)
        if undetermined:
            untold.append(undetermined)
        age, uncertainty = self.age(best)
        if self.aged and age is None:
            untold.append("the age")
        if untold:
            notes.append(f"the scene cannot tell {', '.join(untold)}")
        return Convention(sign, frame, age, uncertainty, source if self.aged else "", "; ".join(notes))

    def refitted(self, hypothesis: Hypothesis) -> Hypothesis:
        """Return a hypothesis with the best age."""
        ages = self.ages(hypothesis)
        errors = [_root_mean_square(self.left(hypothesis, float(age))) for age in ages]
        return self.fitted(replace(hypothesis, age=float(ages[int(np.argmin(errors))])))

    def sign(self, best: Hypothesis) -> tuple[str, str]:
        """Return the sign of a convention, and in words what the readings do not tell of it.

        A component is determined if it equals a single signed component of the exact readings.
        """
        exactly = self.at(best, np.array([best.age]))[0]
        limit = max(EQUAL * best.residual * sqrt(self.components), self.floor(best))
        equals = {
            component: [
                (index, sign)
                for index in range(self.components)
                for sign in (1, -1)
                if _root_mean_square(self.readings[:, component] - sign * exactly[:, index]) <= limit
            ]
            for component in range(self.components)
        }
        determined = {component for component, fitting in equals.items() if len(fitting) == 1}
        if not determined:
            return "", "the sign"
        names = "xyz"[: self.components]
        undetermined = f"the axes {', '.join(names[one] for one in equals if one not in determined)}"
        signs = {best.axes[one][1] for one in determined}
        if all(best.axes[one][0] == one for one in determined) and len(signs) == 1:
            text = "+" if signs == {1} else "-"
        else:
            text = " ".join(
                f"{'+' if sign > 0 else '-'}{names[index]}" if component in determined else "?"
                for component, (index, sign) in enumerate(best.axes)
            )
        return text, undetermined if len(determined) < self.components else ""

    def present(self, source: Source) -> "_Fit":
        """Return the fit with accelerations or velocities alone before the readings, and the axes and departures at them."""
        known, lags = self.known, len(self.known.delayed[source])
        departures, frames = (
            {name: np.broadcast_to(values[:1], (lags, *values.shape[1:])) for name, values in each.items()}
            for each in (known.departures, known.frames)
        )
        now = replace(known, sources={"solver": known.delayed[source]}, departures=departures, frames=frames)  # type: ignore[arg-type]
        return _Fit(now, self.given)

    def age(self, best: Hypothesis) -> tuple[float | None, float | None]:
        """Return the age of the exact readings that fit best (steps), and its uncertainty; None if it cannot be told."""
        if not self.aged:
            return None, None
        of_ages = self if best.source not in self.known.delayed else self.present(best.source)
        fit = of_ages.refitted(replace(best, source="solver"))
        slope = _root_mean_square(of_ages.left(fit, fit.age + 0.5) - of_ages.left(fit, fit.age - 0.5))
        uncertainty = hypot(fit.residual, self.floor(fit)) / slope if slope else inf
        if uncertainty > UNCERTAIN or fit.age in (AGES[0], AGES[-1]):
            return None, None
        return round(fit.age, min(6, max(0, ceil(-log10(uncertainty))))), float(f"{uncertainty:.2g}")


def _weights(ages: Array, lags: int) -> Array:
    """Return the weights (a, lags) with which polynomials through values at lags are interpolated at ages (a,), in steps."""
    weights = np.ones((len(ages), lags))
    for lag, other in product(range(lags), repeat=2):
        if lag != other:
            weights[:, lag] *= (ages - other) / (lag - other)
    return weights


def _signed_permutations(count: int) -> Iterator[Axes]:
    """Yield all signed permutations of components."""
    for order, signs in product(permutations(range(count)), product((1, -1), repeat=count)):
        yield tuple(zip(order, signs, strict=True))


def _sum(squares: Array, axes: Axes) -> Array:
    """Return the mean squares (a,) of a signed permutation from those of single components (2, a, k, k)."""
    terms = [squares[0 if sign > 0 else 1, :, component, index] for component, (index, sign) in enumerate(axes)]
    return np.asarray(np.sum(terms, axis=0))


def _root_mean_square(values: Array) -> float:
    return float(np.sqrt(np.mean(np.square(values)))) if values.size else 0.0
