"""Print the tables of docs/nesc.md: NASA's check-case 2 by exact mechanics, and what the published tools are off by.

Run: python docs/nesc.py
With the published traces: python docs/nesc.py --traces FOLDER
"""

import argparse
import csv
import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from bodycheck import Case, compare, load, simulate, truth
from bodycheck.reference.certificate import certify
from bodycheck.reference.kinematics import geodesic_angle, multiply
from bodycheck.reference.scene import Scene, Vector
from bodycheck.reference.schemes.formulations import gyroscopic, world_velocity
from bodycheck.reference.schemes.one_step import step_through
from bodycheck.reference.schemes.runge_kutta import KUTTA_4, explicit
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truth import truth as truth_of_scene

PUBLISHED = Path(__file__).parent.parent / "tests" / "data" / "nesc_case_02.csv"

#: The turning of the Earth in the report, rad/s. It points north.
EARTH_RAD_S = 7.292115e-5

#: The time for which SIM 6's rates are early, s.
EARLY_S = 5e-4

#: The columns of the published traces, by their names in the file that is quoted here.
COLUMNS = {
    "time": "time",
    **{f"{axis}_rate": f"bodyAngularRateWrtEi_deg_s_{axis.title()}" for axis in ("roll", "pitch", "yaw")},
    **{axis: f"eulerAngle_deg_{axis.title()}" for axis in ("roll", "pitch", "yaw")},
    "longitude": "longitude_deg",
}


@dataclass(frozen=True, eq=False)
class Trace:
    """The published results of a tool, at n instants.

    Attributes
    ----------
    times
        (n,) s.
    rates
        (n, 3) inertial angular velocity along the body's axes (roll, pitch, yaw), deg/s.
    quaternion
        (n, 4) attitude w, x, y, z, body to the world of the case, which does not turn with the Earth.
    """

    times: Array
    rates: Array
    quaternion: Array

    @classmethod
    def of(cls, rows: Iterable[Mapping[str, str]]) -> "Trace":
        """The trace of rows with the names of `COLUMNS`."""
        table = {name: np.array(column) for name, column in _columns(rows).items()}
        rates = np.stack([table[f"{axis}_rate"] for axis in ("roll", "pitch", "yaw")], axis=1)
        angles = np.stack([table[axis] for axis in ("roll", "pitch", "yaw")], axis=1)
        return cls(table["time"], rates, inertial(angles, table["longitude"], table["time"]))


def inertial(angles: Array, longitude: Array, times: Array) -> Array:
    """Attitudes in the world of the case, whose axes are north, west and up at the start.

    On the equator the local axes turn about north, by the turning of the Earth and by the longitude.

    Parameters
    ----------
    angles
        (n, 3) roll, pitch, yaw: 3-2-1 angles from the local axes north, east and down, deg.
    longitude
        (n,) deg.
    times
        (n,) s.

    Returns
    -------
    Array
        (n, 4) w, x, y, z, body to world.
    """
    roll, pitch, yaw = np.radians(angles).T
    local = multiply(_turn(2, yaw), multiply(_turn(1, pitch), _turn(0, roll)))
    turned = _turn(0, EARTH_RAD_S * times + np.radians(longitude))
    return multiply(_turn(0, np.full(len(times), math.pi)), multiply(turned, local))


def published(file: Path = PUBLISHED) -> dict[str, Trace]:
    """The quoted numbers of the tools, by tool."""
    rows = list(csv.DictReader(line for line in file.read_text("utf-8").splitlines() if not line.startswith("#")))
    return {tool: Trace.of(row for row in rows if row["tool"] == tool) for tool in sorted({row["tool"] for row in rows})}


def fetched(folder: Path) -> dict[str, Trace]:
    """The whole traces, by tool, from files of check-case 2 in or below a folder. Raises `FileNotFoundError` without any."""
    files = sorted(folder.rglob("Atmos_02_sim_*.csv"))
    if not files:
        raise FileNotFoundError(f"{folder}: there is no Atmos_02_sim_*.csv in or below this folder")
    traces = {}
    for file in files:
        with file.open(encoding="utf-8", newline="") as lines:
            traces[f"SIM {int(file.stem[-2:])}"] = Trace.of(
                {name: row[column] for name, column in COLUMNS.items()} for row in csv.DictReader(lines)
            )
    return traces


def exact(scene: Scene, times: Array) -> Trajectory:
    """The exact motion at times (n,), s."""
    return truth_of_scene(scene, times).trajectory


def rates_of(motion: Trajectory) -> Array:
    """The angular velocity (n, 3) along the body's axes, deg/s."""
    return np.degrees(motion.angular_velocity)


def off_by(scene: Scene, trace: Trace) -> tuple[Array, Array]:
    """Return a tool's errors: of its rates (n, 3), deg/s, and the angle between its attitude and the exact one (n,), deg."""
    motion = exact(scene, trace.times)
    return trace.rates - rates_of(motion), np.degrees(geodesic_angle(trace.quaternion, motion.quaternion))


def runge_kutta(timestep: float) -> Callable[[Scene, Array], Array]:
    """The rates (n, 3), deg/s, of the classical Runge-Kutta scheme with a time step (s), at its steps nearest to some times."""

    def rates(scene: Scene, times: Array) -> Array:
        strides = np.diff(_steps(times, timestep), prepend=0)
        return np.degrees(step_through(explicit(KUTTA_4), world_velocity, scene, timestep, strides)[:, 10:])

    return rates


def adams_bashforth(timestep: float) -> Callable[[Scene, Array], Array]:
    """The same of the Adams-Bashforth scheme of order 2, whose first step is an explicit Euler step."""

    def rates(scene: Scene, times: Array) -> Array:
        acceleration, *_ = gyroscopic(scene.body)
        steps = _steps(times, timestep)
        rate, found = scene.initial.angular_velocity, [scene.initial.angular_velocity]
        before = acceleration(rate)
        for _ in range(int(steps.max())):
            now = acceleration(rate)
            rate, before = _advanced(rate, now, before, timestep), now
            found.append(rate)
        return np.degrees(np.array(found, dtype=np.float64)[steps])

    return rates


def early(lead: float) -> Callable[[Scene, Array], Array]:
    """The exact rates (n, 3), deg/s, by some lead (s) after each time."""
    return lambda scene, times: rates_of(exact(scene, times + lead))


#: The methods of engines that are compared with the tools, at the time step that is theirs most often, s.
METHODS = (("mujoco", "RK4"), ("pinocchio", "rk4"))
TIMESTEP_S = 0.01

#: What explains the rates of a tool, in words, and the rates (n, 3), deg/s, that it predicts at times (n,), s.
EXPLANATIONS: dict[str, tuple[str, Callable[[Scene, Array], Array]]] = {
    "SIM 2": ("Adams-Bashforth 2, 10 ms, first step explicit Euler", adams_bashforth(0.01)),
    "SIM 5": ("Adams-Bashforth 2, 2 ms, first step explicit Euler", adams_bashforth(0.002)),
    "SIM 6": ("the exact motion 0.5 ms later", early(EARLY_S)),
}


def unexplained(scene: Scene, tool: str, trace: Trace) -> tuple[float, float]:
    """Return the largest error of a tool's rates after the start, deg/s, and the part of it that the explanation leaves."""
    times, rates = trace.times[1:], trace.rates[1:]
    return _largest(rates - rates_of(exact(scene, times))), _largest(rates - EXPLANATIONS[tool][1](scene, times))


def misread(scene: Scene, roll_rate: float) -> tuple[Array, float]:
    """Return the changes due to another initial roll rate (rad/s) after 30 s: rates (3,), deg/s, and attitude, deg."""
    _, pitch_rate, yaw_rate = scene.initial.angular_velocity
    state = replace(scene.initial, angular_velocity=(roll_rate, pitch_rate, yaw_rate))
    end = np.array([30.0])
    right, wrong = exact(scene, end), exact(replace(scene, initial=state), end)
    angle = geodesic_angle(wrong.quaternion, right.quaternion)
    return (rates_of(wrong) - rates_of(right))[0], float(np.degrees(angle)[0])


def print_exact(scene: Scene) -> None:
    """Print the exact rates at 30 s and the bound of their error."""
    end = np.array([30.0])
    found = certify(scene, end)
    bound = math.degrees(found.truth.bounds.angular_velocity_error[0])
    print("| after 30 s | roll rate, deg/s | pitch rate, deg/s | yaw rate, deg/s | error at most, deg/s |")
    print("| --- | --- | --- | --- | --- |")
    print(f"| exact | {' | '.join(f'{rate:.12f}' for rate in rates_of(found.truth.trajectory)[0])} | {bound:.1e} |")
    checked = f"cross-checked to {found.bound[0]:.1e} rad" if found.certified else f"contradicted: {'; '.join(found.faults)}"
    print(f"\nThe attitude is {checked}.\n")


def print_tools(scene: Scene, traces: Mapping[str, Trace]) -> None:
    """Print what each tool is off by at 30 s."""
    print("| tool | roll rate, deg/s | pitch rate, deg/s | yaw rate, deg/s | rates together, deg/s | attitude, deg |")
    print("| --- | --- | --- | --- | --- | --- |")
    for tool, trace in traces.items():
        rates, angle = (error[-1] for error in off_by(scene, trace))
        print(f"| {tool} | {' | '.join(f'{rate:.1e}' for rate in rates)} | {math.hypot(*rates):.1e} | {angle:.1e} |")


def print_explanations(scene: Scene, traces: Mapping[str, Trace]) -> None:
    """Print what explains the rates of some tools, and what it leaves."""
    print("\n| tool | scheme that gives its rates | largest error, deg/s | unexplained part, deg/s |")
    print("| --- | --- | --- | --- |")
    for tool, (words, _) in EXPLANATIONS.items():
        error, left = unexplained(scene, tool, traces[tool])
        print(f"| {tool} | {words} | {error:.1e} | {left:.1e} |")
    times = traces["SIM 4"].times
    scheme = _largest(runge_kutta(TIMESTEP_S)(scene, times) - rates_of(exact(scene, times)))
    print(f"\nClassical Runge-Kutta at 10 ms is off by {scheme:.1e} deg/s at most.")


def print_misreadings(scene: Scene) -> None:
    """Print what it changes to take rates of one frame for rates of the other."""
    roll = scene.initial.angular_velocity[0]
    print("\n| misreading | initial roll rate, deg/s | rates after 30 s, deg/s | attitude after 30 s, deg |")
    print("| --- | --- | --- | --- |")
    for words, rate in (
        ("10, 20, 30 deg/s taken as relative to the Earth", roll + EARTH_RAD_S),
        ("the table's rates taken as inertial", roll - EARTH_RAD_S),
    ):
        rates, angle = misread(scene, rate)
        print(f"| {words} | {math.degrees(rate):.9f} | {math.hypot(*rates):.1e} | {angle:.1e} |")


def at_rest(case: Case) -> Case:
    """The case without its fall and its flight around the Earth: only the rotation is left."""
    state = replace(case.scene.initial, velocity=(0.0, 0.0, 0.0))
    return replace(case, scene=replace(case.scene, initial=state, gravity=0.0))


def print_engines(case: Case) -> None:
    """Print the largest errors of the rates of engines: in the flight of the case, with a mass of 2 kg, and at rest."""
    of_2_kg = replace(case, scene=replace(case.scene, body=replace(case.scene.body, mass=2.0)))
    print("\n| engine | method | in flight, deg/s | in flight, mass 2 kg, deg/s | at rest, deg/s |")
    print("| --- | --- | --- | --- | --- |")
    for engine, integrator in METHODS:
        runs = ((truth(each), simulate(each, engine, integrator, TIMESTEP_S)) for each in (case, of_2_kg, at_rest(case)))
        errors = [math.degrees(compare(*run).maxima()["angular_velocity_error"]) for run in runs]
        print(f"| {engine} | {integrator}, 10 ms | {' | '.join(f'{error:.1e}' for error in errors)} |")


def print_traces(scene: Scene, traces: Mapping[str, Trace]) -> None:
    """Print the largest error of each tool over its whole trace."""
    print("\n| tool | instants | rates at most, deg/s | of which unexplained, deg/s | attitude at most, deg |")
    print("| --- | --- | --- | --- | --- |")
    for tool, trace in traces.items():
        rates, angle = off_by(scene, trace)
        left = f"{unexplained(scene, tool, trace)[1]:.1e}" if tool in EXPLANATIONS else "–"
        print(f"| {tool} | {len(trace.times)} | {_largest(rates):.1e} | {left} | {angle.max():.1e} |")


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description="Print the tables of docs/nesc.md.")
    parser.add_argument("--traces", type=Path, metavar="FOLDER", help="with the traces of check-case 2 in or below it")
    folder: Path | None = parser.parse_args(arguments).traces
    case, traces = load("nesc-tumbling-brick"), published()
    scene = case.scene
    print_exact(scene)
    print_tools(scene, traces)
    print_explanations(scene, traces)
    print_misreadings(scene)
    print_engines(case)
    if folder is not None:
        print_traces(scene, fetched(folder))


def _columns(rows: Iterable[Mapping[str, str]]) -> dict[str, list[float]]:
    found: dict[str, list[float]] = {name: [] for name in COLUMNS}
    for row in rows:
        for name, values in found.items():
            values.append(float(row[name]))
    return found


def _largest(errors: Array) -> float:
    """The largest length of errors (n, 3)."""
    return float(np.linalg.norm(errors, axis=1).max())


def _turn(axis: int, angles: Array) -> Array:
    """The quaternions (n, 4) of turns about one of the axes 0, 1, 2 by angles (n,), rad."""
    turns = np.zeros((len(angles), 4))
    turns[:, 0], turns[:, 1 + axis] = np.cos(angles / 2), np.sin(angles / 2)
    return turns


def _steps(times: Array, timestep: float) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
    return np.rint(times / timestep).astype(np.int64)


def _advanced(rate: Vector, now: Vector, before: Vector, timestep: float) -> Vector:
    x, y, z = (w + timestep * (1.5 * new - 0.5 * old) for w, new, old in zip(rate, now, before, strict=True))
    return x, y, z


if __name__ == "__main__":
    main()
