"""Trials of case files: what is loaded is a case or has faults, and a case has a truth or a reason why it has none."""

import random
import re
import resource
import time
from pathlib import Path

from bodycheck import Case, CaseFaults, load
from bodycheck.casefile.case import parse
from bodycheck.errors import BadInput
from bodycheck.reference.errors import NotModelled, OutOfReach
from bodycheck.running import truths
from bodycheck.studies.ensemble.drawing import members
from tests.adversary import case_files
from tests.support.mutants import wrong

#: What loading a file may take: processor time (s) and memory (MiB).
LOADING_S, LOADING_MIB = 1.0, 200.0

#: Members that are made of a case with an ensemble, and the processor time (s) that they may take.
MEMBERS, DRAWING_S = 5, 2.0

#: What the truth of a case may take of processor time (s), at the instants of its file.
TRUTH_S = 60.0


def truth_of_a_file(seed: int, folder: Path) -> str:
    """What is wrong with loading the file of a seed, or with the truth of its case."""
    path, content = folder / "hostile.case.toml", case_files.drawn(seed)
    path.write_bytes(content)
    start, before = time.process_time(), _peak()
    try:
        case = load(path)
    except CaseFaults as error:
        case, problem = None, wrong(path, content, error)
    else:
        problem = ""
    taken, grown = time.process_time() - start, _peak() - before
    if taken > LOADING_S or grown > LOADING_MIB:
        return f"loading took {taken:.2f} s and {grown:.0f} MiB"
    return problem or ("" if case is None else _members(case, random.Random(seed)) or _truth(case))


def _members(case: Case, chance: random.Random) -> str:
    """What is wrong with some members of the case, if it has an ensemble: each is a case, or refused by its number and key."""
    if case.ensemble is None:
        return ""
    start, before = time.process_time(), _peak()
    source = members.drawn(case)
    first = chance.choice([0, source.size // 2, max(0, source.size - MEMBERS)])
    count = min(MEMBERS, source.size - first)
    try:
        made = members.scenes(case, source.values(first, count), first)
        text = members.text(case, source, first)
    except BadInput as error:
        named = re.fullmatch(rf"{case.name}: member (\d+): .+", str(error))
        problem = "" if named and first <= int(named[1]) < first + count else f"a fault that names no member: {error!r}"
    else:
        alone = parse(text, f"{case.name}-{first}")
        problem = "" if len(made) == count and alone.ensemble is None else f"made {len(made)} members of {count}"
    taken, grown = time.process_time() - start, _peak() - before
    if taken > DRAWING_S or grown > LOADING_MIB:
        return f"making {count} members took {taken:.2f} s and {grown:.0f} MiB"
    return problem


def _truth(case: Case) -> str:
    start = time.process_time()
    try:
        truths.truth(case)
    except (NotModelled, OutOfReach) as error:
        if not str(error) or "\n" in str(error):
            return f"a reason that is no line: {error!r}"
    taken = time.process_time() - start
    return f"its truth took {taken:.1f} s" if taken > TRUTH_S else ""


def _peak() -> float:
    """The most memory that the process has held, in MiB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
