"""Measure the truth of chains: its bound, until when it is known, the growth of an error, and what it costs.

The rods are uniform, of 1 kg each. In a plane they fall from the horizontal, hinged about one axis; in space they are hinged
about y and x in turn, with all angles 0.7 rad at the start. All start at rest. Costs are CPU times of a second truth of the
chain in this process; those of the first contain the compilation, which heyoka keeps on disk. Then truths of random mechanisms
are compared with arithmetic of 160 bits. Run: python benchmarks/mechanism_truth.py [--random 10]
"""

import argparse
import time
from collections.abc import Callable

import numpy as np

from bodycheck.reference.bounds import STATES
from bodycheck.reference.mechanisms import recursion
from bodycheck.reference.mechanisms.certificate import rounded_to_wide
from bodycheck.reference.mechanisms.coordinates import COORDINATES, VELOCITIES
from bodycheck.reference.mechanisms.followed import followed
from bodycheck.reference.mechanisms.joint_types import JointType
from bodycheck.reference.mechanisms.mechanism import Joint, JointedBody, Mechanism
from bodycheck.reference.mechanisms.truth import known_until, mechanism_truth
from bodycheck.reference.mechanisms.ways import Motion, apart
from bodycheck.reference.scene import Tensor
from bodycheck.reference.trajectory import Trajectory
from bodycheck.reference.truths import Truth

#: The chains: number of rods, length of a rod (m), and whether they are hinged in space.
CHAINS = ((10, 1.0, False), (10, 1.0, True), (20, 1.0, False), (20, 1.0, True), (10, 0.1, False))

#: Instants of a chain (s).
TIMES = np.linspace(0.0, 5.0, 101)

#: The joints of random mechanisms.
TYPES: tuple[JointType, ...] = ("revolute", "prismatic", "spherical", "universal", "planar", "free")

#: Bits of the mantissa of what random mechanisms are compared with.
BITS = 160


def chain(rods: int, length: float, spatial: bool) -> Mechanism:
    """A chain of rods."""
    moment = length**2 / 12
    inertia = Tensor(1.0, ((moment, 0.0, 0.0), (0.0, moment, 0.0), (0.0, 0.0, 0.0)))
    bodies = tuple(JointedBody(f"rod-{n}", inertia, (0.0, 0.0, -length / 2)) for n in range(rods))
    joints = []
    for n in range(rods):
        axis = (1.0, 0.0, 0.0) if spatial and n % 2 else (0.0, 1.0, 0.0)
        angle = 0.7 if spatial else float(np.pi / 2 * (n == 0))
        place = (0.0, 0.0, -length if n else 0.0)
        joints.append(Joint(f"hinge-{n}", "revolute", n - 1, n, place, axis=axis, start=(angle,), start_velocity=(0.0,)))
    return Mechanism(bodies, tuple(joints), gravity=9.81)


def random_mechanism(random: np.random.Generator) -> Mechanism:
    """Up to three bodies on joints of any type, with random frames, inertia, springs, damping and start."""

    def some(count: int) -> tuple[float, ...]:
        return tuple(random.normal(size=count).tolist())

    bodies, joints = [], []
    for n in range(int(random.integers(1, 4))):
        kind = TYPES[int(random.integers(len(TYPES)))]
        a, b, c = (random.uniform(0.01, 0.02, 3) + 0.01).tolist()
        tensor = Tensor(float(random.uniform(0.5, 2.0)), ((a, 0.001, 0.0), (0.001, b, 0.002), (0.0, 0.002, c)))
        x, y, z = some(3)
        bodies.append(JointedBody(f"body-{n}", tensor, (x, y, z)))
        along = {"axis": some(3), "armature": 0.1, "stiffness": 3.0, "rest": 0.1, "effort": 0.2}
        damped = kind in ("revolute", "prismatic")
        own = {**along, "damping": float(random.choice([0.0, 0.3]))} if damped else {}
        begin = {"start": some(COORDINATES[kind]), "start_velocity": some(VELOCITIES[kind])}
        joints.append(
            Joint(f"joint-{n}", kind, int(random.integers(-1, n)) if n else -1, n, *(some(3), some(4)), **own, **begin)
        )  # type: ignore[arg-type]
    return Mechanism(tuple(bodies), tuple(joints), gravity=9.81)


def timed(compute: Callable[[], Truth]) -> tuple[Truth, float]:
    """A truth that is computed for the second time, and its CPU time (s)."""
    compute()
    start = time.process_time()
    return compute(), time.process_time() - start


def chains() -> None:
    """Print a line for each chain."""
    print("| rods | length m | in | growth | bound at 5 s, rad | known to 1e-9 rad until s | cost s | with witness s |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- |")
    for rods, length, spatial in CHAINS:
        mechanism = chain(rods, length, spatial)
        _, alone = timed(lambda own=mechanism: mechanism_truth(own, TIMES, vouched=False))
        found, vouched = timed(lambda own=mechanism: mechanism_truth(own, TIMES))
        assert found.growth is not None
        print(
            f"| {rods} | {length:g} | {'space' if spatial else 'plane'} | {found.growth[-1]:.1e} "
            f"| {found.bounds.error[-1]:.1e} | {known_until(found)} | {alone:.2f} | {vouched:.2f} |",
            flush=True,
        )


def against_multiprecision(count: int) -> None:
    """Print how the bounds of random mechanisms compare with their errors."""
    import heyoka

    random, times, ratios, tight = np.random.default_rng(0), np.linspace(0.0, 3.0, 13), list[float](), list[float]()
    for _ in range(count):
        mechanism = random_mechanism(random)
        way = followed(mechanism, times).way
        found = recursion.follow(mechanism, times, heyoka.real, BITS)
        bodies = found.bodies
        states = bodies.position, bodies.quaternion, bodies.velocity, bodies.angular_velocity
        exact = Motion(
            rounded_to_wide(found.position),
            rounded_to_wide(found.velocity),
            Trajectory(times, *(rounded_to_wide(each) for each in states)),
        )
        off = apart(mechanism, way.motion, exact)
        ratios.append(max(float(np.max(off[name] / way.errors[name])) for name in STATES))
        tight.append(max(float(way.errors[name][-1] / max(off[name].max(), 1e-30)) for name in STATES))
    print(f"\n{count} random mechanisms: the largest error is {max(ratios):.2f} of its bound;")
    print(f"the bound at the end is {np.median(tight):.0f} times the error in the median, {max(tight):.0f} times at most")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--random", type=int, default=10, help="number of random mechanisms")
    arguments = parser.parse_args()
    chains()
    against_multiprecision(arguments.random)
