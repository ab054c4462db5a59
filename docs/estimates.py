"""Estimate the errors of MJCF scenes in MuJoCo with their own method, and print a table of what their own step costs.

Run: python docs/estimates.py MODELS RECORDS, where MODELS has a folder of each package with its files, and RECORDS is a file of
JSON lines, to which each scene is added when it is measured, so that an interrupted run goes on. `--table` prints the table of
a finished file.
"""

import argparse
import json
import resource
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from statistics import median
from typing import Any

import mujoco

import bodycheck
from bodycheck.casefile.robots.named import may_be_robot
from bodycheck.errors import BadInput
from bodycheck.reports.quantities import number
from bodycheck.studies.estimate.rows import ESTIMATE

#: The packages whose scenes are measured.
PACKAGES = ("gymnasium", "gymnasium_robotics", "dm_control", "robosuite")

#: The names of MuJoCo's integrators in the order of its enumeration.
INTEGRATORS = ("Euler", "RK4", "implicit", "implicitfast", "discrete")

#: The quantities of the table.
ANGLE, LENGTH = "joint_position_error", "position_error"

HEAD = (
    "| scene | class | step, ms | joint position error, rad | position error, m | verdict | processor time, s |\n"
    "| --- | --- | ---: | --- | --- | --- | ---: |"
)


def scenes(models: Path) -> Iterator[tuple[str, Path]]:
    """Yield the package and the path of each file that may be a scene."""
    for package in PACKAGES:
        for path in sorted((models / package).rglob("*.xml")):
            if may_be_robot(path):
                yield package, path


def measured(models: Path, package: str, path: Path) -> dict[str, Any]:
    """Return the record of a scene."""
    start = processor_time()
    record: dict[str, Any] = {"path": str(path.relative_to(models))}
    try:
        method = INTEGRATORS[mujoco.MjModel.from_xml_path(str(path)).opt.integrator]
    except ValueError:
        method = INTEGRATORS[0]
    try:
        results = bodycheck.estimate(path, engine="mujoco", integrator=method, package_path=models / package)
        record |= {"own": results.estimates.present["mujoco"], "kind": results.estimates.kinds["mujoco"]}
        record["rows"] = list(results.tables["estimate"].rows)
    except BadInput as error:
        record["refused"] = str(error)
    return record | {"seconds": processor_time() - start}


def processor_time() -> float:
    """Return the processor time (s) of this process and of those that it has started and that have ended."""
    uses = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(one.ru_utime + one.ru_stime for one in uses)


def row(record: dict[str, Any]) -> tuple[str, str]:
    """Return the verdict of a scene and its line of the table."""
    name, seconds = record["path"].replace("_", "\\_"), f"{record['seconds']:.0f}"
    if "rows" not in record or not record["own"][0]:
        why = record.get("refused") or record.get("failed") or record["rows"][0]["reason"]
        return "not read", f"| {name} | | | | | not read: {why.splitlines()[0][:120]} | {seconds} |"
    if not any(row["quantity"] for row in record["rows"]):
        return "nothing moves", f"| {name} | | {1e3 * record['own'][1]:g} | | | no body can move | {seconds} |"
    present = {row["quantity"]: row for row in record["rows"] if row["timestep"] == record["own"][1]}
    angle, length = present.get(ANGLE), present.get(LENGTH)
    shown = angle or length or next(iter(present.values()))
    cells = [name, record["kind"], f"{1e3 * record['own'][1]:g}", _interval(angle), _interval(length), _verdict(shown)]
    return shown["verdict"].partition(" ")[0], f"| {' | '.join(cells)} | {seconds} |"


def _interval(of_quantity: dict[str, Any] | None) -> str:
    if of_quantity is None or of_quantity["estimate"] is None:
        return ""
    return f"{number(of_quantity['estimate'], 2)} ({number(of_quantity['low'], 2)} to {number(of_quantity['high'], 2)})"


def _verdict(of_quantity: dict[str, Any]) -> str:
    verdict, horizon = of_quantity["verdict"], of_quantity["horizon"]
    return verdict if verdict == "estimate" or horizon is None else f"{verdict}, estimate until {number(horizon, 3)} s"


def main() -> None:
    """Measure the scenes, or print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("models", type=Path)
    parser.add_argument("records", type=Path)
    parser.add_argument("--table", action="store_true")
    options = parser.parse_args()
    known = [json.loads(line) for line in options.records.read_text().splitlines()] if options.records.exists() else []
    if not options.table:
        paths = {record["path"] for record in known}
        for package, path in scenes(options.models):
            if str(path.relative_to(options.models)) not in paths:
                with options.records.open("a") as file:
                    file.write(json.dumps(measured(options.models, package, path)) + "\n")
        return
    lines = [row(record) for record in sorted(known, key=lambda record: record["path"])]
    print(HEAD, *(line for _, line in lines), sep="\n")
    print("", *summary(known, Counter(verdict for verdict, _ in lines)), sep="\n")


def summary(known: Sequence[dict[str, Any]], verdicts: Counter[str]) -> Iterator[str]:
    """Yield sentences on the verdicts, on what the present steps cost in error, and on the time that it took."""
    yield f"{len(known)} scenes: {', '.join(f'{name} {count}' for name, count in verdicts.most_common())}."
    errors = {
        record["path"]: row["estimate"]
        for record in known
        for row in record.get("rows", ())
        if (row["timestep"], row["quantity"], row["verdict"]) == (record["own"][1], ANGLE, ESTIMATE)
    }
    above = {limit: sum(error > limit for error in errors.values()) for limit in (1e-3, 1e-2, 1e-1)}
    worst = max(errors, key=lambda path: errors[path])
    yield (
        f"Of {len(errors)} scenes whose present step has an estimate of the {ANGLE}, it costs more than 0.001 rad in "
        f"{above[1e-3]}, more than 0.01 rad in {above[1e-2]} and more than 0.1 rad in {above[1e-1]}; the most is "
        f"{number(errors[worst], 2)} rad in {worst}."
    )
    times = [record["seconds"] for record in known]
    yield f"Processor time of a scene: {median(times):.0f} s in the median, at most {max(times):.0f} s."


if __name__ == "__main__":
    main()
