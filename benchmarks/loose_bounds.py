"""Compare the printed bounds of truths with the distances that proofs find.

For each shipped case that is enclosed, the largest bound of each quantity along the motion is divided by its largest proved
distance from the exact value, or by half a unit in the last place of the largest value if that is more. The cases are printed
with the largest of these ratios and its quantity, the loosest first. Quantities that are zero all along a motion have no such
ratio: there, the largest bound is printed. With `--roundings`, trees alone are proved, shipped ones and random ones of
`benchmarks/proofs.py`, and the least value of `CAUTION` in `reference/mechanisms/growth.py` is printed with which no bound of a
state is below its proof, for several values of `TOGETHER`; 0 where the rounding to doubles covers all.

Run: python benchmarks/loose_bounds.py [CASE ...] [--limit 20] [--roundings] [--scenes 44]
"""

import argparse
import sys
from collections.abc import Iterator

import numpy as np

from bodycheck.casefile.case import load
from bodycheck.reference.bounds import EPS, NAMES, STATES
from bodycheck.reference.candidate import candidate_of
from bodycheck.reference.certified import joint_bounds
from bodycheck.reference.mechanisms import growth
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.mechanisms.observables import masses
from bodycheck.reference.mechanisms.observables import observe as observe_mechanism
from bodycheck.reference.observables import observe
from bodycheck.reference.proof.enclosure import COORDINATES, Enclosure
from bodycheck.reference.proof.one_joint import has_one_joint
from bodycheck.reference.proof.proving import enclosed
from bodycheck.reference.trajectory import Array
from bodycheck.reference.truth import truth
from bodycheck.reference.truths import Truth
from bodycheck.running.certificates import certificates
from tests.support.proved_scenes import two_links

#: The values of `TOGETHER` that are compared; the last one takes all earlier instants together.
TOGETHER = (growth.TOGETHER, 1.0, 10.0, 1000.0, growth.LARGEST)

#: The duration (s) of the random trees, and the number of their instants.
DURATION, INSTANTS = 0.1, 9


def main() -> int:
    """Prove the cases, and print the ratios."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("case", nargs="*", help="names of shipped cases; by default all that are enclosed")
    parser.add_argument("--limit", type=float, default=20.0, help="leave out cases whose proof needs more (s)")
    parser.add_argument("--roundings", action="store_true", help="compare values of constants on trees")
    parser.add_argument("--scenes", type=int, default=44, help="number of random trees, with `--roundings`")
    options = parser.parse_args()
    known = certificates()
    names = options.case or [name for name, each in known.items() if each.word == "enclosed" and each.seconds < options.limit]
    if options.roundings:
        print(f"| scene | {' | '.join(f'{together:g}' for together in TOGETHER)} |")
        print(f"| --- |{' ---: |' * len(TOGETHER)}")
        for name, scene, times in _trees(names, options.scenes):
            print(f"| {name} | {' | '.join(f'{caution:.3g}' for caution in least_cautions(scene, times))} |", flush=True)
        return 0
    print("| case | bound / distance | quantity | bound | distance |\n| --- | ---: | --- | ---: | ---: |")
    found = {name: looseness(load(name).scene, _instants(name)) for name in names}
    rows = sorted(((*max(ratios), name) for name, (ratios, _) in found.items() if ratios), reverse=True)
    for ratio, quantity, bound, apart, name in rows:
        print(f"| {name} | {ratio:.3g} | {quantity} | {bound:.1e} | {apart:.1e} |")
    zeros = sorted(((bound, name, quantity) for name, (_, still) in found.items() for quantity, bound in still), reverse=True)
    print(f"\n{len(zeros)} quantities are zero all along; their largest bounds:")
    for bound, name, quantity in zeros[:5]:
        print(f"{bound:.1e}: {name}, {quantity}")
    return 0


def _instants(name: str) -> Array:
    """The instants (n,), s, at which `docs/proved.py` proves a case."""
    case = load(name)
    many = not isinstance(case.scene, Mechanism) or has_one_joint(case.scene)
    return np.linspace(0.0, case.duration, 1001) if many else case.instants


def _trees(names: list[str], count: int) -> Iterator[tuple[str, AnyScene, Array]]:
    """Shipped cases that are proved as trees, and some random trees, with their instants (n,), s."""
    for name in names:
        if "validated" in certificates()[name].way:
            yield name, load(name).scene, _instants(name)
    for seed in range(count):
        yield f"two links, seed {seed}", two_links(seed), np.linspace(0.0, DURATION, INSTANTS)


def looseness(scene: AnyScene, times: Array) -> tuple[list[tuple[float, str, float, float]], list[tuple[str, float]]]:
    """Return of each quantity the ratio of its bound to its proved distance, its name, its bound and the distance.

    Those that are zero all along the motion come separately, with their names and bounds.
    """
    found = truth(scene, times)
    proof = enclosed(scene, found.trajectory, found.joints, candidate_of(scene))
    ratios, still = [], []
    for name, bound in _bounds(found, proof).items():
        largest, apart = np.nanmax(bound, initial=0.0), np.nanmax(proof.farthest[name], initial=0.0)
        least = max(apart, EPS / 2 * _size(found, name))
        if not np.isfinite(largest):  # of another type of joint
            continue
        if least:
            ratios.append((largest / least, name, largest, apart))
        elif largest:
            still.append((name, largest))
    return ratios, still


def least_cautions(scene: AnyScene, times: Array) -> Iterator[float]:
    """Yield for each of `TOGETHER` the least `CAUTION` with which no bound of a state is below its proved distance.

    A bound is a number that does not depend on `CAUTION`, plus one that is proportional to it.
    """
    found = truth(scene, times)
    proof = enclosed(scene, found.trajectory, found.joints, candidate_of(scene))
    for growth.TOGETHER in TOGETHER:
        growth.CAUTION = 0.0
        least = truth(scene, times, vouched=False).bounds.of_states()
        growth.CAUTION = 1.0
        once = truth(scene, times, vouched=False).bounds.of_states()
        lacking = [np.maximum(proof.nearest[name] - least[name], 0.0) for name in STATES]
        rates = [once[name] - least[name] for name in STATES]
        yield max(
            float(np.max(lack[lack > 0] / rate[lack > 0], initial=0.0)) for lack, rate in zip(lacking, rates, strict=True)
        )


def _bounds(found: Truth, proof: Enclosure) -> dict[str, Array]:
    """The printed bounds of a truth, by the names of the quantities."""
    bounds = {name: getattr(found.bounds, name) for name in NAMES}
    if COORDINATES[0] in proof.nearest:
        assert isinstance(found.scene, Mechanism)
        assert found.joints is not None
        of_joints = joint_bounds(found.scene, found.trajectory, found.joints, found.bounds)
        bounds |= dict(zip(COORDINATES, of_joints, strict=True))
    return bounds


def _size(found: Truth, name: str) -> float:
    """The size of the largest value of a quantity of a truth, whose rounding its bound has to include."""
    motion = found.trajectory
    match name:
        case "error":
            return 1.0
        case "position_error" | "velocity_error" | "angular_velocity_error":
            return float(np.nanmax(np.abs(getattr(motion, name.removesuffix("_error"))), initial=0.0))
        case "joint_position_error" | "joint_velocity_error":
            assert found.joints is not None
            values = found.joints.position if name == COORDINATES[0] else found.joints.velocity
            return float(np.abs(values).max(initial=0.0))
    scene, of_bodies = found.scene, (-1, len(motion.t), 3)
    places, speeds = (np.linalg.norm(each.reshape(of_bodies), axis=2) for each in (motion.position, motion.velocity))
    seen = observe_mechanism(scene, motion) if isinstance(scene, Mechanism) else observe(scene, motion)
    mass = masses(scene) if isinstance(scene, Mechanism) else np.array([scene.body.mass])
    if name == "energy_error":
        parts = seen.kinetic_energy + np.abs(seen.potential_energy) + scene.gravity * (mass @ places)
    else:
        parts = np.linalg.norm(seen.angular_momentum, axis=-1) + mass @ (places * speeds)
    return float(np.nanmax(parts, initial=0.0))


if __name__ == "__main__":
    sys.exit(main())
