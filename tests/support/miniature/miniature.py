"""Miniature engines that test the harness: each moves a body in free flight in closed form and spoils it in its own way.

They know spins about a principal axis only, so that their exact motion needs no integration.
"""

import ctypes
import math
import os
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from bodycheck.reference.requirements import missing

Spoil = Callable[[float, np.ndarray], np.ndarray]


def exact(t: float, row: np.ndarray) -> np.ndarray:
    return row


def wrong(t: float, row: np.ndarray) -> np.ndarray:
    """Always wrong: the whole motion one metre aside, and every velocity doubled."""
    row[0] += 1.0
    row[7:] *= 2.0
    return row


def drifting(t: float, row: np.ndarray) -> np.ndarray:
    """Gains speed: one per mille of its angular velocity a second."""
    row[10:] *= 1 + 1e-3 * t
    return row


def exploding(t: float, row: np.ndarray) -> np.ndarray:
    row[7:10] += math.exp(50 * t)
    return row


def not_a_number(t: float, row: np.ndarray) -> np.ndarray:
    return row if t < 0.5 else row * math.nan


def raising(t: float, row: np.ndarray) -> np.ndarray:
    raise RuntimeError("the miniature engine gives up")


def dying(t: float, row: np.ndarray) -> np.ndarray:
    os._exit(3)


def vanishing(t: float, row: np.ndarray) -> np.ndarray:
    """Ends its process as if all were well."""
    os._exit(0)


def exiting(t: float, row: np.ndarray) -> np.ndarray:
    sys.exit("the miniature engine has had enough")


def segfaulting(t: float, row: np.ndarray) -> np.ndarray:
    ctypes.string_at(0)
    return row


HOARD: list[np.ndarray] = []


def allocating(t: float, row: np.ndarray) -> np.ndarray:
    """Fills memory without end, 16 MiB at a time, and lets go of none of it."""
    while True:
        HOARD.append(np.ones(1 << 21))


def shapeless(t: float, row: np.ndarray) -> np.ndarray:
    return row[:12]


def hanging(t: float, row: np.ndarray) -> np.ndarray:
    while True:
        time.sleep(1)


def dawdling(t: float, row: np.ndarray) -> np.ndarray:
    time.sleep(2e-4)
    return row


def printing(t: float, row: np.ndarray) -> np.ndarray:
    print("an engine that talks")
    os.write(1, b"and one that talks from C\n")
    return row


@dataclass
class Flight:
    scene: object
    timestep: float
    spoil: Spoil
    steps: int = field(default=0)

    def advance(self, strides: np.ndarray) -> np.ndarray:
        rows = []
        for stride in strides:
            self.steps += int(stride)
            rows.append(self.spoil(t := self.steps * self.timestep, self._state(t)))
        return np.array(rows)

    def _state(self, t: float) -> np.ndarray:
        initial = self.scene.initial
        position, velocity, spin = (np.array(part) for part in (initial.position, initial.velocity, initial.angular_velocity))
        fall = np.array([0.0, 0.0, -self.scene.gravity])
        rate = float(np.linalg.norm(spin))
        axis = spin / rate if rate else spin
        w, v = math.cos(rate * t / 2), math.sin(rate * t / 2) * axis
        a, u = initial.quaternion[0], np.array(initial.quaternion[1:])
        quaternion = [a * w - u @ v, *(a * v + w * u + np.cross(u, v))]
        return np.concatenate([position + velocity * t + fall * t * t / 2, quaternion, velocity + fall * t, spin])


@dataclass(frozen=True)
class Claim:
    order: int | None = None
    evaluations: int | None = 1


@dataclass(frozen=True)
class Miniature:
    spoil: Spoil

    def version(self) -> str:
        return "1.0"

    def integrators(self, scene: object = None) -> tuple[str, ...]:
        return ("closed-form",)

    def claim(self, integrator: str) -> Claim:
        return Claim()

    def models(self, scene: object, integrator: str) -> dict[str, str]:
        return {}

    def unsupported(self, scene: object) -> str | None:
        return missing(scene, {"gravity", "translation", "rotation"})

    def contact_law(self, scene: object, integrator: str) -> object | None:
        return None

    def contact_load(self, scene: object, method: object, steps: int) -> None:
        return None

    def prepare(self, scene: object, method: object) -> Flight:
        return Flight(scene, method.timestep, self.spoil)


class Frozen(Miniature):
    """Says that it models everything and that it steps, and stands still."""

    def unsupported(self, scene: object) -> str | None:
        return None

    def prepare(self, scene: object, method: object) -> Flight:
        return Flight(scene, 0.0, self.spoil)


EXACT, WRONG, DRIFTING, EXPLODING, NOT_A_NUMBER, RAISING, DYING, HANGING, PRINTING = map(
    Miniature, (exact, wrong, drifting, exploding, not_a_number, raising, dying, hanging, printing)
)
VANISHING, EXITING, SEGFAULTING, ALLOCATING, SHAPELESS, DAWDLING = map(
    Miniature, (vanishing, exiting, segfaulting, allocating, shapeless, dawdling)
)
FROZEN = Frozen(exact)
