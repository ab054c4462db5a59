"""Pinocchio: the articulated-body algorithm on one body, stepped from Python.

Pinocchio computes accelerations and leaves the stepping to its user, so the integrators here are those that users write.
Two joint models carry the same body. On `translation + spherical` the velocity is (linear in the world frame, angular in
the body frame), and q is a vector and a rotation apart. On `free-flyer` it is the spatial twist in the body frame, and q
is one element of SE(3). Quaternions are x, y, z, w.

A body on a plane has two schemes, both semi-implicit Euler in world velocities, that differ in nothing but the friction:
`admm` has Pinocchio's own rigid contact at the corners, `law-force` the reference's law of friction as a force from outside.
"""

import itertools
import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pinocchio as pin

from bodycheck.adapters.contract import EngineDiverged, Method, SceneUnsupported, Strides
from bodycheck.reference.friction import NotFlat, friction, named
from bodycheck.reference.inertia import inertia_tensor
from bodycheck.reference.scene import Body, Brick, Plane, Scene, State
from bodycheck.reference.sliding import planar_state
from bodycheck.reference.trajectory import Array

Acceleration = Callable[[Array, Array], Array]
Scheme = Callable[[pin.Model, Acceleration, Array, Array, float], tuple[Array, Array]]
Step = Callable[[Array, Array], tuple[Array, Array]]
"""From q and v to q and v one time step later."""

UNIVERSE = 0
"""The joint that does not move, whose frame is the world's."""

TOLERANCE = 1e-13
"""Of the impulses and velocities at contacts, in units of the weight's impulse m g h and of g h, the velocity that it stops.

So tight because a brick that has come to rest creeps with what is left, of the order of 1e-15 m/s.
"""

ROUNDING = 16 * float(np.finfo(float).eps)
"""Of the initial velocities: what ADMM cannot fall below where that is more than the tolerance."""

PENALTY = 32.0
"""ADMM's at the start of a step, in these units; from there it is adapted by factors of two.

It is some two times the largest eigenvalue of the Delassus matrix, which for a homogeneous brick on its four corners is
between 12 and 16 whatever the lengths.
"""

UNSOLVED = 1e-6
"""Residual, in the same units, above which a step is not what its contact model says; below it, the solver has stalled."""


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


SCHEMES: dict[str, tuple[Scheme, bool]] = {
    "semi-implicit-euler": (euler, False),
    "body-twist-euler": (euler, True),
    "rk4": (rk4, True),
    "rk4-naive": (rk4_naive, True),
}
"""The step of each integrator, and whether it works on the body twist."""


def version() -> str:
    return str(pin.__version__)


def integrators(scene: Scene | None = None) -> tuple[str, ...]:
    on_plane = tuple(name for name in ON_PLANE if name != "admm" or hasattr(pin, "PointContactConstraintModel"))
    if scene is None:
        return (*SCHEMES, *on_plane)
    return on_plane if scene.plane is not None else tuple(SCHEMES)


def unsupported(scene: Scene) -> str | None:
    if scene.plane is None:
        return None
    if scene.drag:
        return "drag together with a plane"
    if not scene.gravity:
        return "contact without a weight"
    try:
        planar_state(scene)
        friction(scene.body, scene.plane, scene.gravity)
    except (NotFlat, ValueError) as error:
        return f"this contact: {error}"
    return None


def contact_law(scene: Scene, integrator: str) -> Plane | None:
    if scene.plane is None or integrator == "law-force":
        return scene.plane
    return replace(scene.plane, law="corners", pressure="balanced")


def contact_load(scene: Scene, method: Method, steps: int) -> None:
    """Not told: Pinocchio's contacts are rigid and bear the weight at all times."""


def prepare(scene: Scene, method: Method) -> "Loop":
    """As the contract has it; `admm` is for bodies with corners only."""
    if (missing := unsupported(scene)) is not None:
        raise SceneUnsupported(missing)
    known = integrators(scene)
    if method.integrator not in known:
        raise SceneUnsupported(
            f"Pinocchio {version()} has no integrator {method.integrator!r} for this scene; there are: {', '.join(known)}"
        )
    if scene.plane is not None:
        return Loop(ON_PLANE[method.integrator](scene, scene.plane, method.timestep), scene, body_twist=False)
    scheme, body_twist = SCHEMES[method.integrator]
    return Loop(in_flight(scene, scheme, method.timestep, body_twist), scene, body_twist)


def single_body(body: Body, gravity: float, body_twist: bool) -> tuple[pin.Model, int]:
    """The model of one body under gravity (m/s^2), and the index of the joint that carries it."""
    model = pin.Model()
    model.gravity.linear[:] = 0.0, 0.0, -gravity
    if body_twist:
        joint = model.addJoint(UNIVERSE, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "flight")
    else:
        slide = model.addJoint(UNIVERSE, pin.JointModelTranslation(), pin.SE3.Identity(), "translation")
        joint = model.addJoint(slide, pin.JointModelSpherical(), pin.SE3.Identity(), "rotation")
    inertia = pin.Inertia(body.mass, np.zeros(3), inertia_tensor(body))
    model.appendBodyToJoint(joint, inertia, pin.SE3.Identity())
    return model, joint


def in_flight(scene: Scene, scheme: Scheme, timestep: float, body_twist: bool) -> Step:
    """The step of a body on which gravity and drag act."""
    model, _ = single_body(scene.body, scene.gravity, body_twist)
    data, no_force = model.createData(), np.zeros(6)

    def free(q: Array, v: Array) -> Array:
        return np.asarray(pin.aba(model, data, q, v, no_force))

    def resisted(q: Array, v: Array) -> Array:
        # The generalized force of -k |v| v at the centre of mass has the components that the linear velocity has.
        force = np.concatenate([-scene.drag * np.linalg.norm(v[:3]) * v[:3], np.zeros(3)])
        return np.asarray(pin.aba(model, data, q, v, force))

    acceleration = resisted if scene.drag else free
    return lambda q, v: scheme(model, acceleration, q, v, timestep)


def rigid_contact(scene: Scene, plane: Plane, timestep: float) -> Step:
    """The step of a brick with a rigid point contact with Coulomb friction at each of its four lower corners.

    Velocities and impulses at the end of the step solve the nonlinear complementarity problem, by ADMM. The normal velocity
    of a corner is limited so that the corner ends on the plane or above it. In units of the weight's impulse m g h and of
    g h the solver's work and accuracy are the same for every mass and time step.

    A contact's frame is the world's and its point is fixed in the body: the models never change, only their data do.

    How a rigid body spreads its load over four corners is not determined: adding to the loads of two opposite corners what
    is taken from the others changes nothing but, where the corners slide in different directions, the friction. ADMM ends
    near where it starts. It starts from the impulses of the step before, turned with the body and without that alternating
    part, of which the solution then has the less the smaller the step is. In the limit the load is the linear one.

    Raises `SceneUnsupported` for bodies without corners; the step raises `EngineDiverged` where ADMM finds no solution.
    """
    shape, gravity = scene.body.shape, scene.gravity
    if not isinstance(shape, Brick):
        raise SceneUnsupported(f"admm has contacts at corners, which {named(shape)} does not have")
    model, joint = single_body(scene.body, gravity, body_twist=False)
    data, no_force = model.createData(), np.zeros(6)
    a, b, c = shape.semi_axes
    corners = np.array([[a, b, -c], [-a, b, -c], [-a, -b, -c], [a, -b, -c]])
    models, datas = pin.StdVec_ConstraintModel(), pin.StdVec_ConstraintData()
    for corner in corners:
        point = pin.SE3(np.eye(3), corner)
        contact = pin.PointContactConstraintModel(model, UNIVERSE, pin.SE3.Identity(), joint, point)
        contact.setFriction(plane.friction)
        models.append(pin.ConstraintModel(contact))
        datas.append(models[-1].createData())
    contacts = list(zip(models, datas, strict=True))

    speed = gravity * timestep
    settings = solver_settings(shape, scene.initial, speed)
    solver, result = pin.ADMMConstraintSolver(corners.size), pin.ADMMSolverResult()
    alternating = np.array([0.5, -0.5, 0.5, -0.5])
    guess = np.tile([0.0, 0.0, 0.25], (4, 1))  # a quarter of the weight on each corner; in the body frame, as it is carried on
    # In these velocities the mass matrix is the same in all configurations; in units of m, it has none.
    inverse_mass = scene.body.mass * pin.computeMinverse(model, data, pin.neutral(model))
    numbers = itertools.count(1)

    def step(q: Array, v: Array) -> tuple[Array, Array]:
        v = v + timestep * pin.aba(model, data, q, v, no_force)
        pin.computeJointJacobians(model, data, q)
        for contact, state in contacts:
            contact.calc(model, data, state)
        jacobian = pin.getConstraintsJacobian(model, data, models, datas)
        response = inverse_mass @ jacobian.T
        turn = data.oMi[joint].rotation
        drift = jacobian @ (v / speed)
        drift[2::3] += (q[2] + corners @ turn[2]) / (speed * timestep)
        result.setConstraintImpulseGuess((guess @ turn.T).ravel())
        number = next(numbers)
        if not solver.solve(pin.DelassusOperatorDense(jacobian @ response), drift, models, datas, settings, result):
            residual = max(result.primal_feasibility, result.dual_feasibility, result.complementarity)
            if not residual < UNSOLVED:
                raise EngineDiverged(f"ADMM stops at a residual of {residual:.3g} at t = {number * timestep:.6g} s")
        impulses = result.retrieveConstraintImpulses()
        np.matmul(impulses.reshape(4, 3), turn, out=guess)
        guess[:, 2] -= (alternating @ guess[:, 2]) * alternating
        v = v + response @ (speed * impulses)
        return pin.integrate(model, q, timestep * v), v

    return step


def solver_settings(shape: Brick, initial: State, velocity: float) -> pin.ADMMSolverSettings:
    """How ADMM solves the contacts of a brick that starts from some state, in units of m g h and the velocity g h (m/s)."""
    fastest = math.hypot(*initial.velocity) + math.hypot(*initial.angular_velocity) * math.hypot(*shape.semi_axes)
    tolerance = max(TOLERANCE, ROUNDING * fastest / velocity)
    settings = pin.ADMMSolverSettings()
    settings.solve_ncp = True
    settings.absolute_feasibility_tol = settings.relative_feasibility_tol = tolerance
    settings.absolute_complementarity_tol = settings.relative_complementarity_tol = tolerance
    settings.rho_init, settings.admm_update_rule = PENALTY, pin.ADMMUpdateRule.LINEAR
    return settings


def law_force(scene: Scene, plane: Plane, timestep: float) -> Step:
    """The step of a flat body on which the reference's law of friction acts as a generalized force on x, y and yaw.

    The plane bears the weight, so that neither is in the model. Where friction would reverse the motion within a step, in
    the sense of the kinetic energy's scalar product, the body rests from then on, held by static friction. Under the
    decoupled law, translation and spin come to rest each for itself.
    """
    law = friction(scene.body, plane, scene.gravity)
    model, _ = single_body(scene.body, 0.0, body_twist=False)
    data = model.createData()
    # Of the mass matrix a flat motion needs only these.
    inertia = np.array([scene.body.mass, scene.body.mass, 0.0, 0.0, 0.0, scene.body.moments[2]])
    stopping = (slice(0, 3), slice(3, 6)) if plane.law == "decoupled" else (slice(0, 6),)

    def step(q: Array, v: Array) -> tuple[Array, Array]:
        x, y, _, _, _, w = v.tolist()
        *_, k, real = q.tolist()
        cosine, sine = real * real - k * k, 2 * real * k
        f1, f2, torque = law(cosine * x + sine * y, cosine * y - sine * x, w)
        force = np.array([cosine * f1 - sine * f2, sine * f1 + cosine * f2, 0.0, 0.0, 0.0, torque])
        after = v + timestep * pin.aba(model, data, q, v, force)
        for part in stopping:
            if (inertia[part] * v[part]) @ after[part] <= 0:
                after[part] = 0.0
        return pin.integrate(model, q, timestep * after), after

    return step


ON_PLANE: dict[str, Callable[[Scene, Plane, float], Step]] = {"admm": rigid_contact, "law-force": law_force}
"""The schemes of a body on a plane."""


class Loop:
    """A Pinocchio model and its state, stepped in a Python loop."""

    def __init__(self, step: Step, scene: Scene, body_twist: bool) -> None:
        self.step, self.body_twist = step, body_twist
        initial = scene.initial
        w, x, y, z = initial.quaternion
        self.q = np.array([*initial.position, x, y, z, w])
        linear = np.array(initial.velocity)
        if body_twist:
            linear = pin.Quaternion(w, x, y, z).toRotationMatrix().T @ linear
        self.v = np.array([*linear, *initial.angular_velocity])

    def advance(self, strides: Strides) -> Array:
        step, q, v = self.step, self.q, self.v
        rows = np.empty((len(strides), 13))
        for row, stride in zip(rows, strides.tolist(), strict=True):
            for _ in range(stride):
                q, v = step(q, v)
            row[:3], row[3], row[4:7], row[7:] = q[:3], q[6], q[3:6], v
        self.q, self.v = q, v
        if self.body_twist:
            for row in rows:
                row[7:10] = pin.Quaternion(*row[3:7]).toRotationMatrix() @ row[7:10]
        return rows
