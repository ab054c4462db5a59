"""Print the tables of docs/robots.md on robots' files as cases, from folders. Run: python docs/robot_files.py FOLDER ...

Each URDF and MJCF file with a joint is a row: whether it runs as it is, what must be ignored, or why it is refused; the bound
of its truth; the error of MuJoCo's default method at the file's own step; how far its mass matrix, bias and gravity are from
those of the model that `bodycheck parity` reads; the order in which MuJoCo's RK4 converges to the truth of the robot without
dry friction, mimic joints and loops, whose joints start with random velocities; and the time of all this.
"""

import math
import re
import sys
import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np

import bodycheck
from bodycheck.casefile.case import CaseFaults, loaded
from bodycheck.casefile.content import Case
from bodycheck.casefile.robots.direct import scene_of_robot, text_of_robot
from bodycheck.casefile.robots.reading import Ignored
from bodycheck.errors import BadInput, Failed
from bodycheck.files.temporary import temporary_folder
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.robots.dynamics import terms_at
from bodycheck.reference.robots.model import RobotModel, Wide
from bodycheck.reference.robots.motion import columns
from bodycheck.reference.robots.state import VELOCITIES, RobotState
from bodycheck.reference.robots.states import seeded_states
from bodycheck.robots import elements
from bodycheck.robots.from_mechanism import robot_model
from bodycheck.running import robot_readings
from bodycheck.studies.parity import models
from bodycheck.studies.parity.files import NamedFile, named

#: The time steps (s) between which the order of RK4 is observed, and the error (rad or m) that must fall to show it.
STEPS, ROUNDING = (0.002, 0.001, 0.0005, 0.00025), 1e-11

#: The smaller steps (s) that are tried where the order is farther from 4 than this: damped joints have the order 4 late.
FINER, NEAR = (0.00025, 0.000125, 0.0000625), 0.2

#: The durations (s) of these runs: a shorter one where errors have grown to this size (rad or m), at which they grow no more.
DURATIONS, GROWN = (1.0, 0.5, 0.25), 0.1

#: The duration in the text of a case.
DURATION = re.compile(r"^duration = .*$", re.MULTILINE)

#: The velocities of joints in the text of a case: single numbers, or three.
VELOCITY = re.compile(r"^velocity = (\[.*\])?.*$", re.MULTILINE)

#: The largest velocity of a joint at the start of the runs that show an order (rad/s or m/s).
FASTEST = 5.0

#: What is left out in these runs: MuJoCo holds joints and loops by soft constraints, whose error no step reduces.
SOFT: tuple[Ignored, ...] = ("friction", "mimic", "equalities", "limits")

#: The number of states at which terms are compared.
STATES = 3


@dataclass(frozen=True)
class Row:
    """The row of a file; texts are empty where a file is refused."""

    wheel: str
    robot: str
    ignored: tuple[Ignored, ...]
    refused: str
    bound: str = ""
    error: str = ""
    terms: str = ""
    order: str = ""
    seconds: float = 0.0

    @property
    def result(self) -> str:
        """The result in words."""
        if self.refused:
            return f"refused: {self.refused}"
        return f"runs, ignoring {', '.join(self.ignored)}" if self.ignored else "runs as it is"


def row(wheel: str, file: NamedFile, folder: Path) -> Row:
    """Return the row of a file. folder: the folder of its wheel, whose packages it may name."""
    begun, where = time.monotonic(), file.path.relative_to(folder)
    robot = f"{where.parent.name}/{where.name}"
    read = case_of(file.path, folder)
    if isinstance(read, str):
        return Row(wheel, robot, (), read)
    case, ignored = read
    measured: tuple[str, str, str, str]
    try:
        without = scene_of_robot(file.path, (folder,), ignore=(*ignored, "limits"))
        bound, error = defaults(without)
        measured = bound, error, terms(case, file, folder, ignored), order(file.path, folder, ignored)
    except (BadInput, Failed) as reason:
        return Row(wheel, robot, ignored, " ".join(str(reason).split())[:200])
    return Row(wheel, robot, ignored, "", *measured, seconds=time.monotonic() - begun)


def case_of(path: Path, folder: Path) -> tuple[Case, tuple[Ignored, ...]] | str:
    """Return the case of a file, with the words that it must ignore, or the reason why it is none."""
    try:
        return scene_of_robot(path, (folder,)), ()
    except CaseFaults as faults:
        words = tuple(dict.fromkeys(fault.ignore for fault in faults.faults if fault.ignore is not None))
    try:
        return scene_of_robot(path, (folder,), ignore=words), words
    except CaseFaults as faults:
        return "; ".join(fault.message for fault in faults.faults)[:300]


def defaults(case: Case) -> tuple[str, str]:
    """Return the bound of a truth and the error of MuJoCo's default method at the file's own step, in words."""
    ran = bodycheck.run(case, engine="mujoco", integrator="default", jobs=1).tables["results"].rows
    (one,) = ran
    bound = one["truth_error"] if one["truth_error"] is not None else one.get("truth_position_error")
    if one["status"] != "ok":
        return number(bound), f"{one['status']}: {one['reason']}"[:120]
    return number(
        bound
    ), f"{number(one['attitude_error'])} rad, {number(one['position_error'])} m at {1e3 * one['timestep']:g} ms"


def terms(case: Case, file: NamedFile, folder: Path, ignored: Sequence[Ignored]) -> str:
    """Return the largest difference of mass matrix, bias and gravity from parity's model, relative to the largest entry."""
    with temporary_folder() as into, robot_readings.compiler() as compile_:
        other = models.read(file, (folder,), into, compile_)
    if isinstance(other, models.Unreadable) or other.model is None:
        return "parity has no model"
    assert isinstance(case.scene, Mechanism)
    own, model = bare(robot_model(case.scene, "robot")), bare(other.model)
    downwards = (0.0, 0.0, -math.hypot(*model.gravity))
    names = {joint.name for joint in own.joints if VELOCITIES[joint.type]}
    if not names:
        return "no joint moves"
    try:
        states = seeded_states(model, STATES, 1)
        states_of_own = [taken(state, own) for state in states]
        pairs = list(zip(terms_at(own, states_of_own, downwards), terms_at(model, states, model.gravity), strict=True))
    except (KeyError, ValueError) as error:
        return f"not compared: {type(error).__name__} {error}"[:80]
    picks = [np.concatenate([np.r_[columns(each)[name]] for name in sorted(names)]) for each in (own, model)]
    worst = 0.0
    for one, two in pairs:
        for name in ("mass_matrix", "coriolis_force", "gravity_force"):
            first, second = (picked(getattr(each, name), pick) for each, pick in zip((one, two), picks, strict=True))
            scale = max(float(np.abs(second).max()), 1e-3 * float(np.abs(one.mass_matrix).max()))
            worst = max(worst, float(np.abs(first - second).max()) / scale)
    return number(worst)


def picked(values: Wide, pick: np.ndarray) -> Wide:
    """Return the entries of a vector or of a square matrix for some velocities."""
    return values[pick] if values.ndim == 1 else values[np.ix_(pick, pick)]


def taken(state: RobotState, model: RobotModel) -> RobotState:
    """Return a state with the joints of a model alone."""
    names = [joint.name for joint in model.joints if joint.type != "fixed"]
    parts = (state.positions, state.velocities, state.accelerations, state.efforts)
    return RobotState(*({name: part[name] for name in names} for part in parts))


def bare(model: RobotModel) -> RobotModel:
    """Return a model without friction and rules by which joints follow others, which leave the terms of its tree as they are.

    Its free bases have the axes of the world as the frame of their coordinates: each reader may have chosen another one.
    """
    joints = [replace(joint, mimic=None, friction=0.0) for joint in model.joints]
    world = {"position": np.zeros(3, np.longdouble), "rotation": np.eye(3, dtype=np.longdouble)}
    return replace(model, joints=tuple(replace(joint, **world) if joint.type == "floating" else joint for joint in joints))


def order(path: Path, folder: Path, ignored: Sequence[Ignored]) -> str:
    """Return the order in which MuJoCo's RK4 converges without soft constraints, or why none is seen."""
    text = text_of_robot(path, (folder,), ignore=(*ignored, *SOFT))
    draws = np.random.default_rng(1)
    text = VELOCITY.sub(lambda found: f"velocity = {draws.uniform(-FASTEST, FASTEST, 3 if found[1] else 1).tolist()}", text)
    text = re.sub(r"^velocity = \[([^,\]]*)\]$", r"velocity = \1", text, flags=re.MULTILINE)
    for duration in DURATIONS:
        text = DURATION.sub(f"duration = {duration}", text)
        case = loaded(text, str(path), path.parent, (folder,), follow=True)
        errors, reason = errors_of_rk4(case, STEPS)
        over = "" if duration == DURATIONS[0] else f" over {duration} s"
        if not math.isfinite(errors[STEPS[-1]]):
            return f"none: {reason}"[:150]
        if errors[STEPS[-2]] < GROWN:
            break
    seen = orders(errors)
    if not seen:
        return f"below rounding: {number(errors[STEPS[-1]])}"
    if abs(seen[-1] - 4) > NEAR and (finer := orders(errors_of_rk4(case, FINER)[0])):
        over += f", then {' and '.join(f'{each:.2f}' for each in finer)}"
    return f"{seen[-1]:.2f}{over}"


def orders(errors: Mapping[float, float]) -> list[float]:
    """Return the orders between neighbouring steps of which both errors are larger than rounding."""
    return [
        math.log2(errors[large] / errors[small])
        for large, small in pairwise(errors)
        if ROUNDING < errors[large] < math.inf and ROUNDING / 100 < errors[small] < math.inf
    ]


def errors_of_rk4(case: Case, steps: Sequence[float]) -> tuple[dict[float, float], str]:
    """Return the errors of MuJoCo's RK4 by steps, infinite for runs that fail, and why the run with the smallest step fails."""
    rows = bodycheck.run(case, engine="mujoco", integrator="RK4", timestep=steps, jobs=1).tables["results"].rows
    errors = {
        one["timestep"]: max(one["attitude_error"] or 0.0, one["position_error"] or 0.0) if one["status"] == "ok" else math.inf
        for one in rows
    }
    return errors, next(one["reason"] for one in rows if one["timestep"] == steps[-1])


def number(value: float | None) -> str:
    """Return a number as text."""
    return "–" if value is None else f"{value:.1e}".replace("e-0", "e-").replace("e+0", "e")


def has_joints(path: Path) -> bool:
    """Return whether a file has a joint; a file that cannot be read is shown with the reason."""
    try:
        return any(element.tag in ("joint", "freejoint") for element in elements.read(path).everything())
    except BadInput:
        return True


def rows(folders: Sequence[Path]) -> Iterator[Row]:
    """Yield the rows of all files of folders, each folder a wheel."""
    asked = [(folder.name, file, folder) for folder in folders for file in named([folder]).files if has_joints(file.path)]
    with ProcessPoolExecutor(2) as pool:
        futures = [pool.submit(row, *each) for each in asked]
        for number_of_done, future in enumerate(as_completed(futures), start=1):
            wheel, file, _ = asked[futures.index(future)]
            print(f"{number_of_done} of {len(asked)}: {file.path.name}", file=sys.stderr, flush=True)
            try:
                yield future.result()
            except Exception as error:
                yield Row(wheel, f"{file.path.parent.name}/{file.path.name}", (), f"{type(error).__name__}: {error}"[:200])


def main() -> None:
    """Print the tables."""
    done = sorted(rows([Path(name) for name in sys.argv[1:]]), key=lambda row: (row.wheel, row.robot))
    print("| wheel | robot | result | bound of the truth, rad | default of MuJoCo | M, bias, gravity | order of RK4 | s |")
    print("| --- | --- | --- | --- | --- | --- | --- | ---: |")
    for one in done:
        cells = (one.wheel, one.robot, one.result, one.bound, one.error, one.terms, one.order, f"{one.seconds:.0f}")
        print(f"| {' | '.join(cell.replace('|', '¦') for cell in cells)} |")
    run = [one for one in done if not one.refused]
    print(f"\n{len(run)} of {len(done)} run, {sum(not one.ignored for one in run)} as they are.\n")
    print("| ignored | files |\n| --- | ---: |")
    for word, count in Counter(word for one in run for word in one.ignored).most_common():
        print(f"| {word} | {count} |")


if __name__ == "__main__":
    main()
