"""Print the table of docs/contacts.md on all engines: the scenes with touching bodies, each by the default method of an engine.

Run: python docs/contact_engines.py [ENGINE ...]

A cell is the largest error of the position (m), at the time step that is the engine's own default, or a number of a reason
below the table. Engines without a default method run at 2 ms.
"""

import argparse
import tempfile
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

import bodycheck
from bodycheck.adapters import registry
from bodycheck.casefile.case import load, shipped
from bodycheck.errors import BadInput
from bodycheck.judging.judgement import Verdict
from bodycheck.reference.requirements import touches
from bodycheck.results.outcome import Completed

#: The method of engines that have no default, and its time step (s).
METHODS, STEP = {"pinocchio": "admm"}, 0.002


def verdicts(engines: Sequence[str], cases: Sequence[str]) -> dict[tuple[str, str], Verdict]:
    """Return the verdicts of engines on cases, by the names of engine and case. Engines share the truths of their runs."""
    usual = [engine for engine in engines if engine not in METHODS]
    own = [([engine], {"integrator": METHODS[engine], "timestep": STEP}) for engine in engines if engine in METHODS]
    found = {}
    for names, asked in (*own, (usual, {"integrator": "default"})):
        with tempfile.TemporaryDirectory() as folder, suppress(BadInput):  # no engine has a method for any of the scenes
            results = bodycheck.run(cases, engine=names, out=Path(folder) / "results", allow_missing=True, **asked)  # type: ignore[arg-type]
            found |= {(verdict.run.engine, verdict.run.case): verdict for verdict in results.verdicts}
    return found


def cell(verdict: Verdict | None, reasons: dict[str, int]) -> str:
    """Return the largest error of the position, or a number for the reason why there is none."""
    if verdict is None:
        return f"[{reasons.setdefault('its adapter gives it no bodies that touch', len(reasons) + 1)}]"
    outcome = verdict.run.outcome
    if isinstance(outcome, Completed) and verdict.discrepancy is not None:
        return f"{verdict.discrepancy.maxima()['position_error']:.1e}"
    reason = outcome.reason.removeprefix(f"{verdict.run.engine} {verdict.run.version} ")
    return f"[{reasons.setdefault(f'{outcome.status}: {reason}', len(reasons) + 1)}]"


def main() -> None:
    """Print the table and the reasons."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("engines", nargs="*", metavar="ENGINE", help="engines; all with an adapter, without any")
    engines = parser.parse_args().engines or list(registry.names())
    cases = [case.name for case in map(load, shipped()) if touches(case.scene)]
    reasons: dict[str, int] = {}
    found = verdicts(engines, cases)
    print(f"| scene | {' | '.join(engines)} |\n| --- |{' --- |' * len(engines)}")
    for name in cases:
        print(f"| {name} | {' | '.join(cell(found.get((engine, name)), reasons) for engine in engines)} |")
    print()
    for reason, number in reasons.items():
        print(f"{number}. {reason}")


if __name__ == "__main__":
    main()
