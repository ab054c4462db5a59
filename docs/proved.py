"""Print which truths of shipped cases are proved, cross-checked or estimated. Run: python docs/proved.py [--limit 60]

The truth of each case is computed at its own instants, and in flight and on one joint at 1001 instants. The word is that of
`bodycheck truth CASE --certify`. For a proof, the table has the largest distance of a printed attitude from the exact one, the
radius of the balls before rounding, and the time of the proof; otherwise the reason why there is none.
"""

import argparse
from collections import Counter
from collections.abc import Iterator

import numpy as np

from bodycheck.casefile.case import load, shipped
from bodycheck.casefile.content import Case
from bodycheck.reference.candidate import candidate_of
from bodycheck.reference.errors import NotModelled, OutOfReach
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.proof.enclosure import Enclosure, NotEnclosed
from bodycheck.reference.proof.one_joint import has_one_joint
from bodycheck.reference.proof.proving import enclosed
from bodycheck.reference.truth import truth

HEAD = "| case | word | until, s | attitude within, rad | radius | proof | s |\n| --- | --- | --- | --- | --- | --- | ---: |"


def row(case: Case, limit: float) -> tuple[str, str]:
    """Return the word of a case and its row."""
    scene = case.scene
    many = not isinstance(scene, Mechanism) or has_one_joint(scene)
    instants = np.linspace(0.0, case.duration, 1001) if many else case.instants
    try:
        found = truth(scene, instants)
    except (NotModelled, OutOfReach) as reason:
        return "no truth", f"| {case.name} | no truth: {reason} | | | | | |"
    try:
        proof: Enclosure = enclosed(scene, found.trajectory, found.joints, candidate_of(scene), limit)
    except NotEnclosed as why:
        word = "cross-checked" if found.witnesses else "estimated"
        return word, f"| {case.name} | {word} | | | | no: {why} | |"
    until = "" if proof.until is None else f"{proof.until:.3g}"
    word = "enclosed" if proof.until is None else "enclosed in part"
    cells = (case.name, word, until, f"{proof.distance:.1e}", f"{proof.radius:.0e}", f"{proof.way}, {proof.bits} bits")
    return word, f"| {' | '.join(cells)} | {proof.seconds:.2f} |"


def table(limit: float) -> Iterator[str]:
    """Yield the lines of the table, and at last the number of cases of each word."""
    yield HEAD
    words: Counter[str] = Counter()
    for name in shipped():
        word, line = row(load(name), limit)
        words[word] += 1
        yield line
    yield "\n" + ", ".join(f"{word}: {count}" for word, count in words.most_common())


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--limit", type=float, default=60.0, help="time limit of each proof (s)")
    for line in table(parser.parse_args().limit):
        print(line, flush=True)


if __name__ == "__main__":
    main()
