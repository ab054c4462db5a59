"""The header of an ensemble, `header.json`: what was run, with which versions, and whether it is complete.

It also shows whether a folder has results of the same work: its identity is a digest of everything that determines the rows.
"""

import json
from collections.abc import Mapping, Sequence
from datetime import UTC, date, datetime
from pathlib import Path
from typing import Any, TypedDict, cast

from bodycheck.adapters.method import Method
from bodycheck.casefile.case import Case, parse_stored
from bodycheck.casefile.distributions import Ensemble
from bodycheck.casefile.finding import SUFFIX
from bodycheck.errors import BadFolder
from bodycheck.figures.revisions import REVISIONS
from bodycheck.files import reading, writing
from bodycheck.results import records, resumption
from bodycheck.results.header import Header
from bodycheck.results.origin import BESIDE
from bodycheck.running.members import chunk_files, chunks, compaction
from bodycheck.running.members.chunks import Share, Source
from bodycheck.studies.ensemble.rows import DEPENDENCES, ROWS

#: The name of the file, and the version of the format of the folder.
FILE, FORMAT = "header.json", 1

#: The folder of the worst members as case files.
WORST = "worst"

#: The files that are made when all members are there: of an earlier ensemble, they would contradict the header of a new one.
MADE = (
    *(name for table in (ROWS, DEPENDENCES) for name in (table.file, f"{table.file}{BESIDE}")),
    *("report.html", "report.md"),
)

#: The largest size of a header in bytes.
MAX_BYTES = 1 << 24


class StoredMethod(TypedDict):
    """A method: its spelling and its time step (s)."""

    integrator: str
    timestep: float


class StoredShare(TypedDict):
    """The share of an engine in an ensemble, as `bodycheck.running.members.chunks.Share`."""

    engine: str
    version: str
    methods: list[StoredMethod]
    truths_of: list[float]


class EnsembleHeader(Header):
    """The header of an ensemble, with the keys that the header of every set of results has.

    Attributes
    ----------
    format, identity
        The version of the format, and the digest of everything that determines the rows.
    case, text
        The name of the case and the text of its file.
    members, drawn
        The number of members, and the names of the numbers in which they differ.
    source
        The source of the drawn numbers, in words.
    shares
        The engines with their methods, in the order of the rows.
    block, sample
        The number of members that are treated at once, and the interval between members whose trajectories are kept.
    limit, memory
        The time limit (s) and the memory limit (bytes) of one call.
    today
        The date that decides whether known discrepancies are still tolerated.
    revisions
        The revisions of the figures whose definition ever changed.
    complete
        Whether all members were run, and the tables are compacted.
    """

    format: int
    identity: str
    case: str
    text: str
    members: int
    drawn: list[str]
    source: str
    shares: list[StoredShare]
    block: int
    sample: int
    limit: float
    memory: int
    today: str
    revisions: dict[str, int]
    complete: bool


def of(
    head: Header, case: Case, source: Source, shares: Sequence[Share], limit: float, memory: int, samples: int
) -> EnsembleHeader:
    """Return the header of an ensemble that is not complete.

    head: the header that every set of results has. samples: the number of members whose trajectories are kept. The other
    parameters are those of `study.run`.
    """
    block = chunks.block_size(case, [method.timestep for share in shares for method in share.methods])
    stored = [_stored(share) for share in shares]
    depends = (FORMAT, head["bodycheck"], head["packages"], case.text, _told(source), stored, block, limit, memory)
    return {
        **head,
        "format": FORMAT,
        "identity": resumption.identity(*depends),
        "case": case.name,
        "text": case.text,
        "members": source.size,
        "drawn": list(source.names),
        "source": in_words(source),
        "shares": stored,
        "block": block,
        "sample": max(1, source.size // samples),
        "limit": limit,
        "memory": memory,
        "today": datetime.now(UTC).date().isoformat(),
        "revisions": dict(REVISIONS),
        "complete": False,
    }


def _told(source: Source) -> str:
    """Return a text of all that the members depend on: how they are drawn, or the digest of their table, whatever its path."""
    origin = source.origin
    return repr((source.size, tuple(source.names), getattr(origin, "digest", None) or repr(origin)))


def in_words(source: Source) -> str:
    """Return the source of the numbers of members in words."""
    origin = source.origin
    return f"seed {origin.seed}" if isinstance(origin, Ensemble) else f"the table {getattr(origin, 'path', '')}"


def begin(folder: Path, head: EnsembleHeader, case: Case) -> EnsembleHeader:
    """Write the header and the case of an ensemble into a folder, and return the header.

    If the same work was interrupted in the folder, its header is kept and returned. Other results of the case are removed.
    Raises `BadFolder` for a folder with other files, or with an ensemble of another case.
    """
    names = set(reading.names_in(folder)) - {f"{FILE}.lock"}
    if names and FILE not in names:
        raise BadFolder(f"{folder}: contains files that are not results of an ensemble; give an empty or a new folder")
    reading.refuse_links(folder)
    earlier = read(folder) if names else None
    if earlier is not None and earlier["identity"] == head["identity"] and not earlier["complete"]:
        head = earlier
    elif earlier is not None and earlier["case"] != head["case"]:
        raise BadFolder(f"{folder}: has the ensemble of the case {earlier['case']}; give an empty or a new folder")
    else:
        _replace(folder, head)
    writing.write(folder / f"{case.name}{SUFFIX}", case.text.encode("utf-8"), folder)
    return head


def _replace(folder: Path, head: EnsembleHeader) -> None:
    """Remove the results of another ensemble of the case, and write the header of a new one."""
    for kind in (*chunk_files.KINDS, chunk_files.CHUNKS, WORST):
        compaction.remove(folder / kind, folder)
    with writing.failing(folder):
        for name in MADE:
            (folder / name).unlink(missing_ok=True)
    write(folder, head)


def write(folder: Path, head: EnsembleHeader) -> None:
    """Write the header of an ensemble. Raises `NotWritten`."""
    writing.write(folder / FILE, (json.dumps(head, ensure_ascii=True, indent=1) + "\n").encode("ascii"), folder)


def read(folder: Path) -> EnsembleHeader:
    """Return the header of an ensemble. Raises `BadFolder` if it is missing or damaged."""
    try:
        header: Any = json.loads(reading.content(folder / FILE, MAX_BYTES))
        if not isinstance(header, dict):
            raise ValueError(f"read {header!r:.60}; allowed: an object")
        if header.get("format") != FORMAT:
            raise ValueError(f"its format is {header.get('format')!r:.60}, not {FORMAT}")
        records.typed(records.HeaderRecord, header)
        for name, kind in EnsembleHeader.__annotations__.items():
            _check(name, kind, header)
        date.fromisoformat(header["today"])
        for share in header["shares"]:
            share_of(share)
        parse_stored(header["text"], header["case"])
    except FileNotFoundError as error:
        raise BadFolder(f"{folder}: not the results of an ensemble: it contains no {FILE}") from error
    except (OSError, ValueError, KeyError, TypeError, RecursionError) as error:
        raise BadFolder(f"{folder / FILE}: damaged: {error}") from error
    return cast(EnsembleHeader, header)


def _check(name: str, kind: Any, header: Mapping[str, Any]) -> None:
    simple: dict[Any, Any] = {int: int, str: str, float: (int, float), bool: bool}
    wanted = simple.get(kind)
    if wanted is not None and not isinstance(header[name], wanted):
        raise ValueError(f"{name} is {header[name]!r:.60}")


def _stored(share: Share) -> StoredShare:
    methods: list[StoredMethod] = [{"integrator": method.name, "timestep": method.timestep} for method in share.methods]
    return {"engine": share.engine, "version": share.version, "methods": methods, "truths_of": list(share.truths_of)}


def share_of(stored: StoredShare) -> Share:
    """Return the share of an engine. Raises `ValueError`, `KeyError` or `TypeError` if it is damaged."""
    methods = tuple(Method.parse(str(one["integrator"]), float(one["timestep"])) for one in stored["methods"])
    return Share(str(stored["engine"]), str(stored["version"]), methods, tuple(map(float, stored["truths_of"])))
