"""Two spheres that hit each other, for tests."""

import numpy as np

from bodycheck.reference.mechanisms.mechanism import BodyStart, JointedBody, Mechanism, PairContact
from bodycheck.reference.scene import Plane, Solid, Sphere, Vector
from bodycheck.reference.trajectory import Trajectory
from bodycheck.reference.truth import truth

ORIGIN: Vector = (0.0, 0.0, 0.0)


def sphere(
    name: str, position: Vector, velocity: Vector = ORIGIN, spin: Vector = ORIGIN, *, radius: float = 0.1, mass: float = 1.0
) -> JointedBody:
    """A homogeneous sphere."""
    start = BodyStart(position, (1.0, 0.0, 0.0, 0.0), velocity, spin)
    return JointedBody(name, Solid(Sphere(radius), mass), start=start)


def pair(
    first: JointedBody,
    second: JointedBody,
    friction: float,
    restitution: float,
    gravity: float = 0.0,
    plane: Plane | None = None,
) -> Mechanism:
    """Two spheres that touch each other, and a plane if there is one."""
    contact = PairContact((0, 1), friction, restitution)
    return Mechanism((first, second), gravity=gravity, plane=plane, contacts=(contact,))


def random_pair(seed: int) -> Mechanism:
    """Two spheres in space, on a plane without friction between them, or thrown over a plane, most of which hit each other."""
    rng = np.random.default_rng(seed)

    def part(size: float) -> float:
        return float(rng.uniform(-size, size))

    def spin() -> Vector:
        fast = rng.choice([0.0, 5.0, 40.0])
        return part(fast), part(fast), part(fast)

    kind = ("space", "plane", "thrown")[seed % 3]
    radii = [0.1, 0.1 if kind == "plane" else float(rng.choice([0.05, 0.1, 0.2]))]
    height = radii[0] if kind == "plane" else 0.6
    rise = 0.0 if kind == "plane" else part(1.0)
    starts = [
        ((-0.5, part(0.1), height), (float(rng.uniform(1, 3)), 0.0, rise)),
        ((0.3, part(0.1), height), (float(rng.uniform(-2, 0)), 0.0, rise)),
    ]
    masses = [float(rng.choice([0.17, 1.0, 2.5])) for _ in range(2)]
    bodies = [
        sphere(name, *start, spin(), radius=radius, mass=mass)
        for name, start, radius, mass in zip(("first", "second"), starts, radii, masses, strict=True)
    ]
    friction = 0.0 if kind == "plane" else float(rng.choice([0.0, 0.1, rng.uniform(0, 1)]))
    restitution = float(rng.choice([0.3, 0.9, 1.0, rng.uniform(0.1, 1)]))
    plane = None if kind == "space" else Plane(float(rng.choice([0.0, 0.2])), restitution=float(rng.choice([0.0, 0.5, 1.0])))
    gravity = float(rng.choice([0.0, 9.81])) if plane is None else 9.81
    return pair(bodies[0], bodies[1], friction, restitution, gravity, plane)


def moved(scene: Mechanism, last: float = 1.5, samples: int = 16) -> Trajectory:
    """The motion of a scene by its truth."""
    return truth(scene, np.linspace(0.0, last, samples)).trajectory
