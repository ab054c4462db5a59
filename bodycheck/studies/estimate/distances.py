"""The differences between two motions of one scene, by the figures of results that mean the same.

Of a case, they are computed by the formulas of the figures, with the finer run in the place of the truth. Of a file, they have
the same definitions: the largest over all bodies or joints at each instant.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import numpy as np

from bodycheck.adapters.file_motion import Names
from bodycheck.figures.columns import FIGURES
from bodycheck.figures.definition import Comparison
from bodycheck.reference.bounds import NAMES, Bounds
from bodycheck.reference.kinematics import geodesic_angle, normalise
from bodycheck.reference.mechanisms.mechanism import AnyScene
from bodycheck.reference.planar import Stop
from bodycheck.reference.scenes import Scenes
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truths import distance
from bodycheck.running.refining import Motion
from bodycheck.studies.estimate.quantities import NAMED

#: The parts of a motion of a file that have names.
PARTS = tuple(field.name for field in fields(Names))


@dataclass(frozen=True, eq=False)
class Finer:
    """A finer run in the place of the exact motion of a scene."""

    scene: AnyScene | Scenes
    trajectory: Trajectory

    @property
    def bounds(self) -> Bounds:
        """Bounds of zero: what the finer run is worth is estimated by refinement."""
        return Bounds(*(np.zeros(len(self.trajectory.t)) for _ in NAMES))

    @property
    def stop(self) -> Stop | None:
        """None, since no stop is compared."""
        return None


def differences(scene: AnyScene | None, coarse: Motion, fine: Motion, wanted: Sequence[str] = NAMED) -> dict[str, Array]:
    """Return the differences (n,) of two motions at the same instants, by the names of quantities.

    scene: the scene of a case; None for a file. wanted: the quantities of a case; a file has its own.
    """
    if coarse.trajectory is not None and fine.trajectory is not None and scene is not None:
        return _of_case(scene, coarse.trajectory, fine.trajectory, wanted)
    return _of_file(coarse, fine)


def in_common(one: Motion, other: Motion) -> tuple[Motion, Motion]:
    """Return two motions of a file in two engines with what both have, by the names of bodies and joints.

    An engine may join links that have no joint between them, which moves the centre of mass. Positions are therefore left out
    unless both engines have the same bodies.
    """
    same_bodies = sorted(one.names.bodies) == sorted(other.names.bodies)
    shared = {part: set(getattr(one.names, part)) & set(getattr(other.names, part)) - {""} for part in PARTS}

    def picked(motion: Motion) -> Motion:
        rows = {part: [getattr(motion.names, part).index(name) for name in sorted(shared[part])] for part in PARTS}
        return replace(
            motion,
            position=motion.position[rows["bodies"] if same_bodies else []],
            quaternion=motion.quaternion[rows["bodies"]],
            angles=motion.angles[rows["angles"]],
            turns=motion.turns[rows["turns"]],
            slides=motion.slides[rows["slides"]],
            energy=None,
        )

    return picked(one), picked(other)


def _of_case(scene: AnyScene, coarse: Trajectory, fine: Trajectory, wanted: Sequence[str]) -> dict[str, Array]:
    compared = Comparison(Finer(scene, fine), coarse)
    series = {name: FIGURES[name].compute(compared) for name in wanted}
    return {name: values for name, values in series.items() if isinstance(values, np.ndarray)}


def _of_file(coarse: Motion, fine: Motion) -> dict[str, Array]:
    series = {
        "attitude_error": _turned(coarse.quaternion, fine.quaternion),
        "position_error": distance(coarse.position, fine.position),
        "joint_position_error": np.concatenate(
            [np.abs(coarse.angles - fine.angles), _turned(coarse.turns, fine.turns)], axis=0
        ),
        "joint_slide_error": distance(coarse.slides, fine.slides),
    }
    largest = {name: np.asarray(values.max(axis=0)) for name, values in series.items() if len(values)}
    if coarse.energy is not None:
        largest["energy_drift"] = _drift(coarse.energy)
    return largest


def _drift(energy: Array) -> Array:
    """Return the drift (n,) of a total energy, relative to the initial kinetic energy or, if that is zero, to the largest.

    energy: the potential and the kinetic energy (2, n), J.
    """
    total, kinetic = energy.sum(axis=0), energy[1]
    return np.asarray(np.abs(total - total[0]) / (kinetic[0] or kinetic.max() or 1.0))


def _turned(one: Array, other: Array) -> Array:
    return geodesic_angle(normalise(one), normalise(other)) if len(one) else np.empty((0, one.shape[1]))
