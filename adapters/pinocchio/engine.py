"""Pinocchio: the articulated-body algorithm on one body, stepped from Python.

Pinocchio computes accelerations and leaves the stepping to its user, so the integrators here are those that users write.
`semi-implicit-euler` works on velocities that are linear in the world frame and angular in the body frame, the others on the
body twist, which is another scheme where a body moves and turns. The joints that carry the body are in `pinocchio_joints`:
as many as the scene needs.

A body on a plane has three schemes, all semi-implicit Euler: `admm` has Pinocchio's own rigid contact at the corners, in world
velocities; `law-force` the reference's law of friction as a force from outside, in world velocities; `law-force-planar` the
same on the body twist of Pinocchio's planar joint.
"""

from dataclasses import replace
from typing import Any

import numpy as np
import pinocchio as pin

from bodycheck.adapters.contract import MODEL_OPTION, Claim, EngineDiverged, Method, SceneUnsupported, Strides
from bodycheck.adapters.pinocchio import contact as pinocchio_contact
from bodycheck.adapters.pinocchio import joints as pinocchio_joints
from bodycheck.adapters.pinocchio.joints import UNIVERSE, Joints, Step
from bodycheck.adapters.pinocchio.schemes import SCHEMES, Scheme
from bodycheck.reference.errors import NotFlat
from bodycheck.reference.planar import planar_state
from bodycheck.reference.requirements import missing, requirements
from bodycheck.reference.scene import Brick, Cylinder, Ellipsoid, Plane, Scene, Shape, Sphere
from bodycheck.reference.sliding.friction import friction
from bodycheck.reference.sliding.motion import smallest_friction
from bodycheck.reference.trajectory import Array

#: What Pinocchio can model of what a scene may require.
MODELLED = frozenset({"gravity", "translation", "rotation", "contact", "friction", "drag"})

#: How far below the start a plane is that nothing ever touches (m).
FAR = 1e6

IN_FLIGHT = {
    "translation": "a translation joint",
    "rotation": "a spherical joint",
    "translation-and-rotation": "a translation joint and a spherical one; velocities linear in the world frame",
    "six-coordinates": "one free-flyer joint; velocities are the body twist",
    "far-geometry": "the body's shape and a half-space 1000 km below it, collision detection in every step",
    "everything": "energies, mass matrix, Jacobians and all other terms in every step",
}
#: What each model has that the one before it has not.
ON_PLANE = {
    "planar": "joints along x and y and about z; friction is a force from outside",
    "translation-and-rotation": "a translation joint and a spherical one",
    "six-coordinates": "one free-flyer joint; velocities are the body twist",
    "far-geometry": "the body's shape and a half-space 1000 km below it, collision detection in every step",
    "contact": "the half-space under the body, with rigid contacts solved by ADMM and gravity instead of the force",
    "everything": "energies, mass matrix, Jacobians and all other terms in every step",
}

#: The models of a body on a plane that touch it.
TOUCHING = ("contact", "everything")

JOINTS = {
    "translation": pinocchio_joints.translation,
    "rotation": pinocchio_joints.rotation,
    "translation-and-rotation": pinocchio_joints.apart,
    "six-coordinates": pinocchio_joints.free_flyer,
    "far-geometry": pinocchio_joints.free_flyer,
    "everything": pinocchio_joints.free_flyer,
}
JOINTS_ON_PLANE = JOINTS | {
    "planar": pinocchio_joints.on_axes,
    "planar-joint": pinocchio_joints.planar,
    "contact": pinocchio_joints.apart,
    "everything": pinocchio_joints.apart,
}


#: The model of each.
SCHEMES_ON_PLANE = {"admm": "contact", "law-force": "planar", "law-force-planar": "planar-joint"}


def version() -> str:
    return str(pin.__version__)


def integrators(scene: Scene | None = None) -> tuple[str, ...]:
    on_plane = tuple(name for name in SCHEMES_ON_PLANE if name != "admm" or pinocchio_contact.AVAILABLE)
    if scene is None:
        return (*SCHEMES, *on_plane)
    return on_plane if scene.plane is not None else tuple(SCHEMES)


def claim(integrator: str) -> Claim:
    """Whoever writes the classical Runge-Kutta scheme expects order 4 of it, with or without the correction."""
    stages = 4 if integrator.partition(":")[0] in ("rk4", "rk4-naive") else 1
    return Claim(order=stages, evaluations=stages)


def unsupported(scene: Scene) -> str | None:
    if (lacking := missing(scene, MODELLED)) is not None or scene.plane is None:
        return lacking
    if scene.drag:
        return "drag together with contact"
    if not scene.gravity:
        return "contact without a weight"
    try:
        planar_state(scene)
        friction(scene.body, scene.plane, scene.gravity)
    except (NotFlat, ValueError) as error:
        return f"this contact: {error}"
    return None


def models(scene: Scene, integrator: str) -> dict[str, str]:
    needs = requirements(scene)
    if needs.contact:
        return dict(ON_PLANE) if integrator == "law-force" else {}
    if integrator not in SCHEMES:
        return {}
    _, body_twist = SCHEMES[integrator]
    others = {"translation-and-rotation"} if body_twist else set()
    others |= {"rotation"} if needs.rotation == "none" else {"translation"}
    if needs.translation:
        others.add("rotation")
    if scene.body.shape is None:
        others.add("far-geometry")
    return {name: meaning for name, meaning in IN_FLIGHT.items() if name not in others}


def model_of(scene: Scene, integrator: str) -> str:
    """The model that a method's name asks for, or the smallest on which the integrator is what it is."""
    name, asked, model = integrator.partition(MODEL_OPTION)
    if asked:
        return model
    return SCHEMES_ON_PLANE.get(name, "") if scene.plane is not None else next(iter(models(scene, name)), "")


def contact_law(scene: Scene, integrator: str) -> Plane | None:
    if scene.plane is None or model_of(scene, integrator) not in TOUCHING:
        return scene.plane
    return replace(scene.plane, law="corners", pressure="balanced")


def contact_load(scene: Scene, method: Method, steps: int) -> None:
    """Not told: Pinocchio's contacts are rigid and bear the weight at all times."""


def prepare(scene: Scene, method: Method) -> "Loop":
    """As the contract has it; `admm` is for bodies with corners only."""
    if (lacking := unsupported(scene)) is not None:
        raise SceneUnsupported(lacking)
    integrator, asked, _ = method.integrator.partition(MODEL_OPTION)
    known = integrators(scene)
    if integrator not in known:
        raise SceneUnsupported(
            f"Pinocchio {version()} has no integrator {integrator!r} for this scene; there are: {', '.join(known)}"
        )
    model = model_of(scene, method.integrator)
    if asked and model not in (there := models(scene, integrator)):
        raise SceneUnsupported(f"no model {model!r} of this scene for {integrator!r}; there are: {', '.join(there) or 'none'}")
    if scene.plane is None:
        joints = JOINTS[model](scene, scene.gravity)
        scheme, _ = SCHEMES[integrator]
        step = in_flight(scene, scheme, joints, method.timestep)
    elif model in TOUCHING:
        joints = JOINTS_ON_PLANE[model](scene, scene.gravity)
        step = pinocchio_contact.rigid_contact(scene, scene.plane, joints, method.timestep)
    else:
        joints = JOINTS_ON_PLANE[model](scene, 0.0)
        step = law_force(scene, scene.plane, joints, method.timestep)
    if asked and model in ("far-geometry", *TOUCHING) and scene.body.shape is not None:
        touches = scene.plane is not None and model in TOUCHING
        step = with_collision_detection(step, joints, scene.body.shape, 0.0 if touches else FAR)
    return Loop(with_all_terms(step, joints) if model == "everything" else step, joints)


def in_flight(scene: Scene, scheme: Scheme, joints: Joints, timestep: float) -> Step:
    """The step of a body on which gravity and drag act."""
    model, data, no_force = joints.model, joints.model.createData(), np.zeros(joints.model.nv)

    def free(q: Array, v: Array) -> Array:
        return np.asarray(pin.aba(model, data, q, v, no_force))

    def resisted(q: Array, v: Array) -> Array:
        # The generalized force of -k |v| v at the centre of mass has the components that the linear velocity has.
        force = np.zeros(model.nv)
        force[:3] = -scene.drag * np.linalg.norm(v[:3]) * v[:3]
        return np.asarray(pin.aba(model, data, q, v, force))

    acceleration = resisted if requirements(scene).drag else free
    return lambda q, v: scheme(model, acceleration, q, v, timestep)


def law_force(scene: Scene, plane: Plane, joints: Joints, timestep: float) -> Step:
    """The step of a flat body on which the reference's law of friction acts as a generalized force on x, y and yaw.

    The plane bears the weight, so that neither is in the model. Where friction would reverse the motion within a step, in
    the sense of the kinetic energy's scalar product, the body rests from then on, held by static friction. Where a law brakes
    translation and spin apart, they come to rest each for itself.
    """
    law, apart = smallest_friction(scene, plane)
    model, data, heading = joints.model, joints.model.createData(), joints.heading
    # The velocities of a flat motion are the first two and the last; of the mass matrix it needs only these.
    inertia = np.zeros(model.nv)
    inertia[:2], inertia[-1] = scene.body.mass, scene.body.moments[2]
    stopping = (slice(0, -1), slice(-1, None)) if apart else (slice(None),)

    def step(q: Array, v: Array) -> tuple[Array, Array]:
        x, y, *_, w = v.tolist()
        cosine, sine = heading(q)
        f1, f2, torque = law(cosine * x + sine * y, cosine * y - sine * x, w)
        force = np.zeros(model.nv)
        force[:2], force[-1] = (cosine * f1 - sine * f2, sine * f1 + cosine * f2), torque
        after = v + timestep * pin.aba(model, data, q, v, force)
        for part in stopping:
            if (inertia[part] * v[part]) @ after[part] <= 0:
                after[part] = 0.0
        return pin.integrate(model, q, timestep * after), after

    return step


def with_collision_detection(step: Step, joints: Joints, shape: Shape, depth: float) -> Step:
    """A step after which a body's shape is looked up against the half-space below a depth (m). Raises `SceneUnsupported`."""
    library = getattr(pin, "coal", None) or getattr(pin, "hppfcl", None)
    if library is None:
        raise SceneUnsupported(f"collision detection: Pinocchio {version()} was built without it")
    match shape:
        case Brick((a, b, c)):
            solid = library.Box(2 * a, 2 * b, 2 * c)
        case Ellipsoid(semi_axes):
            solid = library.Ellipsoid(*semi_axes)
        case Cylinder(radius, half_length):
            solid = library.Cylinder(radius, 2 * half_length)
        case Sphere(radius):
            solid = library.Sphere(radius)
    ground = library.Halfspace(np.array([0.0, 0.0, 1.0]), -depth)
    model, data, geometry = joints.model, joints.model.createData(), pin.GeometryModel()
    parts = (("body", joints.joint, solid), ("ground", UNIVERSE, ground))
    numbers = [geometry.addGeometryObject(placed(name, joint, part)) for name, joint, part in parts]
    geometry.addCollisionPair(pin.CollisionPair(*numbers))
    found = geometry.createData()

    def checked(q: Array, v: Array) -> tuple[Array, Array]:
        q, v = step(q, v)
        pin.computeCollisions(model, data, geometry, found, q, False)
        return q, v

    return checked


def placed(name: str, joint: int, solid: Any) -> pin.GeometryObject:
    """A solid that is fixed to a joint, in its frame."""
    try:
        return pin.GeometryObject(name, joint, pin.SE3.Identity(), solid)
    except TypeError:  # before Pinocchio 3 the solid comes first
        return pin.GeometryObject(name, joint, solid, pin.SE3.Identity())


def with_all_terms(step: Step, joints: Joints) -> Step:
    """A step after which everything is computed that Pinocchio has to tell of the state."""
    model, data = joints.model, joints.model.createData()
    # `computeAllTerms` has made both energies; before Pinocchio 3 nothing adds them up.
    mechanical_energy = getattr(pin, "computeMechanicalEnergy", lambda model, data: data.kinetic_energy + data.potential_energy)

    def told(q: Array, v: Array) -> tuple[Array, Array]:
        q, v = step(q, v)
        pin.computeAllTerms(model, data, q, v)
        mechanical_energy(model, data)
        return q, v

    return told


class Loop:
    """A Pinocchio model and its state, stepped in a Python loop."""

    def __init__(self, step: Step, joints: Joints) -> None:
        self.step, self.joints, self.q, self.v = step, joints, joints.q, joints.v

    def advance(self, strides: Strides) -> Array:
        step, q, v = self.step, self.q, self.v
        seen = np.empty((len(strides), len(q))), np.empty((len(strides), len(v)))
        for place, stride in enumerate(strides.tolist()):
            try:
                for _ in range(stride):
                    q, v = step(q, v)
            except EngineDiverged as signal:
                seen[0][place], seen[1][place] = q, v
                signal.rows = self.joints.rows(*(states[: place + 1] for states in seen))
                raise
            seen[0][place], seen[1][place] = q, v
        self.q, self.v = q, v
        return self.joints.rows(*seen)
