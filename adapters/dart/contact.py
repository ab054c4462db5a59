"""A body that lies on a plane in DART: shapes, collision detection, and the solver of the contacts."""

import math
from collections.abc import Callable
from dataclasses import replace

import dartpy as dart

from bodycheck.adapters.contract import Kind, Method, Option, choice
from bodycheck.adapters.touching import lying_shape
from bodycheck.reference.scene import Brick, Cylinder, Plane, Scene

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

#: The kinds of scene that DART models, and those for which its own settings make a difference.
MODELLED: tuple[Kind, ...] = ("flight", "drag", "plane", "mechanism")
OWN_SETTINGS: frozenset[Kind] = frozenset({"plane", "mechanism"})

#: The options of a method.
OPTIONS: dict[str, Option] = {
    "solver": choice("pgs", *CONES, kinds=frozenset({"plane"})),
    "detector": choice(*DETECTORS, kinds=frozenset({"plane"})),
    "settings": choice("engine", kinds=OWN_SETTINGS),
}

#: Half the side and half the height (m) of the box on which the body lies. No body slides beyond the box. The results of
#: contacts on this box and on a box of 20 m agree to all printed digits.
GROUND_HALF_SIDE_M, GROUND_HALF_HEIGHT_M = 1e5, 1.0


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
    shape = lying_shape(scene)
    touching(body, solid(shape), plane)
    add_ground(world, plane, method, bricks=isinstance(shape, Brick))


def add_ground(world: "dart.simulation.World", plane: Plane, method: Method, *, bricks: bool) -> None:
    """Add to a world the plane under bodies, which are bricks or cylinders, and the detector and solver of a method."""
    ground = dart.dynamics.Skeleton("ground")
    _, fixed = ground.createWeldJointAndBodyNodePair()
    side, height = 2 * GROUND_HALF_SIDE_M, 2 * GROUND_HALF_HEIGHT_M
    below = touching(fixed, dart.dynamics.BoxShape([side, side, height]), plane)
    below.setRelativeTranslation([0.0, 0.0, -GROUND_HALF_HEIGHT_M])
    world.addSkeleton(ground)

    solver, keeps_defaults = world.getConstraintSolver(), method.option("settings") == "engine"
    name = method.option("detector") or ("fcl" if keeps_defaults else "bullet" if bricks else "ode")
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


def solid(shape: Brick | Cylinder) -> "dart.dynamics.Shape":
    """Return DART's shape of a body that lies flat."""
    if isinstance(shape, Cylinder):
        return dart.dynamics.CylinderShape(shape.radius, 2 * shape.half_length)
    return dart.dynamics.BoxShape([2 * half for half in shape.semi_axes])


def touching(body: "dart.dynamics.BodyNode", shape: "dart.dynamics.Shape", plane: Plane) -> "dart.dynamics.ShapeNode":
    """Add a shape to a body, with the friction and the restitution of the plane, and return its node.

    DART uses the smaller coefficient of friction of two shapes, and the product of their coefficients of restitution.
    """
    node = body.createShapeNode(shape)
    node.createCollisionAspect()
    dynamics = node.createDynamicsAspect()
    dynamics.setFrictionCoeff(plane.friction)
    dynamics.setRestitutionCoeff(math.sqrt(plane.restitution))
    return node


def load(world: "dart.simulation.World") -> float:
    """Return the sum (N) of the normal forces in all contacts of the last step."""
    contacts = world.getLastCollisionResult().getContacts()
    return float(sum(abs(contact.force @ contact.normal) for contact in contacts))
