"""Print the table of docs/contacts.md on rolling friction in MuJoCo. Run: python docs/rolling_friction.py"""

import numpy as np

from bodycheck.adapters import registry
from bodycheck.adapters.contract import Method
from bodycheck.reference.scene import Body, Plane, Scene, Sphere, State
from bodycheck.reference.trajectory import Array

RADIUS, GRAVITY, FRICTION, TIMESTEP_S = 0.1, 9.81, 0.5, 0.001

METHODS = (
    "Euler",
    "Euler:impratio=100",
    "Euler:cone=elliptic",
    "Euler:cone=elliptic,impratio=10",
    "Euler:cone=elliptic,impratio=100",
)
COEFFICIENTS, SPEEDS = (2e-3, 1e-4), (1.0, 0.1)

#: The span in which the deceleration is measured (s), after the ball has sunk into the contact.
BEGIN, END = 0.3, 0.5

#: The part of the rolling friction below which friction is called viscous, and the number of steps of a mean deceleration.
VISCOUS, MEAN = 0.9, 100


def rolling(coefficient: float, speed: float) -> Scene:
    """Return a ball that rolls at a speed (m/s)."""
    start = State((0.0, 0.0, RADIUS), velocity=(speed, 0.0, 0.0), angular_velocity=(0.0, speed / RADIUS, 0.0))
    body = Body(1.0, (0.4 * RADIUS**2,) * 3, Sphere(RADIUS))
    return Scene(body, start, GRAVITY, Plane(FRICTION, rolling_friction=coefficient))


def speeds(scene: Scene, spelling: str, duration: float) -> Array:
    """Return the speeds (n,), m/s, at all steps."""
    method = Method.parse(spelling, TIMESTEP_S)
    steps = np.ones(round(duration / TIMESTEP_S), dtype=np.int64)
    return np.asarray(registry.load("mujoco").prepare([scene], method).advance(steps)[0][:, 0, 7])


def part(coefficient: float, speed: float, spelling: str) -> float:
    """Return the deceleration over that of rolling friction, mu_r g / (1.4 r)."""
    fast = speeds(rolling(coefficient, speed), spelling, END)
    first, last = round(BEGIN / TIMESTEP_S) - 1, round(END / TIMESTEP_S) - 1
    return float((fast[first] - fast[last]) / (END - BEGIN) / (coefficient * GRAVITY / (1.4 * RADIUS)))


def viscous_speed(coefficient: float, spelling: str) -> float:
    """Return the speed (m/s) below which the ball decelerates by less than a part of its rolling friction."""
    exact = coefficient * GRAVITY / (1.4 * RADIUS)
    fast = speeds(rolling(coefficient, 1.0), spelling, 1.2 / exact)[::MEAN]
    slowing = -np.diff(fast) / (MEAN * TIMESTEP_S) / exact
    late = np.flatnonzero((slowing < VISCOUS) & (np.arange(len(slowing)) * MEAN * TIMESTEP_S > BEGIN))
    return float(fast[late[0]]) if len(late) else 0.0


def main() -> None:
    """Print the table."""
    columns = [(coefficient, speed) for coefficient in COEFFICIENTS for speed in SPEEDS]
    heads = [f"μ_r = {coefficient:g} m at {speed:g} m/s" for coefficient, speed in columns]
    print("| " + " | ".join(["method", *heads, "viscous below, m/s, μ_r = 0.002 m"]) + " |")
    print("| --- |" + " --- |" * (len(columns) + 1))
    for spelling in METHODS:
        parts = [f"{part(coefficient, speed, spelling):.3f}" for coefficient, speed in columns]
        print("| " + " | ".join([spelling, *parts, f"{viscous_speed(2e-3, spelling):.2g}"]) + " |", flush=True)


if __name__ == "__main__":
    main()
