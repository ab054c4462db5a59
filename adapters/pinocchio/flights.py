"""Step bodies in flight together, several of them in one model of Pinocchio, each on its own joints.

Pinocchio's functions go from joint to joint of a model. Bodies whose joints are connected only to the world do not affect one
another, and each is computed as if it were alone in its model, so that one call from Python serves several bodies. Their masses
and moments may differ, in contrast to the worlds of `abaInParallel`, because a `ModelPool` has one model. Gravity is a property
of the model.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import pinocchio as pin

from bodycheck.adapters.contract import Method, Strides
from bodycheck.adapters.links import links_of
from bodycheck.adapters.pinocchio import schemes
from bodycheck.adapters.pinocchio.coordinates import Coordinates, initial_states
from bodycheck.adapters.pinocchio.joints import add_body, to_pinocchio, world
from bodycheck.adapters.pinocchio.schemes import Acceleration, Scheme
from bodycheck.reference.requirements import requirements
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array

#: The largest number of bodies in one model. Pinocchio's data grow with the third power of this number, to 31 MiB for 16
#: bodies.
BODIES = 16


@dataclass
class Part:
    """Several bodies in one model, with the time step (bodies nv,), configurations (bodies nq,) and velocities (bodies nv,)."""

    model: pin.Model
    scheme: Scheme
    acceleration: Acceleration
    timestep: Array
    q: Array
    v: Array

    def advance(self, strides: Strides) -> tuple[Array, Array]:
        """Return q (n, bodies nq) and v (n, bodies nv) after each of n strides."""
        scheme, model, acceleration, h = self.scheme, self.model, self.acceleration, self.timestep
        q, v = self.q, self.v
        configurations, velocities = np.empty((len(strides), len(q))), np.empty((len(strides), len(v)))
        for row, stride in enumerate(strides.tolist()):
            for _ in range(stride):
                q, v = scheme(model, acceleration, q, v, h)
            configurations[row], velocities[row] = q, v
        self.q, self.v = q, v
        return configurations, velocities


@dataclass
class Flights:
    """A simulation of one or several scenes in flight.

    Parameters
    ----------
    parts
        The parts, which contain the bodies in order.
    coordinates
        The joints of each body.
    first
        The initial states (scenes, 13).
    """

    parts: Sequence[Part]
    coordinates: Coordinates
    first: Array

    def advance(self, strides: Strides) -> Array:
        """Return the states (scenes, n, 1, 13) after each of n strides, as `Simulation.advance` does."""
        seen = [part.advance(strides) for part in self.parts]
        q, v = (self._by_bodies(np.hstack(each)) for each in zip(*seen, strict=True))
        return self.coordinates.rows(self.first, q, v)[:, :, None]

    def _by_bodies(self, seen: Array) -> Array:
        """Return the array (n, scenes k) of all bodies in the shape (scenes, n, k)."""
        count = len(self.first)
        return seen.reshape(len(seen), count, seen.shape[1] // count).swapaxes(0, 1)


def flights(scenes: Sequence[Scene], method: Method, coordinates: Coordinates) -> Flights:
    """Return the simulation of one or several scenes in flight, which have the same gravity and drag."""
    first = initial_states(scenes)
    q, v = coordinates.start(first)
    parts: list[Part] = []
    bodies: Sequence[object] = ()
    for begin in range(0, len(scenes), BODIES):
        part = slice(begin, begin + BODIES)
        bodies_and_turns = [(scene.body, scene.initial.quaternion if coordinates.turned else None) for scene in scenes[part]]
        if not parts or bodies_and_turns != bodies:
            model = model_of(scenes[part], coordinates)
        bodies = bodies_and_turns
        data, count = workspace(coordinates, len(bodies_and_turns)), len(bodies_and_turns)
        scheme, acceleration = schemes.of_bodies(method.integrator, count), acceleration_of(scenes[0], model, data, count)
        parts.append(Part(model, scheme, acceleration, np.full(model.nv, method.timestep), q[part].ravel(), v[part].ravel()))
    return Flights(parts, coordinates, first)


def model_of(scenes: Sequence[Scene], coordinates: Coordinates) -> pin.Model:
    """Return the model of the bodies of scenes, each on its own joints."""
    model = world(scenes[0].gravity)
    for scene in scenes:
        attitude = to_pinocchio(scene.initial.quaternion).matrix() if coordinates.turned else None
        add_body(model, links_of(scene), [kind() for kind in coordinates.kinds], attitude)
    return model


@lru_cache(maxsize=8)
def workspace(coordinates: Coordinates, count: int) -> pin.Data:
    """Return Pinocchio's data for models of `count` bodies on equal joints. Parts share the data: no call uses old contents."""
    model = world(0.0)
    for _ in range(count):
        add_body(model, (), [kind() for kind in coordinates.kinds])
    return model.createData()


def acceleration_of(scene: Scene, model: pin.Model, data: pin.Data, count: int) -> Acceleration:
    """Return the accelerations of `count` bodies, under gravity and the drag of a scene, for the schemes."""
    nothing = np.zeros(model.nv)

    def free(q: Array, v: Array, passed: float) -> object:
        return pin.aba(model, data, q, v, nothing)

    def resisted(q: Array, v: Array, passed: float) -> object:
        # The generalized force of -k |v| v at the centre of mass acts only on the linear velocity.
        force = np.zeros((count, model.nv // count))
        linear = v.reshape(count, -1)[:, :3]
        x, y, z = linear.T
        force[:, :3] = (-scene.drag * np.sqrt(x * x + y * y + z * z))[:, None] * linear
        return pin.aba(model, data, q, v, force.ravel())

    return resisted if requirements(scene).drag else free
