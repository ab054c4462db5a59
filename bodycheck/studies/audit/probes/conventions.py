"""Find the columns and frames in which a method returns its states, and convert states to those of the contract.

The convention is determined from two steps of a sphere that flies and spins. The velocity is compared with the displacement in
a step, and the angular velocity with the turn in a step.
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

#: The launch. All components differ in size, and no vector is close to another vector in either frame.
LAUNCH = State((0.31, -0.52, 0.87), (6 / 9, -2 / 9, 4 / 9, 5 / 9), (0.61, -0.37, 1.13), (-0.93, 0.42, 0.58))

#: The largest distance of a returned direction from the direction with which it is identified. In two steps the sphere turns by
#: less than this angle (rad).
NEAR = 0.1


@dataclass(frozen=True)
class Convention:
    """The columns and frames in which a method returns its states.

    Parameters
    ----------
    columns
        The index of each of the contract's 13 columns among the returned columns.
    conjugate
        Whether the quaternion takes world components to body components.
    velocity_in_body, spin_in_world
        Whether the components of the velocity are along the axes of the body, and the components of the angular velocity along
        the axes of the world.
    takes_velocity_in_body, takes_spin_in_world
        Whether the body moves as if the initial velocity had been given along the axes of the body, and the initial angular
        velocity along the axes of the world.
    """

    columns: tuple[int, ...] = tuple(range(13))
    conjugate: bool = False
    velocity_in_body: bool = False
    spin_in_world: bool = False
    takes_velocity_in_body: bool = False
    takes_spin_in_world: bool = False


def in_contract(states: Array, known: Convention) -> Array:
    """Return states (n, 13) in the columns and frames of the contract, with unit quaternions.

    states: the states (n, 13) in the convention `known`.
    """
    states = states[:, list(known.columns)]
    attitude = normalise(states[:, 3:7])
    attitude = conjugate(attitude) if known.conjugate else attitude
    velocity = rotate(attitude, states[:, 7:10]) if known.velocity_in_body else states[:, 7:10]
    spin = rotate(conjugate(attitude), states[:, 10:]) if known.spin_in_world else states[:, 10:]
    return np.concatenate([states[:, :3], attitude, velocity, spin], axis=1)


def watch(pilot: Pilot, flight: Flight) -> Array | NotFlown:
    """Return the states (n, 13) of a flight in the columns and frames of the contract, or why there are none.

    If the convention of the method cannot be determined, the states are returned unchanged.
    """
    known, flown = convention(pilot), pilot.recall(flight)
    if isinstance(flown, NotFlown):
        return flown
    if not np.isfinite(flown.states).all():
        return NotFlown("its states are not numbers")
    return flown.states if isinstance(known, NotFlown) else in_contract(flown.states, known)


def convention(pilot: Pilot) -> Convention | NotFlown:
    """Return the convention of a method, or the reason why it cannot be determined."""
    flown = pilot.recall(Flight(Scene(SPHERE, LAUNCH), pilot.timestep, (1, 1)))
    if isinstance(flown, NotFlown):
        return flown
    if not np.isfinite(flown.states).all():
        return NotFlown("its states are not numbers")
    return _told(flown.states.tobytes())


@lru_cache(maxsize=8)
def _told(states: bytes) -> Convention | NotFlown:
    """Return the convention that follows from the states after the two steps of the launch, or why there is none.

    states: the bytes of the states (2, 13). The result is cached, because all probes of a method need it.
    """
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
    """Return the columns of w, x, y, z in the states, and whether the returned quaternion is the inverse of the attitude.

    returned: a unit quaternion (4,) close to the quaternion of the launch or to its inverse, from columns 3 to 6 of a state.
    """
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
    """Yield a fit for each of the two orders of velocity and angular velocity in the returned components (6,).

    A fit has the distance from the directions of motion and turn, the columns of the velocities in a state, and whether the
    velocity is along the axes of the body and the angular velocity along the axes of the world.

    Parameters
    ----------
    returned
        The last six components of a state.
    attitude
        The attitude (4,).
    motion, turn
        The displacement (3,) in a step, world frame, and the rotation (3,) in a step, body frame.
    """
    velocities = [(motion, False), (rotate(conjugate(attitude), motion), True)]
    spins = [(turn, False), (rotate(attitude, turn), True)]
    for first, second in ((0, 3), (3, 0)):
        off, order, in_body = min(_fits(returned[first : first + 3], velocities), key=lambda fit: fit[0])
        off_spin, order_spin, in_world = min(_fits(returned[second : second + 3], spins), key=lambda fit: fit[0])
        columns = (*(7 + first + column for column in order), *(7 + second + column for column in order_spin))
        yield max(off, off_spin), columns, in_body, in_world


def _fits(returned: Array, candidates: Sequence[tuple[Array, bool]]) -> Iterator[tuple[float, tuple[int, ...], bool]]:
    """Yield the distance in direction between a vector (3,) and each candidate, for every order of the vector's components.

    Each result also has the order and the flag of the candidate.
    """
    for candidate, other_frame in candidates:
        for order in permutations(range(3)):
            yield _apart(returned[list(order)], candidate), order, other_frame


def _apart(one: Array, other: Array) -> float:
    """Return the distance between the unit vectors along two vectors (3,); 2 if a vector is zero."""
    sizes = float(np.linalg.norm(one)), float(np.linalg.norm(other))
    return float(np.linalg.norm(one / sizes[0] - other / sizes[1])) if all(sizes) else 2.0
