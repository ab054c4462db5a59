"""Prove the truths of shipped cases, keep the certificates beside the cases, and print their table.

Run: python docs/proved.py [CASE ...] [--limit 400] [--changed] [--table]

The truth of each case is computed at its own instants, and in flight and on one joint at 1001 instants. The word is that of
`bodycheck truth CASE --certify`. For a proof, the table has the largest distance of a printed attitude from the exact one, the
radius of the balls before rounding, and the time of the proof; otherwise the reason why there is none. Reports and the site
read the certificates. The time is that of the processor, without imports and the truth. The exit status is 1 if a truth is
contradicted by its proof; such a case has no certificate.
"""

import argparse
import json
import sys
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import asdict
from pathlib import Path

import numpy as np

from bodycheck.casefile.case import load, shipped
from bodycheck.casefile.content import Case
from bodycheck.casefile.identity import identity
from bodycheck.reference.candidate import candidate_of
from bodycheck.reference.certified import Certificate, proved
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.proof.enclosure import NotEnclosed
from bodycheck.reference.proof.one_joint import has_one_joint
from bodycheck.reference.proof.proving import enclosed
from bodycheck.reference.truth import truth
from bodycheck.running.certificates import FILE, Certified, certificates

HEAD = "| case | word | until, s | attitude within, rad | radius | proof | s |\n| --- | --- | --- | --- | --- | --- | ---: |"

#: The file of the certificates.
KEPT = Path(__file__).parents[1] / "cases" / FILE


def certified(case: Case, limit: float) -> tuple[Certified, tuple[str, ...]]:
    """Return the certificate of a case, and what contradicts its truth."""
    scene, content = case.scene, identity(case)
    many = not isinstance(scene, Mechanism) or has_one_joint(scene)
    instants = np.linspace(0.0, case.duration, 1001) if many else case.instants
    found = truth(scene, instants)
    try:
        proof = enclosed(scene, found.trajectory, found.joints, candidate_of(scene), limit)
    except NotEnclosed as why:
        return Certified(content, "cross-checked" if found.witnesses else "estimated", reason=str(why)), ()
    alone = Certificate(found, {}, np.zeros(1), 0, others=False, faults=(), growth=None)
    way, seconds = f"{proof.way}, {proof.bits} bits", round(proof.seconds, 2)
    distance, radius = (float(f"{value:.1e}") for value in (proof.distance, proof.radius))
    return Certified(content, "enclosed", proof.until, distance, radius, way, seconds), proved(alone, proof).faults


def table(known: Mapping[str, Certified]) -> Iterator[str]:
    """Yield the lines of the table, and at last the number of cases of each word."""
    yield HEAD
    words: Counter[str] = Counter()
    for name, each in known.items():
        word = each.word if each.until is None else f"{each.word} in part"
        words[word] += 1
        if each.distance is None:
            yield f"| {name} | {word} | | | | no: {each.reason} | |"
            continue
        until = "" if each.until is None else f"{each.until:.3g}"
        yield f"| {name} | {word} | {until} | {each.distance:.1e} | {each.radius:.0e} | {each.way} | {each.seconds:.2f} |"
    yield ""
    yield ", ".join(f"{word}: {count}" for word, count in words.most_common())


def keep(known: Mapping[str, Certified]) -> None:
    """Write the certificates of shipped cases, in the order of their names, without what they leave out."""
    empty = asdict(Certified("", ""))
    records = {
        name: {key: value for key, value in asdict(known[name]).items() if value != empty[key]}
        for name in shipped()
        if name in known
    }
    KEPT.write_text(json.dumps(records, indent=1) + "\n", encoding="utf-8")


def main() -> int:
    """Prove the cases, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("case", nargs="*", help="names of shipped cases; by default all of them")
    parser.add_argument("--limit", type=float, default=60.0, help="time limit of each proof (s)")
    parser.add_argument("--changed", action="store_true", help="prove the cases that are new or have another content")
    parser.add_argument("--table", action="store_true", help="prove nothing, print the table of the certificates")
    options = parser.parse_args()
    known = dict(certificates()) if KEPT.exists() else {}
    contradicted = []
    chosen = options.case or shipped()
    for name in () if options.table else chosen:
        case = load(name)
        if options.changed and name in known and known[name].identity == identity(case):
            continue
        known[name], faults = certified(case, options.limit)
        if faults:
            del known[name]
            contradicted.append(f"{name}: {'; '.join(faults)}")
        keep(known)
    print("\n".join(table({name: each for name, each in sorted(known.items()) if name in chosen})))
    print("\n".join(contradicted), file=sys.stderr)
    return int(bool(contradicted))


if __name__ == "__main__":
    sys.exit(main())
