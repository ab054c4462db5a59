"""Pinocchio: the articulated-body algorithm on one body, stepped from Python with four schemes.

Pinocchio computes accelerations and leaves the stepping to its user, so the integrators here are those that users write.
Two joint models carry the same body. On `translation + spherical` the velocity is (linear in the world frame, angular in
the body frame), and q is a vector and a rotation apart. On `free-flyer` it is the spatial twist in the body frame, and q
is one element of SE(3). Quaternions are x, y, z, w.
"""

from collections.abc import Callable

import numpy as np
import pinocchio as pin

from bodycheck.adapters.contract import Method, SceneUnsupported, Strides
from bodycheck.reference.inertia import inertia_tensor
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array

Acceleration = Callable[[Array, Array], Array]
Step = Callable[[pin.Model, Acceleration, Array, Array, float], tuple[Array, Array]]


def euler(model: pin.Model, aba: Acceleration, q: Array, v: Array, h: float) -> tuple[Array, Array]:
    """Semi-implicit Euler: the velocity first, then the configuration with the new velocity. Order 1."""
    v = v + h * aba(q, v)
    return pin.integrate(model, q, h * v), v


def rk4_naive(model: pin.Model, aba: Acceleration, q: Array, v: Array, h: float) -> tuple[Array, Array]:
    """Classical Runge-Kutta whose stage velocities are added as if they shared one tangent space. Order 2 in attitude."""
    a1 = aba(q, v)
    v2 = v + h / 2 * a1
    a2 = aba(pin.integrate(model, q, h / 2 * v), v2)
    v3 = v + h / 2 * a2
    a3 = aba(pin.integrate(model, q, h / 2 * v2), v3)
    v4 = v + h * a3
    a4 = aba(pin.integrate(model, q, h * v3), v4)
    return pin.integrate(model, q, h / 6 * (v + 2 * v2 + 2 * v3 + v4)), v + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)


def rk4(model: pin.Model, aba: Acceleration, q: Array, v: Array, h: float) -> tuple[Array, Array]:
    """Runge-Kutta-Munthe-Kaas of order 4 (Munthe-Kaas, BIT 38, 1998).

    Each stage velocity is brought to the tangent space at q by the inverse of the exponential's derivative there, which is
    Pinocchio's derivative of the difference of two configurations. That is all that tells it from `rk4_naive`.
    """

    def slope(u: Array, velocity: Array) -> tuple[Array, Array]:
        there = pin.integrate(model, q, u)
        return (
            pin.dDifference(model, q, there, pin.ARG1) @ velocity,
            aba(there, velocity),
        )

    u1, a1 = v, aba(q, v)
    u2, a2 = slope(h / 2 * u1, v + h / 2 * a1)
    u3, a3 = slope(h / 2 * u2, v + h / 2 * a2)
    u4, a4 = slope(h * u3, v + h * a3)
    return pin.integrate(model, q, h / 6 * (u1 + 2 * u2 + 2 * u3 + u4)), v + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)


SCHEMES: dict[str, tuple[Step, bool]] = {
    "semi-implicit-euler": (euler, False),
    "body-twist-euler": (euler, True),
    "rk4": (rk4, True),
    "rk4-naive": (rk4_naive, True),
}
"""The step of each integrator, and whether it works on the body twist."""


def version() -> str:
    return str(pin.__version__)


def integrators(scene: Scene | None = None) -> tuple[str, ...]:
    return tuple(SCHEMES)


def unsupported(scene: Scene) -> str | None:
    return "contact with a plane" if scene.plane is not None else None


def prepare(scene: Scene, method: Method) -> "Loop":
    if (missing := unsupported(scene)) is not None:
        raise SceneUnsupported(missing)
    step, body_twist = SCHEMES[method.integrator]
    model = pin.Model()
    model.gravity.linear[:] = 0.0, 0.0, -scene.gravity
    if body_twist:
        joint = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "flight")
    else:
        slide = model.addJoint(0, pin.JointModelTranslation(), pin.SE3.Identity(), "translation")
        joint = model.addJoint(slide, pin.JointModelSpherical(), pin.SE3.Identity(), "rotation")
    inertia = pin.Inertia(scene.body.mass, np.zeros(3), inertia_tensor(scene.body))
    model.appendBodyToJoint(joint, inertia, pin.SE3.Identity())
    return Loop(model, step, method.timestep, body_twist, scene)


class Loop:
    """A Pinocchio model and its state, stepped in a Python loop."""

    def __init__(self, model: pin.Model, step: Step, timestep: float, body_twist: bool, scene: Scene) -> None:
        self.model, self.step, self.timestep, self.body_twist = model, step, timestep, body_twist
        data, no_force = model.createData(), np.zeros(6)

        def free(q: Array, v: Array) -> Array:
            return np.asarray(pin.aba(model, data, q, v, no_force))

        def resisted(q: Array, v: Array) -> Array:
            # The generalized force of -k |v| v at the centre of mass has the components that the linear velocity has.
            force = np.concatenate([-scene.drag * np.linalg.norm(v[:3]) * v[:3], np.zeros(3)])
            return np.asarray(pin.aba(model, data, q, v, force))

        self.acceleration = resisted if scene.drag else free
        initial = scene.initial
        w, x, y, z = initial.quaternion
        self.q = np.array([*initial.position, x, y, z, w])
        linear = np.array(initial.velocity)
        if body_twist:
            linear = pin.Quaternion(w, x, y, z).toRotationMatrix().T @ linear
        self.v = np.array([*linear, *initial.angular_velocity])

    def advance(self, strides: Strides) -> Array:
        model, acceleration, step, timestep = self.model, self.acceleration, self.step, self.timestep
        q, v = self.q, self.v
        rows = np.empty((len(strides), 13))
        for row, stride in zip(rows, strides.tolist(), strict=True):
            for _ in range(stride):
                q, v = step(model, acceleration, q, v, timestep)
            row[:3], row[3], row[4:7], row[7:] = q[:3], q[6], q[3:6], v
        self.q, self.v = q, v
        if self.body_twist:
            for row in rows:
                row[7:10] = pin.Quaternion(*row[3:7]).toRotationMatrix() @ row[7:10]
        return rows
