"""The results for a model in sentences that the terminal and the report share."""

from collections import Counter, defaultdict
from collections.abc import Sequence

from bodycheck.reports.quantities import count, listing, verb
from bodycheck.studies.parity.quantities import FILE, MODEL, Cause, Quantity, Status
from bodycheck.studies.parity.rows import ParityRow, failed, is_compared
from bodycheck.studies.parity.study import Parity

#: The words for each cause, which the subjects follow.
SAYS: dict[Cause, str] = {
    "armature": "armature differs",
    "inertia-turned": "inertia about other axes",
    "inertia-dropped": "inertia dropped, wholly or its products",
    "inertia-fused": "inertia of welded links put together wrongly",
    "inertia-balanced": "inertia changed to one that a body can have",
    "mass": "mass differs",
    "center-of-mass": "centre of mass differs",
    "damping-ignored": "damping ignored",
    "friction-ignored": "friction ignored",
    "mimic-ignored": "mimic ignored",
    "mimic-inverted": "mimic with leader and follower exchanged",
    "limits-ignored": "limits ignored",
    "frame": "frame or axis elsewhere",
    "coordinate-order": "coordinates in another order than told",
    "representation": "represented otherwise",
    "base-welded": "base welded to the world",
    "unexplained": "unexplained",
}

#: What an engine does in which each cause is found, as a predicate.
DOES: dict[Cause, str] = {
    "armature": "has another armature",
    "inertia-turned": "has an inertia about other axes",
    "inertia-dropped": "drops an inertia, wholly or its products",
    "inertia-fused": "puts the inertia of welded links together wrongly",
    "inertia-balanced": "changes an inertia to one that a body can have",
    "mass": "has another mass",
    "center-of-mass": "has another centre of mass",
    "damping-ignored": "ignores damping",
    "friction-ignored": "ignores friction",
    "mimic-ignored": "ignores mimic",
    "mimic-inverted": "exchanges leader and follower of a mimic",
    "limits-ignored": "ignores limits",
    "frame": "has a frame or an axis elsewhere",
    "coordinate-order": "has coordinates in another order than it tells",
    "representation": "represents the robot otherwise",
    "base-welded": "welds the base to the world",
    "unexplained": "differs for an unknown reason",
}

#: What an engine does that has no reading of a file, as a predicate before the reason, by the status of its row.
NO_READING: dict[Status, str] = {
    "refused": "refuses the file: ",
    "not-modelled": "does not read it: ",
    "crashed": "crashes on the file: ",
    "timeout": "does not finish the file: ",
    "adapter-fault": "has no reading: ",
}

#: The readings without an answer as nouns, by the status of their rows.
NO_ANSWER: dict[Status, tuple[str, str]] = {
    "crashed": ("crash", "crashes"),
    "timeout": ("reading that took too long", "readings that took too long"),
    "adapter-fault": ("fault of an adapter", "faults of adapters"),
}

#: The quantities of links that an engine may not report.
OF_LINKS: tuple[Quantity, ...] = ("mass", "center_of_mass", "inertia", "parent")

#: The most subjects that a sentence names.
MOST = 4


def name_of(quantity: Quantity | None) -> str:
    """Return the name of a quantity as words."""
    return "" if quantity is None else quantity.replace("_", " ")


def engines_of(parity: Parity) -> dict[str, list[ParityRow]]:
    """Return the rows of each engine, in the order of the study, without the rows about the file."""
    by_engine: dict[str, list[ParityRow]] = defaultdict(list)
    for row in parity.rows:
        if row.engine != FILE:
            by_engine[row.engine].append(row)
    return by_engine


def differs(parity: Parity) -> bool:
    """Return whether anything differs, is refused, or could not be read or compared."""
    return any(map(failed, parity.rows))


def of_file(parity: Parity) -> tuple[str, ...]:
    """Return the faults of the file itself, each after the name of the link or joint that has it."""
    file_rows = (row for row in parity.rows if row.engine == FILE)
    return tuple(row.engine_value if row.subject == MODEL else f"{row.subject}: {row.engine_value}" for row in file_rows)


def of_engine(rows: Sequence[ParityRow]) -> tuple[str, ...]:
    """Return the verdict on an engine and then its differences, as clauses without a subject."""
    refusal = next((row for row in rows if row.quantity is None), None)
    if refusal is not None:
        does = NO_READING.get(refusal.status, "reads it all the same: ")
        return (f"{does}{refusal.engine_value.rstrip('.')}",)
    sentences = [f"{SAYS[cause]}: {_subjects(same_cause)}" for cause, same_cause in _by_cause(rows).items()]
    accepted = list(dict.fromkeys(row.subject for row in rows if row.status == "accepted-unphysical"))
    missing = list(dict.fromkeys(row.subject for row in rows if row.status == "not-modelled" and row.quantity == "joint_type"))
    more = [f"accepts what cannot be: {listing(accepted, MOST, 'subject')}"] if accepted else []
    more += [f"does not model: {listing(missing, MOST, 'joint')}"] if missing else []
    more += _unreported(rows)
    if not any(map(is_compared, rows)):
        return ("nothing was compared", *more)
    if not sentences:
        return (f"agrees{_largest(rows)}", *more)
    return ("differs", *sentences, *more)


def of_engine_counted(rows: Sequence[ParityRow]) -> tuple[str, ...]:
    """Return the clauses of `of_engine`, with the number of compared quantities in the verdict; for all rows of a study."""
    verdict, *more = of_engine(rows)
    compared = sum(map(is_compared, rows))
    return (f"{verdict}, {count(compared, 'quantity', 'quantities')} compared" if compared else verdict, *more)


def _unreported(rows: Sequence[ParityRow]) -> list[str]:
    """Return a clause with the links about which an engine does not report everything; none if there is no such link."""
    links: dict[str, list[str]] = defaultdict(list)
    for row in rows:
        if row.status == "not-modelled" and row.quantity in OF_LINKS and row.subject != MODEL:
            links[row.subject].append(name_of(row.quantity))
    entries = [f"{link} ({listing(quantities)})" for link, quantities in links.items()]
    return [f"does not report: {listing(entries, MOST, 'link')}"] if entries else []


def brief(rows: Sequence[ParityRow]) -> str:
    """Return what differs in an engine in few words, as a predicate: its causes, each with the number of links and joints."""
    sentences = of_engine(rows)
    if len(sentences) == 1:
        return sentences[0]
    causes = _by_cause(rows)
    causes_in_words = [
        f"{DOES[cause]} ({_number(same_cause)} times)" if _number(same_cause) > 1 else DOES[cause]
        for cause, same_cause in causes.items()
    ]
    return listing(causes_in_words) or sentences[0]


def _number(rows: Sequence[ParityRow]) -> int:
    return len({row.subject for row in rows})


def unreadable(parity: Parity) -> bool:
    """Return whether the file of a model cannot be read."""
    return any(row.status == "unreadable" for row in parity.rows)


def headline(models: Sequence[Parity]) -> str:
    """Return the verdict on all models: what differs, and how many readings and files gave no answer."""
    readable = [one for one in models if not unreadable(one)]
    parts = [_of_readable(readable)] if readable else []
    statuses = Counter(row.status for one in readable for row in one.rows)
    amounts = [count(statuses[status], *nouns) for status, nouns in NO_ANSWER.items() if statuses[status]]
    if amounts:
        parts.append(f"there {verb(sum(statuses[status] for status in NO_ANSWER), 'was', 'were')} {listing(amounts)}")
    if missing := len(models) - len(readable):
        parts.append(f"{count(missing, 'file')} cannot be read")
    return "; ".join(parts)


def _of_readable(models: Sequence[Parity]) -> str:
    different = [one for one in models if differs(one)]
    if not different:
        return f"{count(len(models), 'robot')}: all agree" if len(models) > 1 else f"{models[0].name}: all agree"
    robots = f"{len(different)} of {count(len(models), 'robot')} {verb(len(different), 'is', 'are')}"
    where = f"{'for example ' if len(different) > 1 else ''}in {different[0].name}"
    return f"{robots} not read as the file says: {where}, {_shortest(different[0])}"


def _shortest(parity: Parity) -> str:
    for engine, rows in engines_of(parity).items():
        if any(map(failed, rows)):
            return f"{engine} {brief(rows)}"
    return f"the file has {count(len(of_file(parity)), 'fault')}"


def _by_cause(rows: Sequence[ParityRow]) -> dict[Cause, list[ParityRow]]:
    """Return the differing rows by cause. Rows about the whole model are left out if other rows have the cause.

    All rows without an explanation are kept.
    """
    causes: dict[Cause, list[ParityRow]] = defaultdict(list)
    for row in rows:
        if row.status == "differs":
            causes[row.cause].append(row)
    return {
        cause: [row for row in same_cause if row.subject != MODEL] or same_cause if cause != "unexplained" else same_cause
        for cause, same_cause in causes.items()
    }


def _subjects(rows: Sequence[ParityRow]) -> str:
    """Return the subjects of rows as a list; a single subject is followed by the values of both sides."""
    if len(rows) == 1 and rows[0].subject != MODEL:
        (row,) = rows
        return f"{row.subject} ({name_of(row.quantity)} {row.engine_value or 'none'} instead of {row.truth_value or 'none'})"
    names = dict.fromkeys(name_of(row.quantity) if row.subject == MODEL else row.subject for row in rows)
    return listing(list(names), MOST, "subject")


def _largest(rows: Sequence[ParityRow]) -> str:
    """Return the largest relative difference among agreeing rows, as the end of a sentence."""
    known = [row for row in rows if row.relative is not None and row.status == "agrees"]
    if not known:
        return ""
    worst = max(known, key=lambda row: row.relative or 0.0)
    return f" to {worst.relative:.1e} ({name_of(worst.quantity)})" if worst.relative else " to the last bit"
