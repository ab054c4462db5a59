"""The translation with quadratic drag, integrated in three coordinates: the witness of `motion`.

It shares only the force law with `motion`. The equations dx/dt = v, dv/dt = -(c/m) |v| v - g k are solved by heyoka's Taylor
series in the wide type, or by SciPy's DOP853 if heyoka is not installed. Its units are powers of two chosen for each scene, so
that tolerances mean the same for every scene.

The cost is known beforehand. Any motion has relaxed to the terminal velocity after 48 times sqrt(m / (g c)), since the
horizontal speed decays by exp(-t) in that unit and the excess of speed by exp(-2 t); the rest is a straight line. A faster
start or a smaller speed at the apex adds steps only in proportion to the logarithm of the ratio of this speed to the terminal
speed.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.exact.numbers import Wide
from bodycheck.reference.flight.drag.antiderivative import Indices
from bodycheck.reference.flight.drag.motion import Motion, sizes
from bodycheck.reference.flight.elliptic import WideArray
from bodycheck.reference.integration import dop853
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array

#: A solver of the equations; see `cartesian`.
Way = Callable[[Wide, Wide, WideArray, WideArray], WideArray]

#: Time, in sqrt(m / (g c)), after which the velocity differs from the terminal velocity by less than 2e-20 of it.
RELAXED_TIME = 48.0

#: Relative error of the witness by Taylor's method: some hundred steps, each with an error of 2^-60 of the state. The largest
#: observed is 2^-50, after 500 steps.
TAYLOR_ERROR = 2.0**-48

#: Relative error of the witness by DOP853: some hundred steps with the relative error that it allows in each.
DOP853_ERROR = 100 * dop853.RELATIVE_TOLERANCE

#: Number of instants at which DOP853 is compared. Each instant costs at least one step.
DOP853_INSTANTS = 33


@dataclass(frozen=True, eq=False)
class Witness:
    """An independent solution.

    Attributes
    ----------
    name
        Name of the solution and its backend in results.
    instants
        (k,) indices of the instants of comparison, ascending, including the last instant.
    motion
        Positions and velocities at these k instants, with an estimate of their own errors.
    """

    name: str
    instants: Indices
    motion: Motion


@dataclass(frozen=True)
class Units:
    """The equations in suitable units: dv/ds = -resistance |v| v - gravity k, with the time s in the unit `time`.

    Attributes
    ----------
    speed, time
        The units (m/s, s), powers of two.
    resistance, gravity
        The coefficients in these units.
    """

    speed: Wide
    time: Wide
    resistance: Wide
    gravity: Wide


def witness(scene: Scene, times: Array) -> Witness | None:
    """The witness of a translation with drag at ascending times (n,) >= 0, s; None if the integration fails."""
    try:
        from bodycheck.reference.flight.drag import taylor_flight
    except ImportError:
        chosen = np.unique(np.linspace(0, len(times) - 1, min(len(times), DOP853_INSTANTS)).round().astype(int))
        way: Way = _dop853
        name, error = "scipy-dop853", DOP853_ERROR
    else:
        chosen = np.arange(len(times))
        way, name, error = taylor_flight.solve, taylor_flight.BACKEND, TAYLOR_ERROR
    try:
        return Witness(f"three coordinates, {name}", chosen, cartesian(scene, times[chosen], way, error))
    except OutOfReach:
        return None


def cartesian(scene: Scene, times: Array, way: Way, error: float) -> Motion:
    """The translation with drag at ascending times (n,) >= 0, s, integrated in three Cartesian coordinates.

    Parameters
    ----------
    scene
        The scene, with drag.
    times
        The times.
    way
        Solves the equations: maps resistance, gravity, start (6,) and ascending times (n,), all in the witness's units, to
        states (n, 6). Raises `OutOfReach`.
    error
        Relative error of its solution.

    Returns
    -------
    Motion
        Positions and velocities, with an estimate of their errors.
    """
    start, velocity = (np.array(part, dtype=Wide) for part in (scene.initial.position, scene.initial.velocity))
    if not len(times):
        return Motion(np.zeros((0, 3), dtype=Wide), np.zeros((0, 3), dtype=Wide), np.zeros(0), np.zeros(0))
    units = _units(scene, float(times[-1]))
    state = np.concatenate([np.zeros(3, dtype=Wide), velocity / units.speed])
    instants = times.astype(Wide) / units.time
    last = Wide(RELAXED_TIME) / np.sqrt(units.resistance * units.gravity) if units.gravity else instants[-1]
    rows = way(units.resistance, units.gravity, state, np.minimum(instants, last))
    beyond = np.maximum(instants - last, 0)
    if beyond.any():
        rows[:, :3] += beyond[:, None] * rows[:, 3:]
    length = units.speed * units.time
    moved, moving = length * rows[:, :3], units.speed * rows[:, 3:]
    position_error, velocity_error = _errors(scene, moved, moving, times, error)
    rounding = float(np.finfo(Wide).eps * np.abs(start).max())
    return Motion(start + moved, moving, position_error + rounding, velocity_error)


def _units(scene: Scene, end: float) -> Units:
    """Units in which neither the coefficients nor the state at its largest speed is far from 1 in size."""
    resistance, gravity = Wide(scene.drag) / Wide(scene.body.mass), Wide(scene.gravity)
    fastest = Wide(sizes(np.array(scene.initial.velocity, dtype=Wide)))
    if gravity == 0:
        speed, time = fastest, min(1 / (resistance * fastest), Wide(end)) if fastest else Wide(end)
    else:
        terminal, relaxing = np.sqrt(gravity) / np.sqrt(resistance), 1 / (np.sqrt(gravity) * np.sqrt(resistance))
        speed, time = min(terminal, max(fastest, gravity * end)), min(relaxing, Wide(end))
    powers = [Wide(2) ** np.floor(np.log2(size)) if size else Wide(1) for size in (speed, time)]
    return Units(powers[0], powers[1], resistance * powers[0] * powers[1], gravity * powers[1] / powers[0])


def _errors(scene: Scene, moved: WideArray, moving: WideArray, times: Array, error: float) -> tuple[Array, Array]:
    """Estimated errors (n,) of positions (m) and velocities (m/s), from the sizes of path, speed and change of speed so far."""
    speed = sizes(moving).astype(float)
    reach = np.maximum.accumulate(sizes(moved).astype(float) + speed * times)
    # Gravity changes a speed by no more than about the terminal speed before drag balances it.
    terminal = np.sqrt(scene.gravity) * np.sqrt(scene.body.mass) / np.sqrt(scene.drag)
    return error * reach, error * (speed + np.minimum(scene.gravity * times, terminal))


def _dop853(resistance: Wide, gravity: Wide, start: WideArray, times: WideArray) -> WideArray:
    """Solve the equations by SciPy's DOP853, in double precision."""
    c, g = float(resistance), float(gravity)

    def derivative(_t: float, y: Array) -> Array:
        velocity = y[3:]
        force = -c * float(np.sqrt(velocity @ velocity)) * velocity
        force[2] -= g
        return np.concatenate([velocity, force])

    return dop853.solve(derivative, start.astype(float), times.astype(float), np.ones(6)).astype(Wide)
