"""The safety factors of intervals, one for each class of scenes, as they were measured, and the class of a scene."""

import json
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import TYPE_CHECKING, Literal, get_args

from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.requirements import touches

if TYPE_CHECKING:  # reports are written where there are no engines
    from bodycheck.running.refining import Motion

#: The classes of scenes, from the smoothest motion to the least smooth one.
Kind = Literal["smooth", "driven", "dry friction", "soft contact", "impacts"]
KINDS: tuple[Kind, ...] = get_args(Kind)

#: The least share of intervals that must contain the error, by classes.
LEAST_COVERAGE: dict[Kind, float] = {
    "smooth": 0.95,
    "driven": 0.95,
    "dry friction": 0.9,
    "soft contact": 0.9,
    "impacts": 0.9,
}

#: The classes whose intervals must be narrow, and the largest median of their width over the error.
NARROW: tuple[Kind, ...] = ("smooth", "driven")
MOST_WIDTH = 2.0


@dataclass(frozen=True)
class Factor:
    """The safety factor of a class, and what was measured with it.

    Attributes
    ----------
    factor
        The ratio of the upper end of the interval of a finest run to its estimate.
    coverage
        The share of the intervals that contain the error.
    width
        The median of the width of intervals over the error.
    sample
        The number of runs with an estimate, on which coverage and width were measured.
    refused
        The number of runs without an estimate.
    engine
        The engine with its version.
    command
        The command that measured it.
    """

    factor: float
    coverage: float
    width: float
    sample: int
    refused: int
    engine: str
    command: str = ""

    def holds(self, kind: Kind) -> bool:
        """Return whether the intervals are right as often, and as narrow, as those of a class must be for an estimate."""
        least = LEAST_COVERAGE[kind]
        return self.sample > 0 and self.coverage >= least and (kind not in NARROW or self.width <= MOST_WIDTH)

    @property
    def told(self) -> str:
        """The measurement as a clause."""
        return (
            f"covers {100 * self.coverage:.1f} % of {self.sample:,} runs of this class, "
            f"at {self.width:.2g} times the error in the median"
        )


@cache
def factors() -> dict[Kind, Factor]:
    """Return the measured factor of each class of scenes."""
    records = json.loads(files(__package__).joinpath("factors.json").read_text("utf-8"))
    return {kind: Factor(**records[kind]) for kind in KINDS}


def of_case(scene: AnyScene) -> Kind:
    """Return the class of the scene of a case."""
    if touches(scene) or scene.plane is not None:
        laws = scene.contact_laws if isinstance(scene, Mechanism) else (scene.plane,)
        bounces = any(law is not None and law.restitution > 0 for law in laws)
        return "impacts" if bounces else "soft contact"
    if isinstance(scene, Mechanism):
        if any(joint.stops is not None for joint in scene.joints):
            return "impacts"
        if any(joint.friction for joint in scene.joints):
            return "dry friction"
        if scene.controllers:
            return "driven"
    return "driven" if scene.pushes else "smooth"


def of_file(motion: "Motion", driven: bool, friction: bool) -> Kind:
    """Return the class of the scene of a file from its finest motion. driven, friction: as in `FileFacts`."""
    acting = [frozenset(one for one in regime if not one.startswith("saturation")) for regime in motion.regimes]
    if len(set(acting)) > 1:
        return "impacts"
    if acting and acting[0]:
        return "soft contact"
    if friction:
        return "dry friction"
    return "driven" if driven else "smooth"
