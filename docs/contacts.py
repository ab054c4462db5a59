"""Print the tables of docs/contacts.md: a spinning brick on MuJoCo's contacts. Run: python docs/contacts.py"""

from dataclasses import replace

import numpy as np

from bodycheck import load, simulate, truth
from bodycheck.adapters.contract import Method
from bodycheck.adapters.mujoco.engine import contact_loads
from bodycheck.casefile.case import Case
from bodycheck.reference.contact_observables import measured_stop
from bodycheck.reference.inertia import principal_moments
from bodycheck.reference.scene import Body, Brick, Plane
from bodycheck.reference.truth import truth as truth_of_scene
from bodycheck.results.outcome import Completed

TIMESTEP_S = 5e-4

#: Times before the stop at which the ratio of speed and spin is printed.
BEFORE_STOP_S = (1e-1, 1e-3, 1e-5, 1e-7)

SQUARE = Body(1.0, principal_moments(Brick((0.07, 0.07, 0.02)), 1.0), Brick((0.07, 0.07, 0.02)))

#: Pads along each side of the brick.
PADS = (2, 4, 8, 16)

#: Factors on the friction; gravity is divided by them.
FRICTION_FACTORS = (1.0, 0.1, 0.01, 0.001)


def equal_loads(case: Case, pads: int) -> float:
    """Return the stop time (s) of the same spin on pads x pads points that carry equal loads.

    The friction torque is constant: mu g m times the mean distance of the points from the axis.
    """
    scene = case.scene
    assert scene.plane is not None
    centres = (2 * np.arange(pads) + 1) / pads - 1
    x, y = np.meshgrid(0.1 * centres, 0.2 * centres)
    torque = scene.plane.friction * scene.gravity * scene.body.mass * np.hypot(x, y).mean()
    return float(scene.body.moments[2] * scene.initial.angular_velocity[2] / torque)


def stop_time(case: Case, integrator: str) -> tuple[float, float]:
    """Return when the brick stops (s), and the cost of a step (us)."""
    outcome = simulate(case, "mujoco", integrator, TIMESTEP_S).outcome
    assert isinstance(outcome, Completed)
    return measured_stop(case.scene, outcome.trajectory).time, 1e6 * outcome.wall_time / outcome.steps


def main() -> None:
    case = load("spinning-brick")
    area, corners = (truth(load(name)).stop for name in ("spinning-brick", "spinning-brick-corners"))
    assert area is not None
    assert corners is not None
    print(f"Exact: {area.time:.4f} s on the area, {corners.time:.4f} s on the four corners.\n")

    columns = ("pads", "stop, s", "stop for equal loads, s", "mean load", "peak load", "time in contact")
    print(f"| {' | '.join(columns)} | most pads loaded at once | µs per step |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- |")
    weight = case.scene.body.mass * case.scene.gravity
    for pads in PADS:
        integrator = f"Euler:cone=elliptic,pads={pads}"
        time, cost = stop_time(case, integrator)
        load_, touching = contact_loads(case.scene, Method.parse(integrator, TIMESTEP_S), round(0.15 / TIMESTEP_S))
        figures = f"{load_.mean() / weight:.2f} | {load_.max() / weight:.1f} | {(load_ > 0).mean():.0%} | {touching.max()}"
        print(f"| {pads} x {pads} | {time:.3f} | {equal_loads(case, pads):.3f} | {figures} | {cost:.0f} |")

    print("\n| friction | gravity, m/s^2 | stop, s | stop for equal loads, s | peak load |")
    print("| --- | --- | --- | --- | --- |")
    plane = case.scene.plane
    assert plane is not None
    for factor in FRICTION_FACTORS:
        plane_, gravity = replace(plane, friction=plane.friction * factor), case.scene.gravity / factor
        same = replace(case, scene=replace(case.scene, plane=plane_, gravity=gravity))
        time, _ = stop_time(same, "Euler:cone=elliptic,pads=8")
        load_, _ = contact_loads(same.scene, Method.parse("Euler:cone=elliptic,pads=8", TIMESTEP_S), round(0.15 / TIMESTEP_S))
        peak = load_.max() / (same.scene.body.mass * gravity)
        print(f"| {plane_.friction:g} | {gravity:g} | {time:.3f} | {equal_loads(same, 8):.3f} | {peak:.2f} |")

    print("\n| body, initial ratio | " + " | ".join(f"{left:g} s before the stop" for left in BEFORE_STOP_S) + " |")
    print("| --- " * (1 + len(BEFORE_STOP_S)) + "|")
    disk = load("curling-disk")
    square = replace(disk, scene=replace(disk.scene, body=SQUARE, plane=Plane(0.3, "corners")))
    for name, body, spins in (("disk", disk, (4.0, 20.0, 80.0)), ("square on its corners", square, (20.0,))):
        for spin in spins:
            start = replace(body.scene.initial, angular_velocity=(0.0, 0.0, spin))
            scene = replace(body.scene, initial=start)
            stop = truth_of_scene(scene, np.array([0.0, 10.0])).stop
            assert stop is not None
            motion = truth_of_scene(scene, stop.time - np.array(BEFORE_STOP_S)).trajectory
            ratios = np.linalg.norm(motion.velocity, axis=1) / (0.1 * motion.angular_velocity[:, 2])
            print(f"| {name}, {1 / (0.1 * spin):.3g} | " + " | ".join(f"{ratio:.4f}" for ratio in ratios) + " |")


if __name__ == "__main__":
    main()
