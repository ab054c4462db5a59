"""Print the tables of docs/driven.md: the shipped driven cases in each engine.

Run: python docs/driven_engines.py [ENGINE …]

The first table has the largest error of a joint (rad or m) within a case at 1 ms, and the second the law that the motion of a
joint equals.
"""

import argparse
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import bodycheck
from bodycheck.adapters import registry
from bodycheck.casefile.case import load, shipped
from bodycheck.judging.judgement import Verdict
from bodycheck.results.outcome import Completed, Unsupported

#: The methods of each engine: the most accurate one, and the best ones with stops where that has none.
METHODS = {
    "mujoco": ("RK4",),
    "pinocchio": ("rk4",),
    "drake": ("runge_kutta3", "lagged"),
    "pybullet": ("multibody",),
    "simbody": ("RungeKuttaMerson",),
    "dart": ("semi-implicit-euler",),
    "sapien": ("TGS",),
    "exudyn": ("RK44", "GeneralizedAlpha"),
    "mjx": ("RK4",),
    "mjx32": ("RK4",),
    "mujoco_warp": ("RK4",),
    "newton": ("MuJoCo-rk4", "Featherstone", "Steel", "XPBD"),
    "brax": ("generalized",),
}

#: The time step (s), and the tag of the cases.
STEP, TAG = 0.001, "driven"

#: The figures that are errors of joints.
ERRORS = ("joint_position_error", "joint_slide_error")


def verdicts(engine: str, cases: Sequence[str]) -> Mapping[tuple[str, str], Verdict]:
    """Return the verdicts of an engine on cases, by the name of the method and the case."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "results"
        results = bodycheck.run(cases, engine=engine, integrator=METHODS[engine], timestep=STEP, out=out, allow_missing=True)
        return {(verdict.run.method.name, verdict.run.case): verdict for verdict in results.verdicts}


def error(verdict: Verdict) -> str:
    """Return the largest error of a joint with one digit, or how a run ended; a dash for what the engine does not model."""
    status = verdict.run.outcome.status
    if status != Completed.status or verdict.discrepancy is None:
        return "–" if status == Unsupported.status else status
    maxima = verdict.discrepancy.maxima()
    return f"{max(maxima[name] for name in ERRORS if name in maxima):.0e}"


def table(head: Sequence[str], rows: Iterator[Sequence[str]]) -> str:
    """Return a table in Markdown."""
    return "\n".join(f"| {' | '.join(cells)} |" for cells in (head, ["---"] * len(head), *rows))


def main(arguments: list[str] | None = None) -> None:
    """Print the two tables for some engines."""
    parser = argparse.ArgumentParser(description="Print the tables of shipped cases in docs/driven.md.")
    parser.add_argument("engines", nargs="*", metavar="ENGINE", help="engines; all that are installed, without any")
    asked = parser.parse_args(arguments).engines or [name for name in registry.names() if name in METHODS]
    cases = [case.name for case in map(load, shipped()) if TAG in case.tags]
    by_method = {
        (engine, method): [of_engine[method, case] for case in cases]
        for engine in asked
        for of_engine in [verdicts(engine, cases)]
        for method in METHODS[engine]
    }
    head = [f"{engine} {method}" for engine, method in by_method]
    columns = list(by_method.values())
    rows = ([f"`{case}`", *(error(of_method[index]) for of_method in columns)] for index, case in enumerate(cases))
    print(table(["case", *head], rows))
    told = [index for index in range(len(cases)) if any(of_method[index].control_law for of_method in columns)]
    laws = ([f"`{cases[index]}`", *(of_method[index].control_law or "–" for of_method in columns)] for index in told)
    print("\n" + table(["case", *head], laws))


if __name__ == "__main__":
    main()
