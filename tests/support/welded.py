"""A miniature engine that takes a body as welded links, and does it wrong in one way or not at all.

It steps the centre of mass and the attitude of the whole body by a scheme of the reference.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from scipy.spatial.transform import Rotation

from bodycheck.adapters.contract import Engine, Integrator, Method, Strides, single
from bodycheck.adapters.links import Link
from bodycheck.reference.scene import Body, Scene, State
from bodycheck.reference.schemes.catalogue import CATALOGUE, MUNTHE_KAAS
from bodycheck.reference.schemes.formulations import world_velocity
from bodycheck.reference.schemes.increments import Pair, Pose
from bodycheck.reference.schemes.one_step import Scheme, step_through
from bodycheck.reference.trajectory import Array

#: The schemes that it steps by, one of each sort.
SCHEMES = (
    *("explicit Euler", "semi-implicit Euler", "linearly implicit Euler"),
    *("implicit midpoint", "Munthe-Kaas with Heun 2", MUNTHE_KAAS),
)

#: What is done to links before they are welded, by a time step (s).
Spoil = Callable[[Sequence[Link], float], Sequence[Link]]


def rotation(quaternion: Sequence[float]) -> Rotation:
    return Rotation.from_quat(quaternion, scalar_first=True)


def tensor(link: Link) -> Array:
    """The tensor of a link about its centre of mass, along the axes of its frame (3, 3)."""
    xx, yy, zz, xy, xz, yz = link.inertia
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def welded(links: Sequence[Link]) -> tuple[float, Array, Array]:
    """Mass, centre of mass (3,) and tensor about it (3, 3) of all links, in the frame of the first, by the parallel axes."""
    masses = np.array([link.mass for link in links])
    centres = np.array([rotation(link.quaternion).apply(link.center_of_mass) + link.position for link in links])
    centre = masses @ centres / masses.sum()
    whole = np.zeros((3, 3))
    for link, mass, aside in zip(links, masses, centres - centre, strict=True):
        turn = rotation(link.quaternion).as_matrix()
        whole += turn @ tensor(link) @ turn.T + mass * (aside @ aside * np.eye(3) - np.outer(aside, aside))
    return float(masses.sum()), centre, whole


def body_of(mass: float, inertia: Array) -> Body:
    """The body with a tensor in its frame."""
    moments, axes = np.linalg.eigh(inertia)
    axes[:, 0] *= np.linalg.det(axes)
    first, second, third = moments.tolist()
    w, x, y, z = Rotation.from_matrix(axes).as_quat(scalar_first=True).tolist()
    return Body(mass, (first, second, third), axes=(w, x, y, z))


def sound(links: Sequence[Link], timestep: float) -> Sequence[Link]:
    return links


def unturned(links: Sequence[Link], timestep: float) -> Sequence[Link]:
    """The rotations of welds are lost."""
    return [replace(link, quaternion=(1.0, 0.0, 0.0, 0.0)) for link in links]


def without_products(links: Sequence[Link], timestep: float) -> Sequence[Link]:
    """The products of inertia are lost."""
    return [replace(link, inertia=(*link.inertia[:3], 0.0, 0.0, 0.0)) for link in links]


def without_centres(links: Sequence[Link], timestep: float) -> Sequence[Link]:
    """The centres of mass are taken to be the origins."""
    return [replace(link, center_of_mass=(0.0, 0.0, 0.0)) for link in links]


def stiffer(first_order: float, second_order: float, always: float = 0.0) -> Spoil:
    """One moment is too large: by parts of first and second order in the time step, and by one that is there always."""

    def spoil(links: Sequence[Link], timestep: float) -> Sequence[Link]:
        by = 1 + always + first_order * timestep + second_order * timestep**2
        return [replace(link, inertia=(by * link.inertia[0], *link.inertia[1:])) for link in links]

    return spoil


def settling(links: Sequence[Link], timestep: float) -> Sequence[Link]:
    """One moment is too large by a part that is of first order far above a time step of 1 ms and of second order far below."""
    return stiffer(2 * timestep / (timestep + 0.001), 0.0)(links, timestep)


@dataclass
class Motion:
    """A simulation of a body, seen from a frame with the centre of mass at `centre` (m, in that frame)."""

    scene: Scene
    scheme: Scheme
    timestep: float
    centre: Array

    def advance(self, strides: Strides) -> Array:
        """The states from the start on, as of the first call of `Simulation.advance`."""
        initial = self.scene.initial
        turn, spin = rotation(initial.quaternion), np.array(initial.angular_velocity)
        place = np.array(initial.position) + turn.apply(self.centre)
        speed = np.array(initial.velocity) + turn.apply(np.cross(spin, self.centre))
        (x, y, z), (u, v, w) = place.tolist(), speed.tolist()
        state = State((x, y, z), initial.quaternion, (u, v, w), initial.angular_velocity)
        scene = replace(self.scene, initial=state)
        rows = step_through(self.scheme, world_velocity, scene, self.timestep, strides)
        turns = Rotation.from_quat(rows[:, 3:7], scalar_first=True)
        rows[:, :3] -= turns.apply(self.centre)
        rows[:, 7:10] -= turns.apply(np.cross(rows[:, 10:], self.centre))
        return single(rows)


@dataclass(frozen=True)
class Welder:
    """The engine. In single precision its state is rounded after each step."""

    spoil: Spoil = sound
    precision: Literal["float64", "float32"] = "float64"

    @property
    def engine(self) -> Engine:
        integrators = tuple(Integrator(name.replace(" ", "-")) for name in SCHEMES)
        models = frozenset({"gravity", "translation", "rotation"})
        return Engine("welder", "planted", "1.0", integrators, models, precision=self.precision)

    def prepare(self, scenes: Sequence[Scene], method: Method) -> Motion:
        (scene,) = scenes
        return Motion(scene, self._scheme(method), method.timestep, np.zeros(3))

    def prepare_links(self, links: Sequence[Link], scene: Scene, method: Method) -> Motion:
        mass, centre, inertia = welded(self.spoil(links, method.timestep))
        return Motion(replace(scene, body=body_of(mass, inertia)), self._scheme(method), method.timestep, centre)

    def _scheme(self, method: Method) -> Scheme:
        scheme = next(CATALOGUE[name].scheme for name in SCHEMES if name.replace(" ", "-") == method.integrator)
        if self.precision == "float64":
            return scheme

        def rounded(formulation: object, pose: Pose, v: Pair, h: float) -> tuple[Pose, Pair]:
            (place, attitude), (linear, angular) = scheme(formulation, pose, v, h)  # type: ignore[arg-type]
            return (_single(place), _single(attitude)), (_single(linear), _single(angular))

        return rounded


def _single(numbers: Sequence[float]) -> tuple[float, ...]:
    return tuple(np.float32(number).item() for number in numbers)
