"""Programs of semi-implicit Euler for a free body, which do the same in another order of operations and in any precision."""

from typing import Any, Literal

import numpy as np

from bodycheck.judging.schemes.classes import Motion
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.results.key import RunKey

#: Where a step is stretched: in the angular velocity, the turn, the change of the velocity, or that of the position.
Part = Literal["rates", "turn", "velocity", "position", "nothing"]

#: The unit roundoff of the types of numbers.
ROUNDOFF = {np.float64: 2.0**-53, np.float32: 2.0**-24}


def motion(name: str, scene: Scene, timestep: float, steps: int, number: Any = np.float64, **options: Any) -> Motion:
    """The motion by a program, every step of it. number: the type of numbers; options: those of `states`."""
    rows = states(scene, timestep, steps, number, **options)
    t = np.arange(steps + 1) * timestep
    trajectory = Trajectory(t, rows[:, :3], rows[:, 3:7], rows[:, 7:10], rows[:, 10:])
    return Motion(scene, timestep, RunKey.of_method(name, "step"), trajectory, ROUNDOFF[number])


def states(
    scene: Scene, timestep: float, steps: int, number: Any, in_world: bool = False, stretch: float = 0.0, part: Part = "nothing"
) -> Array:
    """The states (steps + 1, 13) of a program whose steps are stretched in one part, relative to its change in a step.

    in_world: whether angular velocity and inertia are kept in the world frame, as many engines do.
    """
    h, moments = number(timestep), np.array(scene.body.moments, number)
    factor = {name: number(1 + stretch) if name == part else number(1) for name in ("rates", "turn", "velocity", "position")}
    p, q, v, w = (np.array(vector, number) for vector in vars(scene.initial).values())
    gravity = np.array([0, 0, -scene.gravity], number)
    rows = [np.concatenate([p, q, v, w])]
    for _ in range(steps):
        if in_world:
            frame = _matrix(q)
            inertia, inverse, spin = (frame * moments) @ frame.T, (frame * (1 / moments)) @ frame.T, frame @ w
            spin = (spin - h * (inverse @ np.cross(spin, inertia @ spin))) * factor["rates"]
            q = _normalised(_product(_turn(h * spin * factor["turn"]), q))
            w = _matrix(q).T @ spin
        else:
            w = (w + h * (np.cross(moments * w, w) / moments)) * factor["rates"]
            q = _normalised(_product(q, _turn(h * w * factor["turn"])))
        v = v + h * gravity * factor["velocity"]
        p = p + h * v * factor["position"]
        assert p.dtype == q.dtype == v.dtype == w.dtype == number
        rows.append(np.concatenate([p, q, v, w]))
    return np.array(rows, np.float64)


def _turn(vector: Any) -> Any:
    angle = np.sqrt(vector @ vector)
    return np.concatenate([[np.cos(angle / 2)], vector * (np.sin(angle / 2) / angle)]).astype(vector.dtype)


def _normalised(q: Any) -> Any:
    return q / np.sqrt(q @ q)


def _product(p: Any, q: Any) -> Any:
    vector = p[0] * q[1:] + q[0] * p[1:] + np.cross(p[1:], q[1:])
    return np.concatenate([[p[0] * q[0] - p[1:] @ q[1:]], vector])


def _matrix(q: Any) -> Any:
    w, x, y, z = q
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
