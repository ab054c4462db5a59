"""The tracks of a submission: how each truth was computed, and the motions of bodies in the truth and in engines.

The motion of an engine is from the method that it chooses itself. Motions are stored as the player of reports reads them: at
few instants, with 16 bits per number. They are in a JSON file, whose size is checked before it is read.
"""

import json
from base64 import b64decode
from collections.abc import Collection, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from bodycheck.casefile.content import Case
from bodycheck.casefile.values import Finite, Name
from bodycheck.errors import BadInput
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.requirements import touches
from bodycheck.reports.runs.motions.playback import Frame
from bodycheck.reports.runs.motions.tracks import MOST_INSTANTS
from bodycheck.results import records
from bodycheck.results.records import Timestep
from bodycheck.site.submissions.texts import text

#: The version of the format.
FORMAT = 1

#: The most bytes of the file, and the most motions in it.
MOST_BYTES, MOST_MOTIONS = 1 << 24, 2000

#: The largest absolute value of a length, time or rate.
LARGEST = 1e15

#: The largest ratio of the last instant of a track to the last instant of the motion; above 1 because of rounding.
LATEST = 1 + 1e-6

#: The bytes of an instant, and of three numbers of 16 bits.
INSTANT, TRIPLE = 8, 6

#: The columns of results.csv that identify a run.
RUN = ("case", "engine", "version", "integrator", "timestep")

#: The entries of the record of a truth that are texts.
TEXTS = ("reason", "why", "model", "backend")

Text = Annotated[str, Field(strict=True, max_length=16 * MOST_INSTANTS)]
Size = Annotated[Finite, Field(gt=0, le=LARGEST)]
Small = Annotated[Finite, Field(ge=0, le=LARGEST)]
Place = Annotated[Finite, Field(ge=-LARGEST, le=LARGEST)]


@dataclass(frozen=True)
class Turning:
    """The rotation of a body; see `bodycheck.reports.runs.motions.tracks.Turning.encoded`."""

    t: Text
    turn: Text
    rate: Text
    fastest: Size


@dataclass(frozen=True)
class Course:
    """The path of a body; see `bodycheck.reports.runs.motions.tracks.Course.encoded`."""

    t: Text
    place: Text
    farthest: Size
    within: Small


@dataclass(frozen=True)
class Part:
    """The motion of one body; an entry is None if it equals that of the truth, or if the player does not show it."""

    turning: Turning | None = None
    course: Course | None = None


@dataclass(frozen=True)
class RunMotion:
    """The motion of a run.

    Parameters
    ----------
    engine, version, integrator
        The run, as given in results.csv; the `Motion` that contains it gives the case and the time step.
    parts
        The motion of each body; empty for a scene of several bodies if all bodies move as in the truth.
    """

    engine: str
    version: str
    integrator: str
    parts: list[Part]


@dataclass(frozen=True)
class FrameRecord:
    """The region that pictures of several bodies show; see `bodycheck.reports.runs.motions.playback.Frame`."""

    middle: tuple[Place, Place, Place]
    extent: Size
    azimuth: Place
    known: Place | None = None


@dataclass(frozen=True)
class Motion:
    """The motions of a case at one time step.

    Parameters
    ----------
    case, timestep
        The case, and the time step (s) at whose ends states were taken.
    end
        The last instant (s).
    truth
        The motion of each body in the truth.
    runs
        The motions of the runs.
    momentum
        The largest angular momentum of a single body, in an arbitrary unit; 0 for several bodies.
    frame
        The region that the pictures show; None for a single body, whose pictures follow from the case.
    """

    case: Name
    timestep: Timestep
    end: Size
    truth: list[Part]
    runs: list[RunMotion]
    momentum: Small = 0.0
    frame: FrameRecord | None = None

    @property
    def shown(self) -> Frame | None:
        """Return the region that the pictures show; None for a single body."""
        return None if self.frame is None else Frame(**asdict(self.frame))


@dataclass(frozen=True)
class Tracks:
    """The truths and the motions of a submission.

    Parameters
    ----------
    truths
        The record of the truth of each case by case: how it was computed, or the reason why there is no truth.
    motions
        The motions.
    """

    truths: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    motions: Sequence[Motion] = ()

    def renamed(self, names: Mapping[str, str]) -> "Tracks":
        """Return the tracks with renamed cases. names: the new names by the old ones; other cases keep their names."""
        truths = {names.get(case, case): record for case, record in self.truths.items()}
        return Tracks(truths, [replace(one, case=names.get(one.case, one.case)) for one in self.motions])


#: The tracks of a submission that has none.
NO_TRACKS = Tracks()


def written(tracks: Tracks) -> bytes:
    """Return the content of the file of tracks; see `read`."""
    told = {"format": FORMAT, "truths": list(tracks.truths.values()), "motions": [_bare(asdict(one)) for one in tracks.motions]}
    return (json.dumps(told, separators=(",", ":"), sort_keys=True, ensure_ascii=True, allow_nan=False) + "\n").encode()


def read(content: bytes, cases: Mapping[str, Case], runs: Collection[tuple[Any, ...]]) -> Tracks:
    """Return the tracks of a submission from the content of its file.

    Parameters
    ----------
    content
        The content of the file.
    cases
        The cases of the submission by name.
    runs
        The entries in the columns `RUN` for each completed run in the results.csv of the submission.

    Raises
    ------
    BadInput
        The file is not as bodycheck writes it, or contains cases or runs that the submission does not have.
    """
    if len(content) > MOST_BYTES:
        raise BadInput(f"tracks: are larger than {MOST_BYTES} bytes, which is the most that is allowed")
    try:
        told = json.loads(content)
        if told["format"] != FORMAT:
            raise ValueError(f"have the format {str(told['format'])[:20]}; this version reads format {FORMAT}")
        truths = {one["case"]: _truth(one) for one in told["truths"]}
        if len(told["motions"]) > MOST_MOTIONS:
            raise ValueError(f"have {len(told['motions'])} motions; at most {MOST_MOTIONS} are allowed")
        motions = [records.typed(Motion, one) for one in told["motions"]]
        if untold := (truths.keys() | {one.case for one in motions}) - cases.keys():
            raise ValueError(f"tell of {min(untold)}, of which there is no case file")
        _check_runs(motions, runs)
        for one in motions:
            _check(one, cases[one.case])
    except (ValueError, TypeError, KeyError, RecursionError) as error:
        raise BadInput(f"tracks: {' '.join(str(error).split())[:300]}") from error
    return Tracks(truths, motions)


def arrays(part: Turning | Course) -> tuple[Any, ...]:
    """Return the instants (k,), in s, of a rotation or path, and its arrays (k, 3) of 16-bit integers.

    A rotation (`Turning`) has the arrays `turn` and `rate`, and a path (`Course`) has the array `place`. Raises `ValueError` if
    the data do not have this form.
    """
    names = ("turn", "rate") if isinstance(part, Turning) else ("place",)
    instants = b64decode(part.t, validate=True)
    if len(instants) % INSTANT:
        raise ValueError("have instants that are not numbers")
    t = np.frombuffer(instants, "<f8")
    if not 2 <= len(t) <= MOST_INSTANTS or not np.isfinite(t).all() or t[0] < 0 or not (np.diff(t) > 0).all():
        raise ValueError(f"have instants that do not ascend, or not 2 to {MOST_INSTANTS} of them")
    found = []
    for name in names:
        numbers = b64decode(getattr(part, name), validate=True)
        if len(numbers) != TRIPLE * len(t):
            raise ValueError(f"have a {name} that has not three numbers for each instant")
        found.append(np.frombuffer(numbers, "<i2").reshape(-1, 3))
    return t, *found


def _bare(value: Any) -> Any:
    """Return a JSON value without the entries of objects that are None."""
    if isinstance(value, dict):
        return {name: _bare(one) for name, one in value.items() if one is not None}
    return [_bare(one) for one in value] if isinstance(value, list | tuple) else value


def _truth(record: dict[str, Any]) -> Mapping[str, Any]:
    """Return the known entries of the record of a truth. Raises `ValueError` if the record is invalid."""
    kind = records.NoTruthRecord if "reason" in record else records.TruthRecord
    records.typed(kind, record)
    known = {name: record[name] for name in kind.__dataclass_fields__ if name in record}
    for shown in (*(known[name] for name in TEXTS if name in known), *known.get("witnesses", ())):
        text(shown)
    return known


def _check_runs(motions: Sequence[Motion], runs: Collection[tuple[Any, ...]]) -> None:
    """Raise `ValueError` if a motion is of an unknown run, or if a run or a case with its time step occurs twice."""
    known = set(runs)
    told = [(one.case, run.engine, run.version, run.integrator, one.timestep) for one in motions for run in one.runs]
    if other := [key for key in told if key not in known]:
        raise ValueError(f"tell of a run of {str(other[0][1])[:60]!r} on {other[0][0]} that results.csv does not have")
    if len(set(told)) < len(told) or len({(one.case, one.timestep) for one in motions}) < len(motions):
        raise ValueError("have a motion twice")


def _check(motion: Motion, case: Case) -> None:
    """Raise `ValueError` unless a motion has all data that the player needs for the case."""
    scene = case.scene
    several = isinstance(scene, Mechanism) or touches(scene)
    if several != (motion.frame is not None):
        verb = "lack" if several else "have"
        raise ValueError(f"{verb} a frame for the pictures of {case.name}; mechanisms and bodies that touch have one")
    bodies = len(scene.bodies) if isinstance(scene, Mechanism) else 1
    goes = several or (not isinstance(scene, Mechanism) and scene.plane is not None)
    _check_parts(motion, motion.truth, bodies, turns=True, goes=goes)
    for run in motion.runs:
        if run.parts or not several:
            _check_parts(motion, run.parts, bodies, turns=several, goes=goes)


def _check_parts(motion: Motion, parts: Sequence[Part], bodies: int, *, turns: bool, goes: bool) -> None:
    """Raise `ValueError` unless there is a part for each of the bodies, with the rotation and path that it must have.

    turns, goes: whether each part must have a rotation and a path.
    """
    if len(parts) != bodies:
        raise ValueError(f"have {len(parts)} bodies of {motion.case}, which has {bodies}")
    for part in parts:
        if (turns and part.turning is None) or (goes and part.course is None):
            raise ValueError(f"lack the rotation or the path of a body of {motion.case}")
        for way in (part.turning, part.course):
            if way is not None and arrays(way)[0][-1] > LATEST * motion.end:
                raise ValueError(f"have a motion of {motion.case} after its end")
