"""Measure what an ensemble costs beside its engine and its truths, what a second process gains, and the memory of all.

    python benchmarks/ensemble.py [--members N] [--integrator NAME]... [--duration S] [--rounds N]

The ensemble is one of torque-free bricks whose attitude and angular velocity are drawn. In each round, with one process and
with two, these works are done in turn: the bare engine, which is MuJoCo's own rollout of such states in blocks, without reading
any; the truths alone, by `flights`, at the instants of the runs; and the command `bodycheck ensemble` with tables, worst
members and report. The command is also made with a thousand members, since some of its time does not depend on how many
there are. Times are wall times, and the ratios are those of the medians over the rounds.
"""

import argparse
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

CASE = """
format = 1
name = "bricks"
title = "Torque-free bricks"

[body]
shape = "brick"
mass = 1.0
semi_axes = [0.05, 0.1, 0.15]

[run]
duration = {duration}
samples = {samples}

[ensemble]
members = {members}
seed = 1

[[ensemble.vary]]
distribution = "attitude"

[[ensemble.vary]]
key = "initial.angular_velocity"
distribution = "normal"
mean = [0.0, 0.0, 0.0]
standard_deviation = [3.0, 3.0, 3.0]
"""

TIMESTEP_S = 0.002
BLOCK = 1000
SAMPLES_EVERY_S = 0.02
FEW = 1000

#: The interval between two readings of the memory of all processes.
MEMORY_INTERVAL_S = 0.2


def engine(integrators: list[str], first: int, count: int, duration: float) -> None:
    """Roll out a block of bricks with MuJoCo alone, in this process."""
    import mujoco
    import numpy as np
    from mujoco.rollout import Rollout

    xml = (
        '<mujoco><option timestep="{}" integrator="{}" gravity="0 0 0"/><worldbody><body><freejoint/>'
        '<inertial pos="0 0 0" mass="1" diaginertia="0.010833333333333334 0.008333333333333333 0.004166666666666667"/>'
        "</body></worldbody></mujoco>"
    )
    generator, steps, together = np.random.default_rng(first), round(duration / TIMESTEP_S), 100
    for integrator in integrators:
        model = mujoco.MjModel.from_xml_string(xml.format(TIMESTEP_S, integrator))
        data, state = mujoco.MjData(model), np.zeros((count, 14))
        state[:, 4:8] = generator.normal(size=(count, 4))
        state[:, 4:8] /= np.linalg.norm(state[:, 4:8], axis=1, keepdims=True)
        state[:, 11:] = generator.normal(0, 3, (count, 3))
        rollout, kept = Rollout(nthread=0), np.empty((together, steps, 14))
        for begin in range(0, count, together):
            part = state[begin : begin + together]
            rollout.rollout(model, data, part, nstep=steps, state=kept[: len(part)])


def truths(integrators: list[str], first: int, count: int, duration: float) -> None:
    """Compute the truths of a block of bricks alone, in this process."""
    import numpy as np

    from bodycheck.reference.exact.start import defined_scene
    from bodycheck.reference.flight.flights import flights
    from bodycheck.reference.scene import Brick, Definition, Solid
    from bodycheck.reference.scenes import vary

    generator, shape = np.random.default_rng(first), Brick((0.05, 0.1, 0.15))
    drawn = {"quaternion": generator.normal(size=(count, 4)), "angular_velocity": generator.normal(0, 3, (count, 3))}
    scenes = vary(defined_scene(Definition(Solid(shape, 1.0)), shape), drawn)
    flights(scenes, np.linspace(0.0, duration, round(duration / SAMPLES_EVERY_S) + 1))


def in_processes(work: Callable[..., None], processes: int, members: int, integrators: list[str], duration: float) -> float:
    """Return the wall time (s) of a work on all members, in blocks, in warm processes."""
    blocks = range(0, members, BLOCK)
    with ProcessPoolExecutor(processes, get_context("spawn")) as pool:
        for warm in [pool.submit(work, integrators, 0, 1, duration) for _ in range(4 * processes)]:
            warm.result()
        start = time.perf_counter()
        for done in [pool.submit(work, integrators, one, min(BLOCK, members - one), duration) for one in blocks]:
            done.result()
        return time.perf_counter() - start


def command(processes: int, members: int, integrators: list[str], duration: float) -> tuple[float, int]:
    """Return the wall time (s) of `bodycheck ensemble`, and the largest memory (bytes) of all of its processes together."""
    samples = round(duration / SAMPLES_EVERY_S) + 1
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "bricks.case.toml")
        file.write_text(CASE.format(members=members, duration=duration, samples=samples))
        asked = [part for name in integrators for part in ("--integrator", name)]
        own = [sys.executable, "-m", "bodycheck", "ensemble", str(file), "--engine", "mujoco", *asked, "--quiet"]
        start, most = time.perf_counter(), 0
        running = subprocess.Popen([*own, "--jobs", str(processes), "--out", str(Path(folder, "out"))])
        while running.poll() is None:
            most = max(most, memory(running.pid))
            time.sleep(MEMORY_INTERVAL_S)
        if running.returncode:
            raise SystemExit(f"the command failed with exit code {running.returncode}")
        return time.perf_counter() - start, most


def memory(process: int) -> int:
    """Return the proportional set size (bytes) of a process and its children; 0 where the system does not tell."""
    parents = {}
    for entry in Path("/proc").glob("[0-9]*"):
        try:
            parents[int(entry.name)] = int((entry / "stat").read_text().rpartition(")")[2].split()[1])
        except OSError:
            continue
    family, size = {process}, 0
    while more := {own for own, parent in parents.items() if parent in family} - family:
        family |= more
    for own in family:
        try:
            lines = Path("/proc", str(own), "smaps_rollup").read_text().splitlines()
        except OSError:
            continue
        size += sum(int(line.split()[1]) * 1024 for line in lines if line.startswith("Pss:"))
    return size


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--members", type=int, default=10_000)
    parser.add_argument("--integrator", action="append", default=[])
    parser.add_argument("--duration", type=float, default=2.0)
    parser.add_argument("--rounds", type=int, default=5)
    told = parser.parse_args()
    integrators = told.integrator or ["Euler", "RK4"]
    rest = told.members, integrators, told.duration
    os.environ["OMP_NUM_THREADS"] = "1"  # as the workers of ensembles have it
    times: dict[tuple[str, int], list[float]] = {}
    peaks: dict[str, int] = {}
    for turn in range(told.rounds):
        for processes in (2, 1) if turn % 2 else (1, 2):
            times.setdefault(("engine", processes), []).append(in_processes(engine, processes, *rest))
            times.setdefault(("truths", processes), []).append(in_processes(truths, processes, *rest))
            for name, members in (("ensemble", told.members), ("few", FEW)):
                taken, peak = command(processes, members, *rest[1:])
                times.setdefault((name, processes), []).append(taken)
                peaks[name] = max(peaks.get(name, 0), peak)
    found = {work: statistics.median(own) for work, own in times.items()}
    print(f"{told.members} members, {told.duration:g} s at 2 ms, MuJoCo {' and '.join(integrators)}; medians of {told.rounds}")
    print("processes  engine    truths    ensemble  few       ensemble / (engine + truths)  the same without few")
    rest_of: dict[int, float] = {}
    for processes in (1, 2):
        bare, alone, whole, few = (found[name, processes] for name in ("engine", "truths", "ensemble", "few"))
        rest_of[processes] = (whole - few) * told.members / max(1, told.members - FEW)
        ratios = f"{whole / (bare + alone):<28.2f}  {rest_of[processes] / (bare + alone):.2f}"
        print(f"{processes:<9}  {bare:<8.2f}  {alone:<8.2f}  {whole:<8.2f}  {few:<8.2f}  {ratios}")
    bare, rest_gain = found["engine", 1] / found["engine", 2], rest_of[1] / rest_of[2]
    print(f"a second process makes the engine {bare:.2f} times as fast, and the ensemble, without few, {rest_gain:.2f} times")
    for name, peak in peaks.items():
        print(f"{name}: at most {peak / 2**20:.0f} MiB in all processes together")


if __name__ == "__main__":
    main()
