"""Measure how often intervals are right: the coverage and the width of the intervals of each class of scenes.

`members` draws the scenes and measures them. The intervals are made here, from the measured differences, with the functions
that make those of a study.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from itertools import chain, zip_longest
from pathlib import Path
from statistics import median

from bodycheck.adapters.contract import Engine
from bodycheck.adapters.engine_name import in_words
from bodycheck.console import terminal
from bodycheck.console.arguments import load_engines
from bodycheck.console.output import say
from bodycheck.console.progress import progress
from bodycheck.errors import BadInput
from bodycheck.files.temporary import temporary_folder
from bodycheck.processes import pool
from bodycheck.results import journal, resumption
from bodycheck.results.header import Header
from bodycheck.results.journal import BadJournal
from bodycheck.results.records import typed
from bodycheck.running import campaign, engines
from bodycheck.studies.estimate import factors, members, refinement
from bodycheck.studies.estimate.factors import KINDS, Factor, Kind
from bodycheck.studies.estimate.members import FINER_BY, PAIRS, WITH_TRUTH, Measured, Member
from bodycheck.studies.estimate.refinement import Interval, Reference

#: The number of members of each class with a truth, and of each other class, whose runs take longer.
MEMBERS, MEMBERS_BY_REFINEMENT = 5000, 500

#: The seed of the members with which the shipped factors were set; coverage is measured on those of others.
SEED_OF_FACTORS = 1

#: The number of members that one call measures, and the time limit (s) of a call.
IN_PORTION, LIMIT = 25, 1200.0

#: The share of intervals that factors are set for, in classes with a truth and in others, and the factors that are tried, from
#: the usual one of a grid convergence index on (Roache, Annu. Rev. Fluid Mech. 29, 1997).
SHARE, SHARE_BY_REFINEMENT = 0.97, 0.93
TRIED = tuple(round(1.25 + 0.05 * step, 2) for step in range(56))

#: The part of an error up to which it must be known for the run to count.
KNOWN = 1 / 3

#: The file of what was measured.
RECORDS = "members.jsonl"


def interval(one: Measured, factor: float) -> Interval | None:
    """Return the interval of the run of a member with a factor; None if it has no estimate."""
    if one.refused:
        return None
    apart = dict(zip(PAIRS, one.differences, strict=True))
    count = len(one.steps)
    claimed = math.inf if one.claimed is None else one.claimed
    seen = refinement.reference(apart, count, one.nudge, one.steps[-1], factor, claimed)
    if not isinstance(seen, Reference):
        return None
    rounding = refinement.accumulated(one.nudge, one.steps[one.level])
    return refinement.interval(seen, apart, count, one.level, rounding, factor)


def is_known(kind: Kind, one: Measured) -> bool:
    """Return whether the error of a run is known well enough to say whether an interval contains it.

    In classes with a truth, it is known to the bound of the truth. In others, the run with the smaller step has a rounding
    error: in each step up to half of that which one rounding at the start makes.
    """
    if one.refused:
        return True
    bound = one.bound if kind in WITH_TRUTH else 0.5 * one.nudge * one.steps[one.level] * FINER_BY
    return bound <= KNOWN * one.error


def factor_of(engine: str, measured: Sequence[Measured], factor: float) -> Factor:
    """Return a factor with the coverage and the width of its intervals. engine: words with version."""
    pairs = [(one, interval(one, factor)) for one in measured]
    known = [(one, ends) for one, ends in pairs if ends is not None]
    inside = [ends.low <= one.error <= ends.high for one, ends in known]
    widths = [(ends.high - ends.low) / one.error for one, ends in known if one.error > 0]
    width = median(widths) if widths else 0.0
    return Factor(factor, sum(inside) / max(1, len(known)), width, len(known), len(measured) - len(known), engine)


def smallest(kind: Kind, engine: str, measured: Sequence[Measured]) -> Factor:
    """Return the smallest factor whose intervals have the share of coverage that is wanted; the largest if none has."""
    share = SHARE if kind in WITH_TRUTH else SHARE_BY_REFINEMENT
    tried = (factor_of(engine, measured, factor) for factor in TRIED)
    return next((one for one in tried if one.coverage >= share), factor_of(engine, measured, TRIED[-1]))


@dataclass(frozen=True)
class Portion:
    """Consecutive members of a class, which one call measures: the engine, the class, the seed, and their numbers."""

    engine: str
    kind: Kind
    seed: int
    first: int
    last: int

    @property
    def members(self) -> Iterator[Member]:
        """The members."""
        return (Member(self.engine, self.kind, self.seed, number) for number in range(self.first, self.last))


def portions(engine: str, seed: int, count: int | None) -> list[Portion]:
    """Return the portions of all classes, in turns. count: the number of members of each class; None for the usual one."""
    columns = []
    for kind in KINDS:
        number = count or (MEMBERS if kind in WITH_TRUTH else MEMBERS_BY_REFINEMENT)
        firsts = range(0, number, IN_PORTION)
        columns.append([Portion(engine, kind, seed, first, min(number, first + IN_PORTION)) for first in firsts])
    return [one for one in chain(*zip_longest(*columns)) if one is not None]


def perform(asked: Portion) -> list[Measured]:
    """Return what was measured of the members of a portion; those that cannot be run are left out."""
    return [one for one in map(members.measured, asked.members) if one is not None]


def _engine(asked: Portion) -> str:
    return asked.engine


def samples(wanted: Sequence[Portion], folder: Path, head: Header, jobs: int, quiet: bool) -> dict[Kind, list[Measured]]:
    """Return what was measured of the members of each class whose error is known well enough.

    What a folder has of them is not measured again.
    """
    path = folder / RECORDS
    done = _kept(path, head, wanted)
    if not done.keys() >= set(wanted):
        with (
            resumption.opened(path, head, *_work(wanted), lost=lambda record: False, what="calibration") as log,
            pool.Workers(perform, jobs, LIMIT, group=_engine, home=engines.home) as workers,
            progress("members", sum(one.last - one.first for one in wanted), quiet) as advance,
        ):
            for asked in done.keys() - dict(map(_read, log.records)).keys():  # of a calibration with fewer members
                log.add(record(asked, done[asked]))
            for asked in done.keys() & set(wanted):
                advance(asked.kind, asked.last - asked.first)
            for asked, answer in workers.map([one for one in wanted if one not in done]):
                done[asked] = answer if isinstance(answer, list) else []
                log.add(record(asked, done[asked]))
                advance(asked.kind, asked.last - asked.first)
    return {
        kind: [one for asked in wanted if asked.kind == kind for one in done[asked] if is_known(kind, one)] for kind in KINDS
    }


def _kept(path: Path, head: Header, wanted: Sequence[Portion]) -> dict[Portion, list[Measured]]:
    """Return what a folder has of the same members, also of a calibration with fewer or more of them."""
    try:
        contents = journal.read(path)
    except BadJournal:  # there is none yet
        return {}
    return dict(map(_read, contents.records)) if contents.header.get("identity") == identity(head, wanted) else {}


def _work(wanted: Sequence[Portion]) -> tuple[object, ...]:
    return "calibration", wanted[0].engine, wanted[0].seed


def identity(head: Header, wanted: Sequence[Portion]) -> str:
    """Return the digest of all that determines what is measured of a member: the versions, the engine, and the seed."""
    return resumption.identity(resumption.versions(head), *_work(wanted))


def record(asked: Portion, measured: Sequence[Measured]) -> journal.Record:
    """Return the record of a portion."""
    return {"record": "portion", "portion": asdict(asked), "measured": [asdict(one) for one in measured]}


def _read(record: journal.Record) -> tuple[Portion, list[Measured]]:
    return typed(Portion, record["portion"]), typed(list[Measured], record["measured"])


def printed(
    names: tuple[str, ...], count: int | None, seed: int, jobs: int, folder: Path | None, *, json: bool, quiet: bool
) -> int:
    """Measure and print the coverage of the shipped factors; with the seed of the factors, print the factors to ship.

    Parameters
    ----------
    names
        The engine; MuJoCo if none is named.
    count
        The number of members of each class; None for those of the documentation.
    seed, jobs
        The seed of the members, and the number of processes.
    folder
        The folder for what is measured, from which an interrupted measurement is resumed.
    json, quiet
        Whether the factors are printed as JSON, and nothing else.

    Returns
    -------
    int
        The exit code: 1 if the coverage of a class is less than it should be.
    """
    if count is not None and count < 1:
        raise BadInput(f"--members {count}: must be at least 1")
    known = load_engines(names or ("mujoco",))
    (engine, record), *_ = known.records.items()
    head = campaign.header(_command(engine, count, seed), known.records, known.missing)
    with temporary_folder() as unkept:
        seen = samples(portions(engine, seed, count), folder or unkept, head, jobs, quiet)
    rows = {kind: _judged(kind, seen[kind], record, seed, " ".join(_command(engine, count, seed))) for kind in KINDS}
    if json:
        terminal.print_json({kind: asdict(one) for kind, one in rows.items()})
    elif not quiet:
        for kind, one in rows.items():
            say(_told(kind, one, seed))
    return int(any(one.sample and not one.holds(kind) for kind, one in rows.items()))


def _judged(kind: Kind, seen: Sequence[Measured], record: Engine, seed: int, command: str) -> Factor:
    """Return the factor to ship if the members are those that set it, else the coverage of the shipped one."""
    named = in_words(record.name, record.version)
    if seed == SEED_OF_FACTORS:
        return smallest(kind, named, seen)
    measured = factor_of(named, seen, factors.factors()[kind].factor)
    return Factor(**{**asdict(measured), "command": command})


def _command(engine: str, count: int | None, seed: int) -> list[str]:
    """Return the words of the command that measures this."""
    of_engine = [] if engine == "mujoco" else ["--engine", engine]
    return [
        "bodycheck",
        "estimate",
        *of_engine,
        "--calibrate",
        *([] if count is None else ["--members", str(count)]),
        "--seed",
        str(seed),
    ]


def _told(kind: Kind, one: Factor, seed: int) -> str:
    refused = f"{one.refused:,} runs have no estimate"
    if not one.sample:
        return f"{kind}: {refused}"
    if seed == SEED_OF_FACTORS:
        return f"{kind}: these members set the factor {one.factor:g}, which {one.told}; {refused}"
    return f"{kind}: the shipped factor {one.factor:g} {one.told}; {refused}"
