"""Translation of a body with quadratic drag: m dv/dt = -m g k - c |v| v [G 2.45a-c with a generalized force].

There are two formulations, which share only the law of the force. `cartesian` integrates the three coordinates. `hodograph`
uses the horizontal speed u and the slope s of the path, for which

    1/u^2 = 1/u0^2 + (c/mg) (F(s0) - F(s)),  F(s) = s sqrt(1 + s^2) + asinh(s),     ds/dt = -g/u,

so that only one variable and two quadratures remain. Straight paths have closed forms.
"""

import math

import numpy as np

from bodycheck.reference.integration.dop853 import scales, solve
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array

#: Ratio of the horizontal speed to the largest speed up to which the horizontal speed has no effect on the drag, since its
#: square is lost to rounding.
NEGLIGIBLE_SPEED_RATIO = 1e-9


def cartesian(scene: Scene, times: Array) -> tuple[Array, Array]:
    """Positions (n, 3), m, and velocities (n, 3), m/s, world frame, at ascending times (n,) >= 0, s, in three coordinates.

    Raises `OutOfReach` if the integration fails or takes too many steps.
    """
    resistance, gravity = scene.drag / scene.body.mass, scene.gravity

    def derivative(_t: float, y: Array) -> Array:
        _, _, _, dx, dy, dz = y.tolist()
        slowing = resistance * math.sqrt(dx * dx + dy * dy + dz * dz)
        return np.array([dx, dy, dz, -slowing * dx, -slowing * dy, -slowing * dz - gravity])

    length, _, speed, _ = scales(scene, times)
    start = np.array([*scene.initial.position, *scene.initial.velocity])
    rows = solve(derivative, start, times, np.repeat([length, speed], 3))
    return rows[:, :3], rows[:, 3:]


def hodograph(scene: Scene, times: Array) -> tuple[Array, Array]:
    """The same motion as `cartesian`, with the same errors, integrated with the slope of the path as the variable."""
    resistance, gravity = scene.drag / scene.body.mass, scene.gravity
    position, velocity = np.array(scene.initial.position), np.array(scene.initial.velocity)
    horizontal = math.hypot(velocity[0], velocity[1])
    if gravity == 0:
        return _coasting(resistance, position, velocity, times)
    length, _, fastest, _ = scales(scene, times)
    if horizontal <= NEGLIGIBLE_SPEED_RATIO * fastest:
        return _vertical(resistance, gravity, position, velocity, times)

    def arc(s: float) -> float:
        return s * math.sqrt(1 + s * s) + math.asinh(s)

    start = float(velocity[2]) / horizontal
    constant = horizontal**-2 + resistance / gravity * arc(start)

    def speed(s: float) -> float:
        return 1 / math.sqrt(constant - resistance / gravity * arc(s))

    def derivative(_t: float, y: Array) -> Array:
        s = float(y[0])
        u = speed(s)
        return np.array([-gravity / u, u, u * s])

    rows = solve(derivative, np.array([start, 0.0, 0.0]), times, np.array([1.0, length, length]))
    direction = velocity[:2] / horizontal
    u = np.array([speed(s) for s in rows[:, 0].tolist()])
    return (
        position + np.column_stack([rows[:, 1:2] * direction, rows[:, 2]]),
        np.column_stack([u[:, None] * direction, u * rows[:, 0]]),
    )


def _coasting(resistance: float, position: Array, velocity: Array, times: Array) -> tuple[Array, Array]:
    """Position and velocity without gravity: the path is straight and 1/v grows linearly with time."""
    speed = float(np.linalg.norm(velocity))
    slowed = resistance * speed * times[:, None]
    reach = np.log1p(slowed) / (resistance * speed) if resistance * speed > 0 else times[:, None]
    return position + velocity * reach, velocity / (1 + slowed)


def _vertical(resistance: float, gravity: float, position: Array, velocity: Array, times: Array) -> tuple[Array, Array]:
    """Position and velocity along a vertical path: the speed is a tan on the way up and a tanh after the apex.

    The small horizontal velocity has no effect on the drag; it decays with the vertical motion and is integrated.
    """
    terminal = math.sqrt(gravity / resistance)
    upward, downward = max(float(velocity[2]), 0.0) / terminal, max(-float(velocity[2]), 0.0) / terminal
    apex = terminal / gravity * math.atan(upward)

    def rising(t: Array) -> Array:
        return gravity / terminal * (apex - np.minimum(t, apex))

    def grown(t: Array) -> tuple[Array, Array]:
        falling = gravity / terminal * np.maximum(t - apex, 0.0)
        return np.cosh(falling) + downward * np.sinh(falling), np.sinh(falling) + downward * np.cosh(falling)

    def slowing(t: Array) -> Array:
        """Fraction exp(-c/m * path length) of the horizontal speed that remains."""
        return np.asarray(np.cos(math.atan(upward)) / (np.cos(rising(t)) * grown(t)[0]))

    along, faster = grown(times)
    height = math.log1p(upward**2) / 2 + np.log(np.cos(rising(times))) - np.log(along)
    speed = np.where(times < apex, np.tan(rising(times)), -faster / along)
    drift = solve(lambda t, _: slowing(np.array([t])), np.zeros(1), times, np.array([float(times[-1]) if times.any() else 1.0]))
    across = velocity[:2]
    return (
        position + np.column_stack([across * drift, terminal**2 / gravity * height]),
        np.column_stack([across * slowing(times)[:, None], terminal * speed]),
    )
