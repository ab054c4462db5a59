"""Print the tables of docs/contacts.md on bodies that rest, just slide, and bounce. Run: python docs/resting.py"""

import math
from dataclasses import replace

import numpy as np

from bodycheck.adapters import registry
from bodycheck.adapters.contract import InterfaceLoads, Method
from bodycheck.casefile.case import load
from bodycheck.reference.inertia import principal_moments
from bodycheck.reference.mechanisms.exact import nearest_inertia
from bodycheck.reference.mechanisms.mechanism import WORLD, AnyScene, Mechanism
from bodycheck.reference.scene import Body, Brick, Plane, Scene, Shape, Sphere, State
from bodycheck.reference.trajectory import Array

MINUTE_S, TIMESTEP_S, GRAVITY, FRICTION = 60.0, 0.002, 9.81, 0.5

#: Steps in which loads are measured, the last 2 s of 4 s.
LOADED = 2000

METHODS = (
    ("mujoco", "Euler"),
    ("mujoco", "Euler:noslip=10"),
    ("mujoco", "Euler:cone=elliptic"),
    ("mujoco", "Euler:cone=elliptic,noslip=10"),
    ("mujoco", "Euler:cone=elliptic,impratio=10"),
    ("mujoco", "Euler:cone=elliptic,impratio=100"),
    ("mujoco", "implicitfast"),
    ("mujoco", "RK4"),
    ("pinocchio", "admm"),
)


def resting(shape: Shape, height: float, incline: float) -> Scene:
    """Return a body of 1 kg at rest on a plane."""
    x, y, z = (height * part for part in Plane(incline=incline).normal)
    start = State((x, y, z), (math.cos(incline / 2), 0.0, math.sin(incline / 2), 0.0))
    return Scene(Body(1.0, principal_moments(shape, 1.0), shape), start, GRAVITY, Plane(FRICTION, incline=incline))


def stack() -> Mechanism:
    """Return ten equal cubes, one on another."""
    scene = load("stack-of-ten").scene
    assert isinstance(scene, Mechanism)
    return scene


def last(engine: str, spelling: str, scene: AnyScene) -> tuple[Array, Array]:
    """Return the first and the last states (bodies, 13) of a minute."""
    adapter = registry.load(engine)
    rows = adapter.prepare([scene], Method.parse(spelling, TIMESTEP_S)).advance(np.array([0, round(MINUTE_S / TIMESTEP_S)]))[0]
    return rows[0], rows[1]


def bounce(spelling: str, coefficient: float) -> float:
    """Return the ratio of the velocities after and before the first impact of a ball that falls by 1 m on MuJoCo's contact."""
    ball = resting(Sphere(0.1), 1.1, 0.0)
    adapter = registry.load("mujoco")
    scene = replace(ball, plane=Plane(FRICTION, restitution=coefficient))
    strides = np.ones(round(0.7 / TIMESTEP_S), dtype=np.int64)
    velocity = adapter.prepare([scene], Method.parse(spelling, TIMESTEP_S)).advance(strides)[0, :, 0, 9]
    return float(-velocity.max() / velocity.min())


def main() -> None:
    resting_bodies()
    print("\n| coefficient | Euler | Euler:restitution=solref | RK4:restitution=solref | discrete:restitution=solref |")
    print("| --- | --- | --- | --- | --- |")
    for coefficient in (0.1, 0.5, 0.8, 1.0):
        methods = ("Euler", *(f"{name}:restitution=solref" for name in ("Euler", "RK4", "discrete")))
        print(f"| {coefficient} | {' | '.join(f'{bounce(method, coefficient):.3f}' for method in methods)} |")


def resting_bodies() -> None:
    """Print the table of bodies that should rest, or just slide."""
    blocks = [resting(Brick((0.1, 0.1, 0.1)), 0.1, math.atan(part * FRICTION)) for part in (0.99, 1.01)]
    ball, pile = resting(Sphere(0.1), 0.1, 0.0), stack()
    weight = nearest_inertia(pile.bodies[0]).mass * GRAVITY
    print("| engine | method | ball, m/s | 0.99, m/s | 1.01, of the way | stack, m | loads |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for engine, spelling in METHODS:
        cells = []
        for scene in (ball, blocks[0]):
            start, end = last(engine, spelling, scene)
            cells.append(f"{np.linalg.norm(end[0, :3] - start[0, :3]) / MINUTE_S:.1e}")
        start, end = last(engine, spelling, blocks[1])
        plane = blocks[1].plane
        assert plane is not None
        way = GRAVITY * (math.sin(plane.incline) - FRICTION * math.cos(plane.incline)) * MINUTE_S**2 / 2
        cells.append(f"{np.linalg.norm(end[0, :3] - start[0, :3]) / way:.4f}")
        start, end = last(engine, spelling, pile)
        cells.append(f"{np.linalg.norm(end[:, :3] - start[:, :3], axis=1).max():.1e}")
        adapter = registry.load(engine)
        assert isinstance(adapter, InterfaceLoads)
        loads = adapter.interface_loads(pile, Method.parse(spelling, TIMESTEP_S), LOADED)
        held = {(WORLD, 0): 10, **{(place, place + 1): 9 - place for place in range(9)}}
        worst = max(abs(float(loads[pair][LOADED // 2 :].mean()) / (count * weight) - 1) for pair, count in held.items())
        cells.append(f"{worst:.1e}")
        print(f"| {engine} | {spelling} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
