"""Bodies that touch a plane in DART: shapes, collision detection, the solver of the contacts, and their law."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import dartpy as dart

from bodycheck.adapters.contract import Kind, Method, Option, choice
from bodycheck.adapters.dart.bodies import pose
from bodycheck.adapters.touching import lying_shape
from bodycheck.reference.scene import Brick, Cylinder, Ellipsoid, Plane, Scene, Shape

#: DART's detectors of collisions.
DETECTORS: dict[str, Callable[[], "dart.collision.CollisionDetector"]] = {
    "dart": dart.collision.DARTCollisionDetector,
    "fcl": dart.collision.FCLCollisionDetector,
    "bullet": dart.collision.BulletCollisionDetector,
    "ode": dart.collision.OdeCollisionDetector,
}

#: Solvers of contacts whose friction is in Coulomb's cone.
CONES: dict[str, Callable[[], "dart.constraint.BoxedLcpSolver"]] = {
    "nsgs": dart.constraint.NsgsFrictionSolver,
    "fbf": dart.constraint.FbfFrictionSolver,
}

#: The name of the skeleton of what does not move.
GROUND = "ground"

#: The kinds of scene that DART models, and those for which its own settings make a difference.
MODELLED: tuple[Kind, ...] = ("flight", "drag", "plane", "contact", "mechanism")
OWN_SETTINGS: frozenset[Kind] = frozenset({"plane", "contact", "mechanism"})

#: The kinds of scene with contacts.
TOUCHING: frozenset[Kind] = frozenset({"plane", "contact"})

#: The options of a method.
OPTIONS: dict[str, Option] = {
    "solver": choice("pgs", *CONES, kinds=TOUCHING),
    "detector": choice(*DETECTORS, kinds=TOUCHING),
    "settings": choice("engine", kinds=OWN_SETTINGS),
}

#: Half the side and half the height (m) of the box on which bodies lie. No body slides beyond the box. The results of
#: contacts on this box and on a box of 20 m agree to all printed digits.
GROUND_HALF_SIDE_M, GROUND_HALF_HEIGHT_M = 1e5, 1.0

#: The coefficients of friction and of restitution up to which DART has a contact without them.
NO_FRICTION, NO_RESTITUTION = 1e-3, 1e-3

#: The velocities (m/s) of the slowest and of the fastest rebound.
SLOWEST_REBOUND, FASTEST_REBOUND = 0.1, 100.0


def law(scene: Scene, method: Method) -> Plane | None:
    """Return the friction law of a method's contacts; None if the reference has no such law.

    The reference has no law for friction in a box, which is anisotropic, and none for the contact points under a cylinder.
    """
    if scene.plane is None or method.option("solver") not in CONES or not isinstance(scene.body.shape, Brick):
        return None
    return replace(scene.plane, law="corners", pressure="balanced")


def add(world: "dart.simulation.World", body: "dart.dynamics.BodyNode", scene: Scene, plane: Plane, method: Method) -> None:
    """Add to a world the plane under a body, the shape of the body, and the detector and solver of contacts of a method.

    Raises `SceneUnsupported` for a body that does not lie flat.
    """
    shape, restitution = lying_shape(scene), math.sqrt(plane.restitution)
    touching(body, solid(shape), plane.friction, restitution)
    add_box(world, plane, plane.friction, restitution)
    solve(world, method, "bullet" if isinstance(shape, Brick) else "ode")


def add_box(world: "dart.simulation.World", plane: Plane, friction: float, restitution: float) -> None:
    """Add to a world a large box whose upper face is the plane, with the coefficients of its shape."""
    side, height = 2 * GROUND_HALF_SIDE_M, 2 * GROUND_HALF_HEIGHT_M
    below = add_ground(world, dart.dynamics.BoxShape([side, side, height]), friction, restitution)
    turn = (math.cos(plane.incline / 2), 0.0, math.sin(plane.incline / 2), 0.0)
    below.setRelativeTransform(pose([-GROUND_HALF_HEIGHT_M * part for part in plane.normal], turn))


def add_ground(world: "dart.simulation.World", shape: "dart.dynamics.Shape", friction: float, restitution: float) -> Any:
    """Add to a world a shape that does not move, with its coefficients, and return its node."""
    ground = dart.dynamics.Skeleton(GROUND)
    _, fixed = ground.createWeldJointAndBodyNodePair()
    node = touching(fixed, shape, friction, restitution)
    world.addSkeleton(ground)
    return node


def solve(world: "dart.simulation.World", method: Method, detector: str) -> None:
    """Choose the solver of contacts of a method in a world, and the detector unless the method chooses another."""
    solver, keeps_defaults = world.getConstraintSolver(), method.option("settings") == "engine"
    name = method.option("detector") or ("fcl" if keeps_defaults else detector)
    solver.setCollisionDetector(DETECTORS[name]())
    solver_name = method.option("solver")
    if solver_name == "pgs":
        # This solver cannot be constructed from Python, but every world has one in case Dantzig's algorithm fails. A world
        # refuses its own solver, because it would then have the same solver twice.
        other = dart.simulation.World().getConstraintSolver()
        solver.setBoxedLcpSolver(other.getSecondaryBoxedLcpSolver())
    elif solver_name is not None:
        solver.setBoxedLcpSolver(CONES[solver_name]())
    sleeping = world.getDeactivationOptions()
    sleeping.mEnabled = keeps_defaults
    world.setDeactivationOptions(sleeping)


def solid(shape: Shape) -> "dart.dynamics.Shape":
    """Return DART's shape of a body."""
    match shape:
        case Brick((a, b, c)):
            return dart.dynamics.BoxShape([2 * a, 2 * b, 2 * c])
        case Ellipsoid((a, b, c)):
            return dart.dynamics.EllipsoidShape([2 * a, 2 * b, 2 * c])
        case Cylinder(radius, half_length):
            return dart.dynamics.CylinderShape(radius, 2 * half_length)
        case _:
            return dart.dynamics.SphereShape(shape.radius)


def touching(
    body: "dart.dynamics.BodyNode", shape: "dart.dynamics.Shape", friction: float, restitution: float
) -> "dart.dynamics.ShapeNode":
    """Add a shape with its coefficients of friction and of restitution to a body, and return its node.

    DART uses the smaller coefficient of friction of two shapes, and the product of their coefficients of restitution.
    """
    node = body.createShapeNode(shape)
    node.createCollisionAspect()
    dynamics = node.createDynamicsAspect()
    dynamics.setFrictionCoeff(friction)
    dynamics.setRestitutionCoeff(restitution)
    return node


def load(world: "dart.simulation.World") -> float:
    """Return the sum (N) of the normal forces in all contacts of the last step."""
    contacts = world.getLastCollisionResult().getContacts()
    return float(sum(abs(contact.force @ contact.normal) for contact in contacts))
