"""Print the tables of docs/accuracy.md on methods with error control. Run: python docs/accuracy.py [ENGINE ...]

The tables are made from a run of `bodycheck run` with all methods with error control of the named engines, or of all installed
engines, at several accuracies, each with the engine's own largest step.
"""

import sys
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import bodycheck
from bodycheck.adapters.contract import Engine
from bodycheck.console.arguments import load_engines

CASE = "intermediate-axis-flip"
ACCURACIES = ("1e-2", "1e-3", "1e-4", "1e-6", "1e-8", "1e-10")

#: Accuracies of integrators of first order, whose runs at smaller ones take minutes.
ACCURACIES_OF_ORDER_1 = ("1e-2", "1e-3", "1e-4", "1e-6")


def spellings(engine: Engine) -> Iterator[str]:
    """Yield the methods with error control of an engine."""
    for integrator in engine.integrators:
        if "accuracy" in integrator.options and "flight" in integrator.kinds:
            low = integrator.order is not None and integrator.order <= 1
            yield from (f"{integrator.name}:accuracy={each}" for each in (ACCURACIES_OF_ORDER_1 if low else ACCURACIES))


def line(row: dict[str, Any]) -> str:
    """Return the row of a run as a row of a table in Markdown."""
    integrator, _, accuracy = row["integrator"].partition(":accuracy=")
    error = row["attitude_error"]
    shown = row["status"] if error is None else f"{error:.2g}"
    counts = ("–" if row[name] is None else f"{row[name]:,}" for name in ("steps_taken", "steps_rejected", "evaluations"))
    return f"| {row['engine']} | {integrator} | {float(accuracy):.0e} | {shown} | {' | '.join(counts)} |".replace("e-0", "e-")


def main() -> None:
    """Print a table with a row for each method and accuracy."""
    records = load_engines(sys.argv[1:]).records
    methods = {name: list(spellings(record)) for name, record in records.items()}
    print("| engine | integrator | accuracy | attitude error, rad | steps | rejected | evaluations |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for name, own in methods.items():
        if not own:
            continue
        with TemporaryDirectory() as folder:
            results = bodycheck.run(CASE, engine=name, integrator=own, out=Path(folder) / "results")
        for row in results.tables["results"].rows:
            print(line(row))


if __name__ == "__main__":
    main()
