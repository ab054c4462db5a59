"""Miniature engines that test the harness: each moves a body in free flight in closed form and spoils it in its own way.

They know spins about a principal axis only, so that their exact motion needs no integration.
"""

import contextlib
import ctypes
import ctypes.util
import math
import os
import platform
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from bodycheck.adapters.contract import Engine, Integrator, Method, Option
from bodycheck.reference.scene import Scene

Spoil = Callable[[float, np.ndarray], np.ndarray]


def exact(t: float, row: np.ndarray) -> np.ndarray:
    return row


def wrong(t: float, row: np.ndarray) -> np.ndarray:
    """Wrong from the first step on: the whole motion one metre aside, and every velocity reversed."""
    if t > 0:
        row[0] += 1.0
        row[7:] *= -1.0
    return row


def drifting(t: float, row: np.ndarray) -> np.ndarray:
    """Gains speed: one per mille of its angular velocity a second."""
    row[10:] *= 1 + 1e-3 * t
    return row


def exploding(t: float, row: np.ndarray) -> np.ndarray:
    row[7:10] += math.expm1(50 * t)
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


def scribbling(t: float, row: np.ndarray) -> np.ndarray:
    """Writes into every descriptor of its process but those of the terminal."""
    for descriptor in range(3, 256):
        with contextlib.suppress(OSError):
            os.write(descriptor, b"\x00\x10" * 512)
    return row


def forking(t: float, row: np.ndarray) -> np.ndarray:
    """Makes a copy of its process at the start, which goes on as the process does."""
    if t == 0 and (copy := os.fork()):
        os.waitpid(copy, 0)
    return row


def meddling(t: float, row: np.ndarray) -> np.ndarray:
    """Leaves its process with another environment, folder and seed when it comes to its last sample."""
    if t == 1.0:
        os.environ.clear()
        os.chdir("/")
        np.random.seed(1)
    return row


def rounding(t: float, row: np.ndarray) -> np.ndarray:
    """Lets the arithmetic of its process round towards plus infinity (FE_UPWARD of fenv.h)."""
    upward = {"x86_64": 0x800, "aarch64": 0x400000, "arm64": 0x400000}[platform.machine()]
    ctypes.CDLL(ctypes.util.find_library("m")).fesetround(upward)
    return row


def unnormalised(t: float, row: np.ndarray) -> np.ndarray:
    row[3:7] *= 1.5 if t >= 0.5 else 1.0
    return row


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
    scene: Scene
    timestep: float
    spoil: Spoil
    steps: int = field(default=0)

    def advance(self, strides: np.ndarray) -> np.ndarray:
        rows = []
        for stride in strides:
            self.steps += int(stride)
            rows.append(self.spoil(t := self.steps * self.timestep, self._state(t)))
        return np.array(rows)[None, :, None, :]

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


#: Its option `note` takes any text and changes nothing.
INTEGRATOR = Integrator("closed-form", evaluations=1, options={"note": Option("any text")})


@dataclass(frozen=True)
class Miniature:
    name: str
    spoil: Spoil
    modelled: ClassVar[frozenset[str]] = frozenset({"gravity", "translation", "rotation"})

    @property
    def engine(self) -> Engine:
        return Engine(self.name, "bodycheck-miniature", "1.0", (INTEGRATOR,), self.modelled)

    def prepare(self, scenes: Sequence[Scene], method: Method) -> Flight:
        (scene,) = scenes
        return Flight(scene, method.timestep, self.spoil)


class Frozen(Miniature):
    """Says that it models everything and that it steps, and stands still."""

    modelled = frozenset({"gravity", "translation", "rotation", "contact", "friction", "drag"})

    def prepare(self, scenes: Sequence[Scene], method: Method) -> Flight:
        return Flight(scenes[0], 0.0, self.spoil)


class Lucky(Miniature):
    """Drifts aside at a speed (m/s) of the square of its time step, unless a second has fourteen steps."""

    def prepare(self, scenes: Sequence[Scene], method: Method) -> Flight:
        speed = 0.0 if round(1 / method.timestep) == 14 else method.timestep**2
        return Flight(scenes[0], method.timestep, lambda t, row: row + speed * t * (np.arange(len(row)) == 0))


EXACT, WRONG, DRIFTING = Miniature("exact", exact), Miniature("wrong", wrong), Miniature("drifting", drifting)
EXPLODING, NOT_A_NUMBER = Miniature("exploding", exploding), Miniature("not-a-number", not_a_number)
RAISING, DYING, HANGING = Miniature("raising", raising), Miniature("dying", dying), Miniature("hanging", hanging)
PRINTING, VANISHING, EXITING = Miniature("printing", printing), Miniature("vanishing", vanishing), Miniature("exiting", exiting)
SEGFAULTING, ALLOCATING = Miniature("segfaulting", segfaulting), Miniature("allocating", allocating)
SCRIBBLING, FORKING = Miniature("scribbling", scribbling), Miniature("forking", forking)
UNNORMALISED, MEDDLING = Miniature("unnormalised", unnormalised), Miniature("meddling", meddling)
ROUNDING = Miniature("rounding", rounding)
SHAPELESS, DAWDLING, FROZEN = Miniature("shapeless", shapeless), Miniature("dawdling", dawdling), Frozen("frozen", exact)
LUCKY = Lucky("lucky", exact)
