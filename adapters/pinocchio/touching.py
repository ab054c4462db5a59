"""Step free bodies that touch a plane and each other by Pinocchio's rigid contacts, solved by ADMM in every step.

Each body has a translation joint and a spherical joint at its centre of mass, so that its velocities are the velocities of the
contract. Pinocchio computes the accelerations without contact and solves the contact; the points at which bodies touch are
those of the module `contact_points`, and the step is semi-implicit Euler as in the module `contact`: the velocities and
impulses at the end of a step solve the nonlinear complementarity problem, with the normal velocity of each point limited such
that bodies end the step without overlap.

If a point would penetrate another body within the step, and the pair has a coefficient of restitution e, its normal velocity
after the step is at least -e times its normal velocity before the step instead. Bounces slower than g h, the change of a
velocity by gravity in a step, are left out, so that bodies come to rest.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pinocchio as pin

from bodycheck.adapters.contract import EngineDiverged, Method, SceneUnsupported
from bodycheck.adapters.links import link_of
from bodycheck.adapters.pinocchio import contact
from bodycheck.adapters.pinocchio.contact_points import Placed, Point, between, on_plane, radius
from bodycheck.adapters.pinocchio.joints import add_body, world
from bodycheck.adapters.stepping import Loop
from bodycheck.adapters.touching import Law, TouchingBody, acting, laws, touching_bodies
from bodycheck.reference.mechanisms.mechanism import WORLD, AnyScene
from bodycheck.reference.planar import describe_shape
from bodycheck.reference.scene import Brick, Plane, Push, Sphere
from bodycheck.reference.trajectory import Array

#: The requirements of touching bodies that Pinocchio models with the points of `contact_points`.
MODELS = frozenset({"incline", "restitution", "rolling", "pushes", "contacts", "contacts without a plane"})

#: Why there is no script of bodies that touch.
NO_SCRIPT = "a script of bodies that touch: where they do is found by bodycheck, not by Pinocchio"

#: The tolerance of the impulses and velocities at contacts, in the units of `Contacts`. For stacks, a smaller tolerance would
#: be below rounding.
TOLERANCE = 1e-12

#: The factor by which ADMM adapts its penalty. With this factor it needs fewer decompositions than with its default of 2.
PENALTY_FACTOR = 5.0

#: The rules by which ADMM adapts its penalty, each with the largest number of iterations in a step. The first rule is faster.
#: If rounding keeps it above the tolerance, as in stacks at small steps, more iterations do not help. With the second rule,
#: ADMM also solves contacts at many points that are nearly on a line.
RULES = {"LINEAR": 200, "SPECTRAL": 1000}

#: Coordinates q, then velocities v, of all bodies.
State = tuple[Array, Array]


class Contacts:
    """The bodies of a scene, and the step that solves their contacts.

    Parameters
    ----------
    scene
        The scene.
    bodies
        Its bodies.
    timestep
        The time step (s).

    Attributes
    ----------
    pressed
        The normal impulses (N s) of the last step, keyed by the indices of the two bodies.
    exerted
        The impulses (bodies, 3), in N s along the axes of the world, that contacts have exerted on each body in the last step.
    """

    def __init__(self, scene: AnyScene, bodies: Sequence[TouchingBody], timestep: float) -> None:
        self.bodies, self.timestep = bodies, timestep
        self.model = world(scene.gravity)
        self.joints = [
            add_body(self.model, [link_of(body.body)], [pin.JointModelTranslation(), pin.JointModelSpherical()])
            for body in bodies
        ]
        self.data = self.model.createData()
        # For these velocities the mass matrix does not depend on the configuration; here it is in units of the largest mass.
        self.mass = max(body.body.mass for body in bodies)
        inverse = self.mass * pin.computeMinverse(self.model, self.data, pin.neutral(self.model))
        self.inverse = [inverse[start : start + 6, start : start + 6] for start in range(0, self.model.nv, 6)]
        self.fall = scene.gravity * timestep
        self.unit = self.fall or 1.0
        self.plane = None if scene.plane is None else axes_of(scene.plane)
        usual, *others = laws(scene)
        self.usual, self.others = usual, {law.bodies: law for law in others}
        self.radii = np.array([radius(body.shape) for body in bodies])
        self.pushes, self.steps = acting(scene.pushes, timestep), 0
        self.guess: dict[tuple[tuple[int, int], int], Array] = {}
        self.solver = Solver(self.model, self.joints[0])
        self.pressed: dict[tuple[int, int], float] = {}
        self.exerted = np.full((len(bodies), 3), np.nan)

    def step(self, state: State) -> State:
        """Return the state one step later. Raises `EngineDiverged` if ADMM finds no solution."""
        q, v = state
        pushes = next(self.pushes)
        self.steps += 1
        before = v
        v = v + self.timestep * pin.aba(self.model, self.data, q, v, self._forces(q, pushes))
        pin.forwardKinematics(self.model, self.data, q)
        placed = [
            Placed(body.shape, self.data.oMi[joint].translation.copy(), self.data.oMi[joint].rotation.copy())
            for body, joint in zip(self.bodies, self.joints, strict=True)
        ]
        points = list(self._points(placed, v))
        self.pressed, self.exerted = {}, np.zeros((len(self.bodies), 3))
        if points:
            v = v + self._change(points, placed, before, v)
        return pin.integrate(self.model, q, self.timestep * v), v

    def _forces(self, q: Array, pushes: Sequence[Push]) -> Array:
        """Return the generalized forces of pushes."""
        forces = np.zeros(self.model.nv)
        for push in pushes:
            x, y, z, w = q[7 * push.body + 3 : 7 * push.body + 7]
            along = pin.Quaternion(w, x, y, z).matrix().T @ push.force
            forces[6 * push.body : 6 * push.body + 3] += push.force
            forces[6 * push.body + 3 : 6 * push.body + 6] += np.cross(push.point, along)
        return forces

    def _points(self, placed: Sequence[Placed], v: Array) -> list[Point]:
        """Return the points that may touch within the step, with velocities v (6 bodies,)."""
        moving = v.reshape(-1, 6)
        reach = np.linalg.norm(moving[:, :3], axis=1) + np.linalg.norm(moving[:, 3:], axis=1) * self.radii
        margins = 2 * self.timestep * (reach + 2 * self.unit)
        points: list[Point] = []
        if self.plane is not None:
            for index, body in enumerate(placed):
                points.extend(on_plane(index, body, self.plane, float(margins[index])))
        centres = np.array([body.centre for body in placed])
        apart = np.linalg.norm(centres[:, None] - centres, axis=2)
        sizes = self.radii + margins
        near = np.argwhere(np.triu(apart <= sizes[:, None] + sizes, 1))  # usually a few of many pairs
        for one, other in near.tolist():
            if self.plane is None and (one, other) not in self.others:
                continue  # without a plane only the pairs that are named touch
            points.extend(between((one, other), placed[one], placed[other], float(margins[one] + margins[other])))
        return points

    def _change(self, points: Sequence[Point], placed: Sequence[Placed], before: Array, v: Array) -> Array:
        """Return the change of the velocities by contacts; `v` (6 bodies,) are the velocities of the step without contacts."""
        laws = [self.others.get(point.bodies, self.usual) for point in points]
        jacobian = Jacobian(points, placed)
        drift, incoming = jacobian.velocities(v), jacobian.velocities(before)[2::3]
        aim(drift, incoming, points, laws, self.timestep, self.fall)
        keys = [(point.bodies, point.number) for point in points]
        guess = np.concatenate([self.guess.get(key, np.zeros(3)) for key in keys])
        frictions, time = tuple(law.friction for law in laws), self.steps * self.timestep
        impulses = self.solver.solved(jacobian.delassus(self.inverse), drift / self.unit, guess, frictions, time)
        self.guess = dict(zip(keys, impulses.reshape(-1, 3), strict=True))
        for point, impulse in zip(points, self.mass * self.unit * impulses.reshape(-1, 3), strict=True):
            self.pressed[point.bodies] = self.pressed.get(point.bodies, 0.0) + float(impulse[2])
            for body, sign in zip(point.bodies, (-1.0, 1.0), strict=True):
                if body != WORLD:
                    self.exerted[body] += sign * point.axes @ impulse
        return jacobian.change(self.inverse, self.unit * impulses)


def aim(drift: Array, incoming: Array, points: Sequence[Point], laws: Sequence[Law], timestep: float, fall: float) -> None:
    """Change the velocities (3n,) at n points such that those with contacts end the step without overlap, or bounce.

    incoming: the normal velocities (n,) before the step. fall: the change of a velocity (m/s) by gravity in a step.
    """
    gaps, restitutions = np.array([point.gap for point in points]), np.array([law.restitution for law in laws])
    bouncing = (gaps + timestep * drift[2::3] < 0) & (-restitutions * incoming > fall)
    drift[2::3] += np.where(bouncing, restitutions * incoming, gaps / timestep)


class Solver:
    """ADMM for the impulses at contacts.

    Parameters
    ----------
    model, joint
        The model, and any of its joints: the solver uses only the friction cones of contacts.
    """

    def __init__(self, model: pin.Model, joint: int) -> None:
        self.model, self.joint = model, joint
        self.models: dict[tuple[float, ...], tuple[tuple[Any, Any], Any]] = {}
        self.settings, self.result = settings(), pin.ADMMSolverResult()

    def solved(self, delassus: Array, drift: Array, guess: Array, frictions: tuple[float, ...], time: float) -> Array:
        """Return the impulses (3n,) at n contacts, in units such that gravity changes a velocity by 1 in a step.

        time: the time (s) for the message. Raises `EngineDiverged` if ADMM finds no solution.
        """
        if frictions not in self.models:
            # The solver uses only the friction cones, so the positions of the points do not matter.
            nowhere = np.zeros((len(frictions), 3))
            models = contact.point_contacts(self.model, self.joint, nowhere, frictions)
            self.models[frictions] = models, pin.ADMMConstraintSolver(3 * len(frictions))
        models, admm = self.models[frictions]
        tolerance = max(TOLERANCE, contact.SPEED_ROUNDING * float(np.abs(drift).max()))
        chosen, result = self.settings, self.result
        contact.set_tolerance(chosen, tolerance)
        chosen.rho_init = 2 * float(np.abs(delassus).sum(axis=1).max())
        for rule, most in RULES.items():
            chosen.admm_update_rule, chosen.max_iterations = getattr(pin.ADMMUpdateRule, rule), most
            result.setConstraintImpulseGuess(guess)
            residual = contact.residual_of(admm, models, delassus, drift, chosen, result)
            if residual < contact.STALL_RESIDUAL:
                return np.asarray(result.retrieveConstraintImpulses()).copy()
        raise EngineDiverged(f"ADMM stops at a residual of {residual:.3g} at t = {time:.6g} s")


class Jacobian:
    """The linear map from the velocities of bodies to the velocities of the second body relative to the first at n points.

    The velocities at a point are along its axes. The map is stored by bodies, because each point involves only one or two
    bodies. The products are then so small that NumPy computes them in one thread.
    """

    def __init__(self, points: Sequence[Point], placed: Sequence[Placed]) -> None:
        by_body: dict[int, list[tuple[int, Array]]] = {}
        for number, point in enumerate(points):
            for index, sign in zip(point.bodies, (-1.0, 1.0), strict=True):
                if index != WORLD:
                    x, y, z = point.position - placed[index].centre
                    crossed = np.array([[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]])
                    along = sign * point.axes.T
                    by_body.setdefault(index, []).append((number, np.hstack([along, along @ crossed @ placed[index].turn])))
        self.size, self.bodies = 3 * len(points), len(placed)
        self.blocks = {
            index: (
                np.concatenate([np.arange(3 * number, 3 * number + 3) for number, _ in blocks_of_body]),
                np.vstack([b for _, b in blocks_of_body]),
            )
            for index, blocks_of_body in by_body.items()
        }

    def velocities(self, v: Array) -> Array:
        """Return the relative velocities (3n,) at the points for the velocities (6 bodies,) of the bodies."""
        at_points = np.zeros(self.size)
        for index, (rows, block) in self.blocks.items():
            at_points[rows] += block @ v[6 * index : 6 * index + 6]
        return at_points

    def delassus(self, inverse: Sequence[Array]) -> Array:
        """Return the matrix (3n, 3n) from impulses to velocities at the points; `inverse` are inverse mass matrices (6, 6)."""
        matrix = np.zeros((self.size, self.size))
        for index, (rows, block) in self.blocks.items():
            matrix[np.ix_(rows, rows)] += block @ inverse[index] @ block.T
        return matrix

    def change(self, inverse: Sequence[Array], impulses: Array) -> Array:
        """Return the changes of the velocities of bodies (6 bodies,) by impulses (3n,) at the points."""
        of_bodies = np.zeros(6 * self.bodies)
        for index, (rows, block) in self.blocks.items():
            of_bodies[6 * index : 6 * index + 6] = inverse[index] @ (block.T @ impulses[rows])
        return of_bodies


def axes_of(plane: Plane) -> Array:
    """Return the matrix (3, 3) whose columns are the axes of a plane: downhill, across, and the normal."""
    cosine, sine = np.cos(plane.incline), np.sin(plane.incline)
    return np.array([[cosine, 0.0, sine], [0.0, 1.0, 0.0], [-sine, 0.0, cosine]])


def settings() -> "pin.ADMMSolverSettings":
    """Return ADMM's settings, except the tolerance and the penalty, which are set in each step."""
    chosen = pin.ADMMSolverSettings()
    chosen.solve_ncp = True
    chosen.linear_update_rule_factor = PENALTY_FACTOR
    return chosen


def prepare(scene: AnyScene, method: Method) -> Loop[State]:
    """Return the simulation of bodies that touch, as `Adapter.prepare` does. Raises `SceneUnsupported`."""
    return simulated(built(scene, method))


def simulated(contacts: Contacts) -> Loop[State]:
    """Return the simulation of bodies at t = 0."""
    count = len(contacts.bodies)
    return Loop(begin(contacts.bodies), contacts.step, np.concatenate, lambda seen: states_of(seen, count))


def interface_loads(scene: AnyScene, method: Method, steps: int) -> Mapping[tuple[int, int], Array]:
    """Return the normal forces between pairs that touch in each of n steps, as `InterfaceLoads.interface_loads` does."""
    contacts = built(scene, method)
    state = begin(contacts.bodies)
    by_pair: dict[tuple[int, int], Array] = {}
    for step in range(steps):
        state = contacts.step(state)
        for pair, pressed in contacts.pressed.items():
            by_pair.setdefault(pair, np.zeros(steps))[step] = pressed / method.timestep
    return by_pair


def built(scene: AnyScene, method: Method) -> Contacts:
    """Return the bodies of a scene on their joints. Raises `SceneUnsupported`."""
    if not contact.HAS_POINT_CONTACTS:
        raise SceneUnsupported(f"contact: Pinocchio {pin.__version__} has no point contacts")
    if (model := method.option("model")) is not None:
        raise SceneUnsupported(f"no model {model!r} of bodies that touch")
    bodies = touching_bodies(scene)
    if len(bodies) > 1:
        for body in bodies:
            if not isinstance(body.shape, Brick | Sphere):
                raise SceneUnsupported(
                    f"{describe_shape(body.shape)} among several: contacts of bricks and spheres alone are found"
                )
    return Contacts(scene, bodies, method.timestep)


def begin(bodies: Sequence[TouchingBody]) -> State:
    """Return the coordinates and velocities of bodies at t = 0; Pinocchio's quaternions are x, y, z, w."""
    starts = [body.start for body in bodies]
    q = np.concatenate([(*start.position, *start.quaternion[1:], start.quaternion[0]) for start in starts])
    return q, np.concatenate([(*start.velocity, *start.angular_velocity) for start in starts])


def states_of(seen: Array, bodies: int) -> Array:
    """Return the states (n, bodies, 13) from coordinates and velocities (n, 7 + 6 bodies)."""
    q, v = np.split(seen, [7 * bodies], axis=1)
    q = q.reshape(-1, bodies, 7)[..., [0, 1, 2, 6, 3, 4, 5]]
    return np.concatenate([q, v.reshape(-1, bodies, 6)], axis=2)
