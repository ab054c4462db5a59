"""The models of several scenes in MuJoCo, as many at a time as are rolled out together.

MuJoCo takes about a millisecond to compile an XML text. Scenes in flight whose models differ only in the mass, the moments of
inertia and gravity have copies of one compiled model instead, in which these numbers, and the numbers that MuJoCo derives from
them (`mj_setConst`), are set. The copies then equal the models from XML in every number that matters in a flight, and serve one
group of scenes after another. Only the mean inertia, by which MuJoCo scales the tolerance of its constraint solver, stays the
mean inertia of the first model.
"""

import copy
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array

#: The largest number of copies of a model. A copy takes about as much memory and time as compiling a model from XML.
COPIES = 32

#: The number of the body in its model; number 0 is the world.
BODY = 1


@dataclass(frozen=True)
class Models:
    """The models of several scenes.

    Parameters
    ----------
    at
        Returns the models of the scenes with the given indices. They are valid until the next call.
    most
        The largest number of indices in a call.
    """

    at: Callable[[Sequence[int]], list[mujoco.MjModel]]
    most: int


def compiled(models: Sequence[mujoco.MjModel]) -> Models:
    """Return the models of scenes that were compiled separately."""
    return Models(lambda places: [models[index] for index in places], len(models))


def with_bodies(model: mujoco.MjModel, scenes: Sequence[Scene]) -> Models:
    """Return models of scenes that differ from a compiled one in the mass, the moments and gravity alone.

    Parameters
    ----------
    model
        The compiled model of the first scene.
    scenes
        The scenes. Their bodies have the same principal axes as the first body, and MuJoCo accepts them (see `may_be_refused`).
    """
    numbers = numbers_of(scenes)
    if (numbers == numbers[0]).all():
        return Models(lambda places: [model] * len(places), len(scenes))
    copies = [copy.copy(model) for _ in range(min(COPIES, len(scenes)))]
    data = mujoco.MjData(model)

    def at(places: Sequence[int]) -> list[mujoco.MjModel]:
        chosen = copies[: len(places)]
        for copied, (mass, *moments, gravity) in zip(chosen, numbers[list(places)].tolist(), strict=True):
            copied.body_mass[BODY], copied.body_inertia[BODY], copied.opt.gravity[2] = mass, moments, -gravity
            mujoco.mj_setConst(copied, data)
        return chosen

    return Models(at, len(copies))


def numbers_of(scenes: Sequence[Scene]) -> Array:
    """Return the mass (kg), the three moments (kg m^2) and the gravity (m/s^2) of scenes, as (scenes, 5)."""
    return np.array([(scene.body.mass, *scene.body.moments, scene.gravity) for scene in scenes])


def may_be_refused(scenes: Sequence[Scene]) -> list[int]:
    """Return the indices of scenes whose bodies MuJoCo may refuse, so that their models must be compiled to find out.

    MuJoCo refuses bodies with almost no mass or moment (see `mujoco.mjMINVAL`), and moments that no body can have: it compares
    rounded sums of moments.
    """
    mass, a, b, c, _ = numbers_of(scenes).T
    tiny = np.minimum(mass, np.minimum(np.minimum(a, b), c)) <= 10 * mujoco.mjMINVAL
    return np.flatnonzero(tiny | ~((a + b >= c) & (b + c >= a) & (c + a >= b))).tolist()
