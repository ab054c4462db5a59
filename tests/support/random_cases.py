"""Random cases of bodies in free flight, regime by regime: the texts of their files.

A case follows from its regime and its seed. In every regime the body has any mass, size and attitude, turns by 1e-3 to 1e6 rad
within the duration, and in half of the cases also flies and falls.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from tests.support.cases import a_case
from tests.support.multiprecision.arithmetic import MP, Matrix, real, vector
from tests.support.multiprecision.attitudes import from_quaternion

Table = dict[str, Any]
Random = np.random.Generator

#: Digits of a range that a power of ten is drawn from: turns (rad), rates (rad/s) of all regimes but one, and of that one.
TURN, RATE, ANY_RATE = (-3.0, 6.0), (-1.0, 2.0), (-9.0, 9.0)

#: The smallest number but zero that a case file may contain.
SMALLEST = 1e-100

#: Instants at which a case is looked at, the last one at its end.
INSTANTS = 6


def drawn(regime: str, seed: int) -> tuple[str, list[float]]:
    """The text of the case of a regime and a seed, and the ascending instants (s) at which to look at it."""
    rng = np.random.default_rng([list(REGIMES).index(regime), seed])
    body, initial = REGIMES[regime](rng)
    turn = initial.get("angular_velocity") or initial["euler_rates"]
    duration = power(rng, *TURN) / float(np.linalg.norm(turn))
    initial |= attitude(rng) if "euler_rates" not in initial else {}
    scene = None
    if rng.random() < 0.5:
        initial |= {"position": rng.normal(0, 3, 3).tolist(), "velocity": rng.normal(0, 5, 3).tolist()}
        scene = {"gravity": float(rng.choice([9.81, 1.62, 0.0]))}
    text = a_case(f"{regime}-{seed}", body=body, initial=initial, scene=scene, run={"duration": duration, "samples": INSTANTS})
    return text, [*np.sort(rng.uniform(0, duration, INSTANTS - 1)).tolist(), duration]


def power(rng: Random, low: float, high: float) -> float:
    """A power of ten whose exponent is evenly distributed."""
    return float(10 ** rng.uniform(low, high))


def attitude(rng: Random) -> Table:
    """An attitude as a case file states it: none, a quaternion of nearly unit length, or Euler angles."""
    kind = rng.integers(4)
    if kind == 0:
        return {}
    if kind == 1:
        return {"euler_zxz": rng.uniform(-np.pi, np.pi, 3).tolist()}
    parts = rng.normal(size=4)
    return {"quaternion": (parts / np.linalg.norm(parts) * rng.uniform(0.9992, 1.0008)).tolist()}


def spin(rng: Random, direction: Any = None, rates: tuple[float, float] = RATE) -> Table:
    """An angular velocity in the body frame along a direction, by default any."""
    along = rng.normal(size=3) if direction is None else np.asarray(direction, dtype=float)
    return {"angular_velocity": (along * (power(rng, *rates) / float(np.linalg.norm(along)))).tolist()}


def given(rng: Random, moments: Any, axes: Matrix | None = None) -> Table:
    """A body given by its moments, or by the tensor with these moments along the columns of a rotation matrix, rounded."""
    mass = power(rng, -2, 2)
    if axes is None:
        return {"shape": "none", "mass": mass, "inertia": [float(moment) for moment in moments]}
    tensor = axes * MP.diag([real(float(moment)) for moment in moments]) * axes.T
    rows = np.array([[float(tensor[max(i, j), min(i, j)]) for j in range(3)] for i in range(3)])
    rows[np.abs(rows) < SMALLEST] = 0.0  # of a sphere, where the products of inertia are rounding
    return {"shape": "none", "mass": mass, "inertia": rows.tolist()}


def turned(rng: Random) -> Matrix:
    """Any rotation matrix."""
    return from_quaternion([real(part) for part in rng.normal(size=4).tolist()])


def along(axes: Matrix, components: Any) -> list[float]:
    """A vector in the body frame, rounded, from its components along the columns of a rotation matrix."""
    return [float(each) for each in axes * vector(map(float, components))]


def moments_of(second: Any) -> list[float]:
    """Principal moments of a body with these second moments along its axes."""
    a, b, c = (float(each) for each in second)
    return [b + c, c + a, a + b]


def any_moments(rng: Random) -> list[float]:
    """Moments of a body whose extents differ by less than a factor of ten."""
    return moments_of(power(rng, -3, 1) * 10 ** rng.uniform(-1.8, 0, 3))


def solid(rng: Random) -> Table:
    """A homogeneous solid."""
    shape = str(rng.choice(["brick", "ellipsoid", "cylinder", "sphere"]))
    sizes = (10 ** rng.uniform(-1.5, 0, 3)).tolist()
    own: Table = {"shape": shape, "mass": power(rng, -2, 2)}
    match shape:
        case "cylinder":
            return own | {"radius": sizes[0], "half_length": sizes[1]}
        case "sphere":
            return own | {"radius": sizes[0]}
        case _:
            return own | {"semi_axes": sizes}


def brick(rng: Random) -> tuple[Table, Table]:
    """A brick or an ellipsoid along its axes, or moments."""
    if rng.random() < 0.3:
        return given(rng, any_moments(rng)), spin(rng)
    sizes = (10 ** rng.uniform(-1.5, 0, 3)).tolist()
    return {"shape": str(rng.choice(["brick", "ellipsoid"])), "mass": power(rng, -2, 2), "semi_axes": sizes}, spin(rng)


def tensor(rng: Random) -> tuple[Table, Table]:
    """A tensor in a frame that is not that of the principal axes."""
    return given(rng, any_moments(rng), turned(rng)), spin(rng)


def slender(rng: Random, axes: Matrix | None = None) -> tuple[Table, Table]:
    """Moments in ratios down to 1e-12, of needles and of discs."""
    thin = 10 ** rng.uniform(-12, -1, 2)
    second = rng.permutation([thin[0], thin[1] if rng.random() < 0.7 else rng.uniform(0.2, 1), 1.0]) * power(rng, -3, 1)
    return given(rng, moments_of(second), axes), spin(rng)


def composite(rng: Random) -> tuple[Table, Table]:
    """Two to ten solids in any places and attitudes."""
    parts = []
    for _ in range(rng.integers(2, 11)):
        part = solid(rng) | {"position": rng.normal(size=3).tolist()} | attitude(rng)
        if "quaternion" in part:  # here it may have any length
            part["quaternion"] = (np.array(part["quaternion"]) * power(rng, -2, 2)).tolist()
        parts.append(part)
    return {"parts": parts}, spin(rng)


def particles(rng: Random) -> tuple[Table, Table]:
    """Three to ten particles in general position, in half of the cases far from the origin of their frame."""
    origin = rng.normal(size=3) * (power(rng, 0, 4) if rng.random() < 0.5 else 0.0)
    count = rng.integers(3, 11)
    found = [{"mass": power(rng, -2, 2), "position": (origin + rng.normal(size=3)).tolist()} for _ in range(count)]
    return {"particles": found}, spin(rng)


def nearly_in_line(rng: Random) -> tuple[Table, Table]:
    """Heavy particles on a line, and two next to it at a distance down to 1e-7 of its length: a moment ratio of 1e-14."""
    axes, off, heavy, light = turned(rng), power(rng, -7, -3), rng.uniform(1, 5), rng.uniform(1, 5)
    found = [{"mass": float(heavy), "position": along(axes, (sign * rng.uniform(0.5, 1), 0, 0))} for sign in (1, -1)]
    for sign in (1, -1):
        place = (rng.uniform(-0.3, 0.3), sign * off, off * rng.normal() * 0.5)
        found.append({"mass": float(light), "position": along(axes, place)})
    return {"particles": found}, spin(rng)


def separatrix(rng: Random, axes: Matrix | None = None) -> tuple[Table, Table]:
    """A motion that misses the separatrix by 1e-2 to 1e-14: a spin about the middle axis, or one that starts on its way."""
    if axes is None and rng.random() < 0.05:  # exactly on it: the numbers are those of I3 (I3 - I2) w3^2 = I1 (I2 - I1) w1^2
        return given(rng, (4.0, 5.0, 9.0)), {"angular_velocity": [3.0, float(rng.normal()), 1.0]}
    i1, i2, i3 = sorted(any_moments(rng))
    off = power(rng, -14, -2)
    if rng.random() < 0.6:
        rates = np.array([off * rng.normal(), rng.choice([-1, 1]), off * rng.normal()])
    else:
        across = np.sqrt([i3 * (i3 - i2) * (1 + off * rng.choice([-1, 1])), i1 * (i2 - i1)])
        across *= rng.uniform(0.1, 1) / np.linalg.norm(across)
        rates = np.array([across[0] * rng.choice([-1, 1]), rng.normal(), across[1] * rng.choice([-1, 1])])
    order = rng.permutation(3)
    moments, rates = np.array([i1, i2, i3])[order], rates[order] * power(rng, *RATE)
    seen = rates.tolist() if axes is None else along(axes, rates)
    return given(rng, moments, axes), {"angular_velocity": seen}


def principal_spin(rng: Random) -> tuple[Table, Table]:
    """A spin exactly about a principal axis, of a body in its principal axes."""
    return brick(rng)[0], spin(rng, np.eye(3)[rng.integers(3)] * rng.choice([-1, 1]))


def turned_principal_spin(rng: Random) -> tuple[Table, Table]:
    """A spin about a principal axis of a tensor in another frame: up to rounding, or exactly, along a diagonal of two axes."""
    if rng.random() < 0.5:
        axes = turned(rng)
        rates = along(axes, np.eye(3)[rng.integers(3)] * power(rng, *RATE))
        return given(rng, any_moments(rng), axes), {"angular_velocity": rates}
    one, other, third = any_moments(rng)
    mean, half = (one + other) / 2, (one - other) / 2
    rows = [[mean, half, 0.0], [half, mean, 0.0], [0.0, 0.0, third]]
    direction = [(1, 1, 0), (1, -1, 0), (0, 0, 1)][rng.integers(3)]
    rate = power(rng, *RATE)
    body = {"shape": "none", "mass": power(rng, -2, 2), "inertia": rows}
    return body, {"angular_velocity": [rate * part for part in direction]}


def symmetric_top(rng: Random) -> tuple[Table, Table]:
    """Two moments exactly equal: a cylinder, moments, or a tensor that is symmetric about the diagonal of all axes."""
    kind = rng.integers(3)
    if kind == 0:
        sizes = (10 ** rng.uniform(-1.5, 0, 2)).tolist()
        return {"shape": "cylinder", "mass": power(rng, -2, 2), "radius": sizes[0], "half_length": sizes[1]}, spin(rng)
    if kind == 1:
        across, own = 10 ** rng.uniform(-2, 0, 2)
        return given(rng, np.roll(moments_of([across, across, own]), rng.integers(3))), spin(rng)
    diagonal = power(rng, -3, 1)
    off = diagonal * float(rng.uniform(-0.45, 0.24))  # the moments are a - b, twice, and a + 2 b
    rows = [[diagonal if i == j else off for j in range(3)] for i in range(3)]
    return {"shape": "none", "mass": power(rng, -2, 2), "inertia": rows}, spin(rng)


def nearly_symmetric(rng: Random) -> tuple[Table, Table]:
    """Two moments that differ by 1e-4 to 1e-16, along the principal axes or in another frame."""
    across, own = 10 ** rng.uniform(-2, 0, 2)
    second = np.roll([across, across * (1 + power(rng, -16, -4)), own], rng.integers(3))
    return given(rng, moments_of(second), turned(rng) if rng.random() < 0.5 else None), spin(rng)


def sphere(rng: Random) -> tuple[Table, Table]:
    """Three equal moments, exactly, or up to rounding and a little more."""
    if rng.random() < 0.5:
        return {"shape": "sphere", "mass": power(rng, -2, 2), "radius": power(rng, -1.5, 0)}, spin(rng)
    near = power(rng, -3, 1) * (1 + power(rng, -17, -4) * rng.normal(size=3))
    return given(rng, moments_of(near), turned(rng) if rng.random() < 0.5 else None), spin(rng)


def any_rate(rng: Random) -> tuple[Table, Table]:
    """Rates from 1e-9 to 1e9 rad/s, along the principal axes or in another frame."""
    return given(rng, any_moments(rng), turned(rng) if rng.random() < 0.5 else None), spin(rng, rates=ANY_RATE)


def euler_rates(rng: Random) -> tuple[Table, Table]:
    """Rates of Euler angles, also where K is vertical, of a body along its axes or in another frame."""
    initial = attitude(rng)
    if rng.random() < 0.2:
        initial = {"euler_zxz": [float(rng.normal()), 0.0, float(rng.normal())]}
    rates = rng.normal(size=3) * power(rng, *RATE)
    body = given(rng, any_moments(rng), turned(rng) if rng.random() < 0.5 else None)
    return body, initial | {"euler_rates": rates.tolist()}


#: Every regime: a function from a generator of random numbers to the tables [body] and [initial] of a case file.
REGIMES: dict[str, Callable[[Random], tuple[Table, Table]]] = {
    "principal-frame": brick,
    "turned-frame": tensor,
    "slender": slender,
    "slender-turned": lambda rng: slender(rng, turned(rng)),
    "composite": composite,
    "particles": particles,
    "nearly-in-line": nearly_in_line,
    "separatrix": separatrix,
    "separatrix-turned": lambda rng: separatrix(rng, turned(rng)),
    "principal-spin": principal_spin,
    "principal-spin-turned": turned_principal_spin,
    "symmetric-top": symmetric_top,
    "nearly-symmetric": nearly_symmetric,
    "sphere": sphere,
    "any-rate": any_rate,
    "euler-rates": euler_rates,
}
