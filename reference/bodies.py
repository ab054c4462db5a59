"""The bodies of any scene in one view: a single body is treated as a mechanism with one body.

Code that measures or shows a motion reads the bodies through this module. The truth of a single body is computed by other
methods, such as closed forms, which do not exist for mechanisms in general.
"""

from dataclasses import dataclass

import numpy as np

from bodycheck.reference.inertia import inertia_tensor
from bodycheck.reference.mechanisms import exact, kinematics
from bodycheck.reference.mechanisms.mechanism import AnyScene, JointedBody, Mechanism, shape_of
from bodycheck.reference.mechanisms.observables import tensor
from bodycheck.reference.scene import Body, Shape
from bodycheck.reference.trajectory import Array, Trajectory

#: The name of a single body, which files do not name.
BODY = "body"


@dataclass(frozen=True)
class AnyBody:
    """A body of a scene.

    Attributes
    ----------
    name
        Its name; `BODY` for a single body.
    mass
        Its mass (kg).
    shape
        Its shape about the centre of mass; None if it has none.
    given
        The body as the object that the scene contains.
    """

    name: str
    mass: float
    shape: Shape | None
    given: Body | JointedBody

    @property
    def tensor(self) -> Array:
        """The inertia tensor (3, 3) about the centre of mass, along the axes of the body (kg m^2)."""
        return inertia_tensor(self.given) if isinstance(self.given, Body) else tensor(self.given)


def bodies(scene: AnyScene) -> tuple[AnyBody, ...]:
    """The bodies of a scene, in the order of the body axis of state arrays."""
    if isinstance(scene, Mechanism):
        return tuple(AnyBody(body.name, exact.nearest_inertia(body).mass, shape_of(body), body) for body in scene.bodies)
    return (AnyBody(BODY, scene.body.mass, scene.body.shape, scene.body),)


def initial(scene: AnyScene) -> Trajectory:
    """The states (b, 1, ...) of the bodies at t = 0."""
    if isinstance(scene, Mechanism):
        return kinematics.initial(scene)
    start = scene.initial
    states = (start.position, start.quaternion, start.velocity, start.angular_velocity)
    return Trajectory(np.zeros(1), *(np.array(values)[None, None] for values in states))


def of_bodies(trajectory: Trajectory) -> Trajectory:
    """The trajectory with states (b, n, ...) of b bodies; states (n, ...) of a single body become (1, n, ...)."""
    if trajectory.position.ndim == 3:
        return trajectory
    states = (trajectory.position, trajectory.quaternion, trajectory.velocity, trajectory.angular_velocity)
    return Trajectory(trajectory.t, *(values[None] for values in states))


def motions(scene: AnyScene, trajectory: Trajectory) -> tuple[Trajectory, ...]:
    """The states (n, ...) of each body of a scene."""
    if not isinstance(scene, Mechanism):
        return (trajectory,)
    return tuple(trajectory.body(index) for index in range(len(scene.bodies)))
