"""The figure of regularised friction: the speed below which friction brakes a body less than Coulomb's law does."""

import numpy as np

from bodycheck.figures.definition import Comparison, Figure
from bodycheck.reference.contact.touching import pushes_on
from bodycheck.reference.requirements import slides
from bodycheck.reference.scenes import Scenes
from bodycheck.reference.trajectory import Array, Trajectory

#: The part of the exact deceleration below which friction counts as viscous.
VISCOUS = 0.9

#: The largest difference of a speed from that of a constant deceleration, relative to the speed at its start, for which the
#: deceleration counts as constant. The truth of a constant deceleration differs by its rounding.
CONSTANT = 1e-9

#: The fewest samples of the truth from which a constant deceleration is recognised.
LEAST_SAMPLES = 3


def viscous_speed(compared: Comparison) -> float | None:
    """Return the speed (m/s) below which friction decelerates a body by less than `VISCOUS` of the exact value.

    The deceleration is the mean between two samples. From this speed on until the end, no mean reaches that part. An interval
    within which the exact deceleration would stop the body does not count. The figure exists for a body on a level plane that
    a constant friction brings to rest; the largest value of several bodies counts.
    """
    scene = compared.scene
    if isinstance(scene, Scenes) or scene.plane is None or scene.plane.incline:
        return None
    speeds = [
        speed
        for index, (seen, exact) in enumerate(compared.motions)
        if not pushes_on(scene, index)
        for begin, end in _braking(compared, index)
        if (speed := viscous_below(exact.t, _speeds(seen), _speeds(exact), begin, end)) is not None
    ]
    return max(speeds, default=None)


def viscous_below(t: Array, seen: Array, exact: Array, begin: float, end: float) -> float | None:
    """Return the speed (m/s) below which a run decelerates by less than `VISCOUS` of the exact constant deceleration.

    None if the exact deceleration is not constant, or if fewer than `LEAST_SAMPLES` samples lie within its time.

    Parameters
    ----------
    t, seen, exact
        Instants (n,), s, and the speeds (n,), m/s, of the body at these instants in the run and in the truth.
    begin, end
        The instants (s) between which friction brakes the body to rest in the truth.
    """
    braking = (t >= begin) & (t < end)
    left, speeds = end - t[braking], exact[braking]
    if len(left) < LEAST_SAMPLES or not speeds[0] > 0:
        return None
    deceleration = float(speeds[0] / left[0])
    if not np.all(np.abs(speeds - deceleration * left) <= CONSTANT * speeds[0]):
        return None
    first = int(np.argmax(braking))
    intervals, speeds = np.diff(t[first:]), seen[first:]
    lasts = speeds[:-1] > deceleration * intervals
    brakes = np.flatnonzero(lasts & (-np.diff(speeds) >= VISCOUS * deceleration * intervals))
    after = slice(int(brakes[-1]) + 1 if len(brakes) else 0, None)
    return float(np.max(speeds[:-1][after], where=lasts[after], initial=0.0))


def _braking(compared: Comparison, index: int) -> list[tuple[float, float]]:
    """Return the instants (s) between which friction brakes a body to rest in the truth; none if it does not come to rest."""
    scene, truth = compared.scene, compared.truth
    if not isinstance(scene, Scenes) and slides(scene):
        return [] if truth.stop is None else [(0.0, truth.stop.time)]
    events = [event for event in compared.events if event.body == index]
    if not events or events[-1].kind != "rest":
        return []
    return [(max((event.time for event in events[:-1]), default=0.0), events[-1].time)]


def _speeds(motion: Trajectory) -> Array:
    """Return the speed (n,), m/s, of the centre of mass along a level plane."""
    return np.hypot(motion.velocity[:, 0], motion.velocity[:, 1])


FIGURES = (
    Figure(
        name="viscous_speed",
        title="Viscous speed",
        meaning=(
            "speed below which the friction of the run decelerates a body by less than nine tenths of the exact friction; 0 if "
            "the samples show none"
        ),
        unit="m/s",
        remark="of a body that a constant friction brings to rest on a level plane",
        compute=viscous_speed,
        scale=lambda scales: scales.speed,
    ),
)
