"""What a submission says of motions: how each truth was found, and how its bodies and those of the engines move.

Engines move with the method that each chooses itself. Motions are stored as the player of reports reads them: at few instants,
in 16 bits. They stand in a file of JSON, which is bounded by its size before it is read, as no compressed table is.
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

#: Most bytes of the file, and most motions.
MOST_BYTES, MOST_MOTIONS = 1 << 24, 2000

#: The largest length, time and rate.
LARGEST = 1e15

#: The largest last instant of a track as a share of that of the motion: rounding.
LATEST = 1 + 1e-6

#: Bytes of an instant, and of three numbers of 16 bits.
INSTANT, TRIPLE = 8, 6

#: The columns of results.csv that name a run.
RUN = ("case", "engine", "version", "integrator", "timestep")

#: What a record of a truth says in words.
TEXTS = ("reason", "why", "model", "backend")

Text = Annotated[str, Field(strict=True, max_length=16 * MOST_INSTANTS)]
Size = Annotated[Finite, Field(gt=0, le=LARGEST)]
Small = Annotated[Finite, Field(ge=0, le=LARGEST)]
Place = Annotated[Finite, Field(ge=-LARGEST, le=LARGEST)]


@dataclass(frozen=True)
class Turning:
    """How a body turns; see `bodycheck.reports.runs.motions.tracks.Turning.encoded`."""

    t: Text
    turn: Text
    rate: Text
    fastest: Size


@dataclass(frozen=True)
class Course:
    """Where a body goes; see `bodycheck.reports.runs.motions.tracks.Course.encoded`."""

    t: Text
    place: Text
    farthest: Size
    within: Small


@dataclass(frozen=True)
class Part:
    """How one body moves; None for what is as that of the truth, or what the player does not show."""

    turning: Turning | None = None
    course: Course | None = None


@dataclass(frozen=True)
class RunMotion:
    """The motion of a run.

    Parameters
    ----------
    engine, version, integrator
        The run, as results.csv has it; case and time step are those of its motion.
    parts
        How each body moves; none of several bodies where all move as those of the truth do.
    """

    engine: str
    version: str
    integrator: str
    parts: list[Part]


@dataclass(frozen=True)
class FrameRecord:
    """What pictures of several bodies show; see `bodycheck.reports.runs.motions.playback.Frame`."""

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
        How each body of the truth moves.
    runs
        The runs.
    momentum
        The largest angular momentum of a single body, in a unit of its own; 0 of several bodies.
    frame
        What the pictures show; None of a single body, whose pictures follow from the case.
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
        """Return what the pictures show."""
        return None if self.frame is None else Frame(**asdict(self.frame))


@dataclass(frozen=True)
class Tracks:
    """All that a submission says of motions.

    Parameters
    ----------
    truths
        How the truth of each case was found, as the record of a journal says it, or why there is none; by case.
    motions
        The motions.
    """

    truths: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    motions: Sequence[Motion] = ()

    def renamed(self, names: Mapping[str, str]) -> "Tracks":
        """Return them with other names of cases."""
        truths = {names.get(case, case): record for case, record in self.truths.items()}
        return Tracks(truths, [replace(one, case=names.get(one.case, one.case)) for one in self.motions])


#: The tracks of a submission that has none.
NO_TRACKS = Tracks()


def written(tracks: Tracks) -> bytes:
    """Return the content of the file; see `read`."""
    told = {"format": FORMAT, "truths": list(tracks.truths.values()), "motions": [_bare(asdict(one)) for one in tracks.motions]}
    return (json.dumps(told, separators=(",", ":"), sort_keys=True, ensure_ascii=True, allow_nan=False) + "\n").encode()


def read(content: bytes, cases: Mapping[str, Case], runs: Collection[tuple[Any, ...]]) -> Tracks:
    """Return what a submission says of motions.

    Parameters
    ----------
    content
        The content of the file.
    cases
        The cases of the submission by name.
    runs
        The columns `RUN` of each completed run in its results.csv.

    Raises
    ------
    BadInput
        The file is not as bodycheck writes it, or tells of cases or runs that the submission does not have.
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
    """Return the instants (k,), s, of a part, and its columns of three shares (k, 3) in 16 bits.

    Raises `ValueError` if they are not so.
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
    """Return a value of JSON without what is None."""
    if isinstance(value, dict):
        return {name: _bare(one) for name, one in value.items() if one is not None}
    return [_bare(one) for one in value] if isinstance(value, list | tuple) else value


def _truth(record: dict[str, Any]) -> Mapping[str, Any]:
    """Return the record of a truth without what is not read of it. Raises `ValueError` if it is none."""
    kind = records.NoTruthRecord if "reason" in record else records.TruthRecord
    records.typed(kind, record)
    known = {name: record[name] for name in kind.__dataclass_fields__ if name in record}
    for shown in (*(known[name] for name in TEXTS if name in known), *known.get("witnesses", ())):
        text(shown)
    return known


def _check_runs(motions: Sequence[Motion], runs: Collection[tuple[Any, ...]]) -> None:
    """Raise `ValueError` if a motion is that of no run, or if there are two of a case or a run."""
    known = set(runs)
    told = [(one.case, run.engine, run.version, run.integrator, one.timestep) for one in motions for run in one.runs]
    if other := [key for key in told if key not in known]:
        raise ValueError(f"tell of a run of {str(other[0][1])[:60]!r} on {other[0][0]} that results.csv does not have")
    if len(set(told)) < len(told) or len({(one.case, one.timestep) for one in motions}) < len(motions):
        raise ValueError("have a motion twice")


def _check(motion: Motion, case: Case) -> None:
    """Raise `ValueError` unless a motion has what the player reads of the case."""
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
    """Raise `ValueError` unless there are so many bodies, each with what it must have: a turning, a course."""
    if len(parts) != bodies:
        raise ValueError(f"have {len(parts)} bodies of {motion.case}, which has {bodies}")
    for part in parts:
        if (turns and part.turning is None) or (goes and part.course is None):
            raise ValueError(f"lack how a body of {motion.case} moves")
        for way in (part.turning, part.course):
            if way is not None and arrays(way)[0][-1] > LATEST * motion.end:
                raise ValueError(f"have a motion of {motion.case} after its end")
