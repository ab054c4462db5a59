"""The columns and frames in which a method returns its states, and flights in the columns and frames of the contract.

They are found from two steps of a sphere that flies and spins. Nothing is taken from the states alone: the velocity is compared
with the displacement in a step, and the angular velocity with the turn.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import permutations

import numpy as np

from bodycheck.reference.kinematics import conjugate, multiply, normalise, rotate
from bodycheck.reference.scene import Scene, State
from bodycheck.reference.trajectory import Array
from bodycheck.studies.audit.flights import Flight, NotFlown, Pilot
from bodycheck.studies.audit.probes.scenes import SPHERE

#: All components differ in size, and no one vector is near another in either frame.
LAUNCH = State((0.31, -0.52, 0.87), (6 / 9, -2 / 9, 4 / 9, 5 / 9), (0.61, -0.37, 1.13), (-0.93, 0.42, 0.58))

#: The farthest that a direction may be from the one that it is taken for. In two steps the sphere turns by less than that.
NEAR = 0.1


@dataclass(frozen=True)
class Convention:
    """The columns and frames in which a method returns its states.

    Parameters
    ----------
    columns
        The index of each of the 13 columns of the contract among those that are returned.
    conjugate
        Whether the quaternion takes world components to body components.
    velocity_in_body, spin_in_world
        Whether the velocity is along the axes of the body, and the angular velocity along those of the world.
    takes_velocity_in_body, takes_spin_in_world
        Whether the body moves as if the launch had been given along these axes.
    """

    columns: tuple[int, ...] = tuple(range(13))
    conjugate: bool = False
    velocity_in_body: bool = False
    spin_in_world: bool = False
    takes_velocity_in_body: bool = False
    takes_spin_in_world: bool = False


def in_contract(states: Array, known: Convention) -> Array:
    """Return states (n, 13) in the columns and frames of the contract, with unit quaternions."""
    states = states[:, list(known.columns)]
    attitude = normalise(states[:, 3:7])
    attitude = conjugate(attitude) if known.conjugate else attitude
    velocity = rotate(attitude, states[:, 7:10]) if known.velocity_in_body else states[:, 7:10]
    spin = rotate(conjugate(attitude), states[:, 10:]) if known.spin_in_world else states[:, 10:]
    return np.concatenate([states[:, :3], attitude, velocity, spin], axis=1)


def watch(pilot: Pilot, flight: Flight) -> Array | NotFlown:
    """Return the states (n, 13) of a flight in the columns and frames of the contract, however the method returns them."""
    known, flown = convention(pilot), pilot.recall(flight)
    if isinstance(flown, NotFlown):
        return flown
    if not np.isfinite(flown.states).all():
        return NotFlown("its states are not numbers")
    return flown.states if isinstance(known, NotFlown) else in_contract(flown.states, known)


def convention(pilot: Pilot) -> Convention | NotFlown:
    """Return the convention of a method, or why it cannot be determined."""
    flown = pilot.recall(Flight(Scene(SPHERE, LAUNCH), pilot.timestep, (1, 1)))
    if isinstance(flown, NotFlown):
        return flown
    if not np.isfinite(flown.states).all():
        return NotFlown("its states are not numbers")
    return _told(flown.states.tobytes())


@lru_cache(maxsize=8)
def _told(states: bytes) -> Convention | NotFlown:
    """Return the convention by the states (2, 13) of the launch after its two steps, which all probes of a method share."""
    first, second = np.frombuffer(states).reshape(2, 13)
    axes = min(permutations(range(3)), key=lambda order: float(np.abs(first[list(order)] - LAUNCH.position).sum()))
    order, inverse = _attitude(normalise(first[3:7]))
    attitude = normalise(np.array([first[order], second[order]]))
    attitude = conjugate(attitude) if inverse else attitude
    motion = second[list(axes)] - first[list(axes)]
    relative = multiply(conjugate(attitude[0]), attitude[1])
    turn = relative[1:] * np.copysign(1.0, relative[0])
    choices = _velocities(second[7:], attitude[1], motion, turn)
    error, columns, velocity_in_body, spin_in_world = min(choices, key=lambda choice: choice[0])
    if not error < NEAR:
        return NotFlown("the velocities that it returns are along no axes of its motion")
    return Convention(
        (*axes, *order, *columns),
        inverse,
        velocity_in_body,
        spin_in_world,
        _apart(rotate(attitude[0], np.array(LAUNCH.velocity)), motion) < NEAR,
        _apart(rotate(conjugate(attitude[0]), np.array(LAUNCH.angular_velocity)), turn) < NEAR,
    )


def _attitude(returned: Array) -> tuple[list[int], bool]:
    """Return the columns of w, x, y, z and whether it is the inverse, of a unit quaternion (4,) near that of the launch."""
    given = np.array(LAUNCH.quaternion)
    choices = [(order, inverse) for order in ([0, 1, 2, 3], [3, 0, 1, 2]) for inverse in (False, True)]

    def nearness(choice: tuple[list[int], bool]) -> float:
        taken = returned[choice[0]]
        return abs(float((conjugate(taken) if choice[1] else taken) @ given))

    order, inverse = max(choices, key=nearness)
    return [3 + column for column in order], inverse


def _velocities(
    returned: Array, attitude: Array, motion: Array, turn: Array
) -> Iterator[tuple[float, tuple[int, ...], bool, bool]]:
    """Yield the distance of velocities (6,) from a motion, their columns, and whether they are in the other frames."""
    velocities = [(motion, False), (rotate(conjugate(attitude), motion), True)]
    spins = [(turn, False), (rotate(attitude, turn), True)]
    for first, second in ((0, 3), (3, 0)):
        off, order, in_body = min(_fits(returned[first : first + 3], velocities), key=lambda fit: fit[0])
        off_spin, order_spin, in_world = min(_fits(returned[second : second + 3], spins), key=lambda fit: fit[0])
        columns = (*(7 + first + column for column in order), *(7 + second + column for column in order_spin))
        yield max(off, off_spin), columns, in_body, in_world


def _fits(returned: Array, candidates: Sequence[tuple[Array, bool]]) -> Iterator[tuple[float, tuple[int, ...], bool]]:
    """Yield how far the components (3,) of a vector, in every order, are in direction from each candidate."""
    for candidate, other_frame in candidates:
        for order in permutations(range(3)):
            yield _apart(returned[list(order)], candidate), order, other_frame


def _apart(one: Array, other: Array) -> float:
    """Return the distance of the directions of two vectors (3,)."""
    sizes = float(np.linalg.norm(one)), float(np.linalg.norm(other))
    return float(np.linalg.norm(one / sizes[0] - other / sizes[1])) if all(sizes) else 2.0
