"""The cards of scenes: a small picture of the motion, and how far the own methods of engines are off."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from markupsafe import Markup

from bodycheck.reference.bodies import bodies, initial
from bodycheck.reference.mechanisms.mechanism import alone
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reports.quantities import listing, number
from bodycheck.reports.runs.motions import tracks
from bodycheck.reports.runs.motions.single_body import reach_of
from bodycheck.reports.runs.motions.stills import still
from bodycheck.results.verdicts import SCENES, Verdict
from bodycheck.site.catalogue import Catalogue, Scene
from bodycheck.site.cells import Cell, cell
from bodycheck.site.submissions.tracks import Motion, Part, arrays

#: The instants at which a motion is read for its picture.
INSTANTS = 121

#: The most engines that a line of a card names.
MOST_NAMED = 2

#: The verdicts that a card tells in a line of their own, if any engine has them.
TOLD: tuple[Verdict, ...] = ("failed", "broken", "refused")


@dataclass(frozen=True, eq=False)
class Card:
    """A scene in the list of scenes.

    Parameters
    ----------
    scene
        The scene.
    picture
        A picture of its motion as SVG; empty if there is none.
    lines
        What became of the own methods of engines, in words.
    """

    scene: Scene
    picture: Markup
    lines: tuple[str, ...]

    @property
    def words(self) -> str:
        """Return the text that the search of the page finds, in small letters."""
        return " ".join((self.scene.name, *self.scene.case.tags, self.scene.case.title)).lower()


def card(catalogue: Catalogue, scene: Scene) -> Card:
    """Return the card of a scene."""
    cells = [(engine, cell(catalogue, engine, scene)) for engine in catalogue.engines]
    return Card(scene, Markup(picture(catalogue, scene)), tuple(_lines(scene, cells)))  # numbers alone


def picture(catalogue: Catalogue, scene: Scene) -> str:
    """Return a picture of the truth as SVG text, from the newest submission with its motion.

    Without such a motion it shows the state at the start. It is empty if the motion cannot be drawn.
    """
    known = (motion for source in reversed(catalogue.submissions) for motion in source.tracks.motions)
    motion = next((one for one in known if one.case == scene.name), None)
    trajectory = initial(scene.case.scene) if motion is None else _truth(scene, motion)
    return still(scene.case.scene, trajectory)


def _truth(scene: Scene, motion: Motion) -> Trajectory:
    """Return the motion of the truth at `INSTANTS` instants; its velocities, which pictures do not show, are not known."""
    t = np.linspace(0.0, motion.end, INSTANTS)
    positions = np.stack([_places(scene, motion, part, t) for part in motion.truth])
    turns = np.stack([_turns(part, t) for part in motion.truth])
    unknown = np.full_like(positions, np.nan)
    several = len(motion.truth) > 1 or len(bodies(scene.case.scene)) > 1
    trajectory = Trajectory(t, positions, turns, unknown, unknown)
    return trajectory if several else trajectory.body(0)


def _places(scene: Scene, motion: Motion, part: Part, t: Array) -> Array:
    """Return the positions (n, 3), m, of a body at times (n,), s; all 0 for a body in flight."""
    if part.course is None:
        return np.zeros((len(t), 3))
    times, shares = arrays(part.course)
    places = shares / tracks.LEVELS * part.course.farthest
    if motion.shown is None:
        places = places * reach_of(alone(scene.case.scene).body)
    else:
        places = places * motion.shown.extent + np.array(motion.shown.middle)
    return np.column_stack([np.interp(t, times, column) for column in places.T])


def _turns(part: Part, t: Array) -> Array:
    """Return the attitudes (n, 4) of a body at times (n,), s."""
    if part.turning is None:
        return np.tile([1.0, 0.0, 0.0, 0.0], (len(t), 1))
    times, turn, rate = arrays(part.turning)
    track = tracks.Turning(times, turn / tracks.LEVELS * np.pi, rate / tracks.LEVELS * part.turning.fastest)
    return tracks.played(track, np.clip(t, times[0], times[-1]))[0]


def _lines(scene: Scene, cells: Sequence[tuple[str, Cell]]) -> list[str]:
    """Return what became of the own methods of engines: the smallest and the largest error, and what else happened."""
    unit = scene.quantity.unit
    measured = [
        (engine, one.value) for engine, one in cells if one.value is not None and one.verdict in ("exact", "error", "broken")
    ]
    lines = []
    if measured:
        ends = dict.fromkeys((min(measured, key=lambda one: one[1]), max(measured, key=lambda one: one[1])))
        lines += [f"{number(value, 2)} {unit}".rstrip() + f" {engine}" for engine, value in ends]
    for verdict in TOLD:
        if engines := [engine for engine, one in cells if one.verdict == verdict]:
            lines.append(f"{SCENES[verdict].title}: {listing(engines, MOST_NAMED, 'engine')}")
    if all(one.verdict == "not run" for _, one in cells):
        return ["no runs, but figures in other tables"]
    without = sum(one.verdict in ("unsupported", "not run") for _, one in cells)
    if without:
        lines.append(f"{len(cells) - without} of {len(cells)} engines")
    return lines
