"""Step bodies on joints that touch free bodies, such as fingers that grip one, by Pinocchio's rigid contacts.

The mechanism is that of `mechanism_model`, and Pinocchio computes its accelerations without contact, its inverse mass matrix
and the Jacobians of its joints. The points at which bodies touch and the step are those of `touching`.
"""

from collections.abc import Sequence

import numpy as np
import pinocchio as pin

from bodycheck.adapters.contract import Method, SceneUnsupported
from bodycheck.adapters.pinocchio import contact
from bodycheck.adapters.pinocchio.contact_points import Placed, Point, between, radius
from bodycheck.adapters.pinocchio.driving import Actuated
from bodycheck.adapters.pinocchio.mechanism_model import Built, built
from bodycheck.adapters.pinocchio.mechanisms import centres_of, driven_joints, forces_of, in_model, joint_numbers, states_of
from bodycheck.adapters.pinocchio.touching import Solver, State, aim
from bodycheck.adapters.stepping import Loop, TakingLaws
from bodycheck.adapters.touching import laws
from bodycheck.reference.mechanisms.mechanism import Mechanism, shape_of
from bodycheck.reference.planar import describe_shape
from bodycheck.reference.scene import Brick, Sphere
from bodycheck.reference.trajectory import Array

#: The requirements of bodies on joints that touch others.
MODELS = frozenset({"contacts of bodies on joints"})


class Gripping:
    """A mechanism of which bodies touch, and the step that solves their contacts.

    Parameters
    ----------
    scene
        The mechanism.
    parts
        The mechanism in Pinocchio.
    joints
        The driven joints.
    timestep
        The time step (s).
    """

    def __init__(self, scene: Mechanism, parts: Built, joints: Actuated, timestep: float) -> None:
        self.parts, self.joints, self.timestep = parts, joints, timestep
        self.model, self.data = parts.model, parts.model.createData()
        self.shapes = [shape_of(body) for body in scene.bodies]
        self.centres = centres_of(scene)
        _, *self.laws = laws(scene)
        self.fall = scene.gravity * timestep
        self.unit = self.fall or 1.0
        # Impulses are in units of the largest mass.
        self.mass = max(inertia.mass for inertia in self.model.inertias)
        self.solver = Solver(self.model, 1)
        self.guess: dict[tuple[tuple[int, int], int], Array] = {}

    def step(self, state: State) -> State:
        """Return the state one step later. Raises `EngineDiverged` if ADMM finds no solution."""
        q, before = state
        v = before + self.timestep * pin.aba(self.model, self.data, q, before, self.joints.total(q, before, 0.0))
        pin.computeJointJacobians(self.model, self.data, q)
        pin.forwardKinematics(self.model, self.data, q, before)
        placed = [self._placed(index) for index in range(len(self.shapes))]
        points = [point for law in self.laws for point in self._points(law.bodies, placed)]
        if points:
            v = v + self._change(points, q, before, v)
        return pin.integrate(self.model, q, self.timestep * v), v

    def _placed(self, index: int) -> Placed | None:
        """Return the shape of a body at its present pose; None if it has none."""
        shape, (joint, frame) = self.shapes[index], self.parts.places[index]
        pose = self.data.oMi[joint] * frame
        return None if shape is None else Placed(shape, pose.act(self.centres[index]), pose.rotation.copy())

    def _points(self, pair: tuple[int, int], placed: Sequence[Placed | None]) -> list[Point]:
        """Return the points at which a pair may touch within the step."""
        one, other = (placed[index] for index in pair)
        assert one is not None  # `prepare` has checked the shapes
        assert other is not None
        margin = 0.0
        for index, body in zip(pair, (one, other), strict=True):
            twist = pin.getVelocity(self.model, self.data, self.parts.places[index][0], pin.LOCAL_WORLD_ALIGNED)
            fast = np.linalg.norm(twist.linear) + np.linalg.norm(twist.angular) * radius(body.shape)
            margin += 2 * self.timestep * (float(fast) + 2 * self.unit)
        return list(between(pair, one, other, margin))

    def _change(self, points: Sequence[Point], q: Array, before: Array, v: Array) -> Array:
        """Return the change of the velocities (nv,) by contacts. v: the velocities of the step without contacts."""
        by_pair = {law.bodies: law for law in self.laws}
        of_points = [by_pair[point.bodies] for point in points]
        jacobian = np.vstack([self._jacobian(point) for point in points])
        drift = jacobian @ v
        aim(drift, (jacobian @ before)[2::3], points, of_points, self.timestep, self.fall)
        inverse = self.mass * pin.computeMinverse(self.model, self.data, q)
        keys = [(point.bodies, point.number) for point in points]
        guess = np.concatenate([self.guess.get(key, np.zeros(3)) for key in keys])
        frictions, time = tuple(law.friction for law in of_points), self.joints.steps * self.timestep
        impulses = self.solver.solved(jacobian @ inverse @ jacobian.T, drift / self.unit, guess, frictions, time)
        self.guess = dict(zip(keys, impulses.reshape(-1, 3), strict=True))
        return np.asarray(inverse @ jacobian.T @ (self.unit * impulses))

    def _jacobian(self, point: Point) -> Array:
        """Return the map (3, nv) to the velocity of the second body relative to the first at a point, along its axes."""
        total = np.zeros((3, self.model.nv))
        for index, sign in zip(point.bodies, (-1.0, 1.0), strict=True):
            joint = self.parts.places[index][0]
            rows = pin.getJointJacobian(self.model, self.data, joint, pin.LOCAL_WORLD_ALIGNED)
            x, y, z = point.position - self.data.oMi[joint].translation
            crossed = np.array([[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]])
            total += sign * point.axes.T @ (rows[:3] + crossed @ rows[3:])
        return total


def prepare(scene: Mechanism, method: Method) -> Loop[State] | TakingLaws:
    """Return the simulation of a mechanism of which bodies touch, as `Adapter.prepare` does. Raises `SceneUnsupported`."""
    if not contact.HAS_POINT_CONTACTS:
        raise SceneUnsupported(f"contact: Pinocchio {pin.__version__} has no point contacts")
    for index in {index for pair in scene.contacts for index in pair.bodies}:
        if not isinstance(shape := shape_of(scene.bodies[index]), Brick | Sphere):
            raise SceneUnsupported(f"{describe_shape(shape)} among several: contacts of bricks and spheres alone are found")
    parts = built(scene, body_twist=False)
    numbers = joint_numbers(scene, parts)
    joints = Actuated(forces_of(*numbers), *driven_joints(scene, parts), len(numbers[0]), method.timestep)
    gripping = Gripping(scene, parts, joints, method.timestep)
    rows, nq = states_of(parts.model, parts.model.createData(), parts.places, gripping.centres), parts.model.nq
    loop = Loop(
        (parts.q, parts.v),
        lambda state: joints.count(gripping.step(state)),
        lambda state: np.concatenate(state),
        lambda seen: rows(seen[:, :nq], seen[:, nq:]),
    )
    if not scene.driven:
        return loop
    return TakingLaws(loop, lambda: joints.state(*in_model(*loop.state)), joints.apply, joints.obey)
