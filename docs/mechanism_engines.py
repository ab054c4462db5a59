"""Print the tables of docs/mechanisms.md for the engines besides MuJoCo and Pinocchio.

Run: python docs/mechanism_engines.py [ENGINE …]

The first table says what the engines model. The second has what each method is off by on joints with parameters, and the third
on benchmarks and loops. Errors are those of joints (rad or m), at the smallest time step, the largest over all instants.

In the second table each error is followed by what is left of it for vanishing time steps: the joints' motions at three time
steps are extrapolated to zero (Richardson), and compared with the truth. What is left is none of the time step.
"""

import argparse
import math
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import bodycheck
from bodycheck.adapters import registry
from bodycheck.adapters.contract import Engine
from bodycheck.judging.judgement import Verdict
from bodycheck.reference.mechanisms.joint_types import JOINT_TYPES
from bodycheck.reference.mechanisms.kinematics import joints
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.trajectory import Array
from bodycheck.reference.truths import Truth
from bodycheck.results.outcome import Completed, Unsupported
from bodycheck.results.store import Results
from bodycheck.running import engines as known

#: The engines that have tables of their own.
OTHERS = ("mujoco", "pinocchio", "mjx32")

#: The parameters of joints, as the first table calls them, by the names of requirements.
PARAMETERS = {
    "armature": "armature",
    "joint damping": "damping",
    "joint springs": "springs",
    "joint friction": "dry friction",
    "joint efforts": "efforts",
    "loops": "loops",
    "point masses": "point masses",
    "massless bodies": "bodies without mass",
    "mimic joints": "mimic joints",
}

#: The cases of the second table, and its time steps (s), each half of the one before.
JOINT_CASES = (
    *("pendulum-large", "slider-spring", "spherical-pendulum"),
    *("hinge-armature", "hinge-damping", "oscillator-overdamped", "hinge-friction"),
)
STEPS = (0.004, 0.002, 0.001)

#: The cases of the third table, and its time steps.
BENCHMARKS = ("iftomm-a01", "iftomm-a01-rod", "heavy-top", "iftomm-a02-2", "slider-crank")
BENCHMARK_STEPS = (0.002, 0.001)

#: The figures that are errors of joints.
ERRORS = ("joint_position_error", "joint_slide_error")

#: Ratio of changes from step to step below which a motion does not converge.
CONVERGES = 1.3


@dataclass(frozen=True)
class Found:
    """The errors of a method on a case.

    Attributes
    ----------
    errors
        The largest errors of the joints (rad or m) at the time steps in order; NaN for a run that was not completed.
    left
        What is left for vanishing time steps; NaN where motions do not converge.
    apart, drift
        How far joints and loops came apart (m), and the relative drift of the energy, at the smallest step; None for none.
    status
        How the runs ended, where not all were completed.
    """

    errors: tuple[float, ...]
    left: float
    apart: float | None
    drift: float | None
    status: str

    @property
    def order(self) -> float | None:
        """The order of the error in the last two time steps, which are as 2 to 1; None where it is rounding or not known."""
        coarse, fine = self.errors[-2:]
        if not (math.isfinite(coarse) and fine > 1e-12):
            return None
        return math.log2(coarse / fine)


def models(records: Mapping[str, Engine]) -> Iterator[str]:
    """The rows of the first table."""
    yield "| engine | version | precision | joints | not modelled |"
    yield "| --- | --- | --- | --- | --- |"
    for name, record in records.items():
        own = [name for name, form in JOINT_TYPES.items() if form.effect in record.models]
        lacking = [text for effect, text in PARAMETERS.items() if effect not in record.models]
        types = "all types" if len(own) == len(JOINT_TYPES) else ", ".join(own)
        bits = {"float64": "double", "float32": "single"}[record.precision]
        yield f"| {name} | {record.version} | {bits} | {types} | {', '.join(lacking) or '–'} |"


def measured(engine: str, cases: Sequence[str], timesteps: Sequence[float]) -> dict[str, dict[str, Found]]:
    """Return the errors of each method of an engine, by the name of the method and the case."""
    with tempfile.TemporaryDirectory() as folder:
        results = bodycheck.run(cases, engine=engine, timestep=timesteps, out=Path(folder) / "results", allow_missing=True)
        found: dict[tuple[str, str], dict[float, Verdict]] = {}
        for verdict in results.verdicts:
            method = verdict.run.method
            found.setdefault((method.name, verdict.run.case), {})[method.timestep] = verdict
        made: dict[str, dict[str, Found]] = {}
        for (method, case), by_step in found.items():
            made.setdefault(method, {})[case] = _found(results.found.results, by_step, timesteps)
        return made


def _found(results: Results, by_step: Mapping[float, Verdict], timesteps: Sequence[float]) -> Found:
    seen = [_joints(results, by_step[step]) if step in by_step else None for step in timesteps]
    figures = [_figures(by_step.get(step)) for step in timesteps]
    errors = tuple(max((own[name] for name in ERRORS if name in own), default=math.nan) for own in figures)
    maxima = figures[-1]
    statuses = [by_step[step].run.outcome.status for step in timesteps if step in by_step]
    status = next((status for status in reversed(statuses) if status != Completed.status), "")
    left = math.nan
    if None not in seen and len(seen) == 3:
        coarse, middle, fine = (one[0] - one[1] for one in seen if one is not None)
        left = _extrapolated(coarse, middle, fine)
    return Found(errors, left, maxima.get("constraint_error"), maxima.get("energy_drift"), status)


def _figures(verdict: Verdict | None) -> Mapping[str, float]:
    return verdict.discrepancy.maxima() if verdict is not None and verdict.discrepancy is not None else {}


def _extrapolated(coarse: Array, middle: Array, fine: Array) -> float:
    """The largest error for vanishing time steps, from errors (n, c) at three steps of which each is half of the one before."""
    first, second = (float(np.abs(change).max()) for change in (coarse - middle, middle - fine))
    if second == 0 or first < CONVERGES * second:
        return float(np.abs(fine).max()) if second <= np.abs(fine).max() / 10 else math.nan
    return float(np.abs(fine + (fine - middle) / (first / second - 1)).max())


def _joints(results: Results, verdict: Verdict) -> tuple[Array, Array] | None:
    """The coordinates (n, c) of joints with angles or slides alone in a run and in its truth, or of attitudes as components.

    None where the run was not completed.
    """
    outcome, scene = verdict.run.outcome, results.cases[verdict.run.case].scene
    truth = results.truth(verdict.run.case, verdict.run.method.timestep)
    if not (isinstance(outcome, Completed) and isinstance(scene, Mechanism) and isinstance(truth, Truth)):
        return None
    moved, exact = (joints(scene, trajectory).position for trajectory in (outcome.trajectory, truth.trajectory))
    return (moved, exact) if len(moved) == len(exact) else None


def joint_rows(name: str, found: Mapping[str, Mapping[str, Found]]) -> Iterator[str]:
    """The rows of the second table for an engine."""
    yield from _rows(
        name, {method: [_joint_cell(by_case.get(case)) for case in JOINT_CASES] for method, by_case in found.items()}
    )


def benchmark_rows(name: str, found: Mapping[str, Mapping[str, Found]]) -> Iterator[str]:
    """The rows of the third table for an engine."""
    yield from _rows(
        name, {method: [_benchmark_cell(by_case.get(case)) for case in BENCHMARKS] for method, by_case in found.items()}
    )


def _rows(name: str, cells: Mapping[str, Sequence[str]]) -> Iterator[str]:
    """The rows of an engine from the cells of its methods, without empty ones and settings of the engine that change none."""
    for method, row in cells.items():
        plain = cells.get(method.removesuffix(":settings=engine"))
        if any(cell != "–" for cell in row) and (row is plain or row != plain):
            yield f"| {name} {method} | {' | '.join(row)} |"


def _joint_cell(found: Found | None) -> str:
    """Error, order and what is left for vanishing steps; a dash for what the engine does not model."""
    if found is None or found.status == Unsupported.status:
        return "–"
    if not math.isfinite(found.errors[-1]):
        return found.status
    order = f" ({told})" if (told := _order(found)) else ""
    return (
        f"{found.errors[-1]:.0e}{order}, {found.left:.0e}" if math.isfinite(found.left) else f"{found.errors[-1]:.0e}{order}, ?"
    )


def _order(found: Found) -> str:
    """The order with one decimal, without a minus before zero."""
    return "" if found.order is None else f"{round(found.order, 1) + 0.0:.1f}"


def _benchmark_cell(found: Found | None) -> str:
    if found is None or found.status == Unsupported.status:
        return "–"
    if not math.isfinite(found.errors[-1]):
        return found.status
    told = [f"{found.errors[-1]:.0e}"]
    told += [order] if (order := _order(found)) else []
    told += [f"apart {found.apart:.0e}"] if found.apart is not None and found.apart > 1e-12 else []
    return ", ".join(told)


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description="Print the tables of engines in docs/mechanisms.md.")
    parser.add_argument("engines", nargs="*", metavar="ENGINE", help="engines; all that are installed, without any")
    asked = parser.parse_args(arguments).engines or [name for name in registry.names() if name not in OTHERS]
    records, _ = known.describe(asked)
    records = {name: record for name, record in records.items() if "mechanisms" in record.models}
    print("\n".join(models(records)))
    for cases, steps, rows in ((JOINT_CASES, STEPS, joint_rows), (BENCHMARKS, BENCHMARK_STEPS, benchmark_rows)):
        print(f"\n| method | {' | '.join(cases)} |\n| --- {'| --- ' * len(cases)}|")
        for name in records:
            print("\n".join(rows(name, measured(name, cases, steps))), flush=True)


if __name__ == "__main__":
    main()
