"""The adapter of Pinocchio: the articulated-body algorithm on one body, stepped from Python.

Pinocchio computes accelerations and leaves the stepping to its user, so the integrators here are those that users write.
`semi-implicit-euler` works on velocities that are linear in the world frame and angular in the body frame, the others on the
body twist, which is another scheme where a body moves and turns. The module `joints` has the joints that carry the body: as
many as the scene needs.

A body on a plane has two integrators, both semi-implicit Euler in world velocities: `admm` has Pinocchio's own rigid contact at
the corners; `law-force` has the reference's law of friction as a force from outside, with `model=planar-joint` on the body
twist of Pinocchio's planar joint.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pinocchio as pin

from bodycheck.adapters.contract import Engine, Integrator, Method, Model, SceneUnsupported, choice
from bodycheck.adapters.pinocchio import DISTRIBUTION, contact
from bodycheck.adapters.pinocchio import models as growth
from bodycheck.adapters.pinocchio.joints import Joints, Step
from bodycheck.adapters.pinocchio.schemes import SCHEMES, Scheme
from bodycheck.adapters.stepping import Loop
from bodycheck.reference.errors import NotFlat
from bodycheck.reference.planar import planar_state
from bodycheck.reference.requirements import requirements
from bodycheck.reference.scene import Plane, Scene
from bodycheck.reference.sliding.friction import friction
from bodycheck.reference.sliding.motion import smallest_friction
from bodycheck.reference.trajectory import Array

#: The model of each.
#: The model of each integrator on a plane.
SMALLEST_ON_PLANE = {"admm": "contact", "law-force": "planar"}

#: The models of each integrator on a plane that a method may ask for by the option `model`.
ASKED_ON_PLANE = {
    "admm": ("everything",),
    "law-force": ("planar", "planar-joint", "translation-and-rotation", "six-coordinates", "far-geometry"),
}


def integrators() -> tuple[Integrator, ...]:
    """The schemes for flight, then those on a plane; a release without point contacts offers no `admm`.

    Whoever writes the classical Runge-Kutta scheme expects order 4 of it, with or without the correction.
    """
    flying = tuple(
        Integrator(name, stages, stages, frozenset({"flight", "drag"}), {"model": choice(*growth.IN_FLIGHT)})
        for name in SCHEMES
        for stages in (4 if name in ("rk4", "rk4-naive") else 1,)
    )
    return flying + tuple(
        Integrator(name, 1, 1, frozenset({"plane"} if name != "admm" or contact.AVAILABLE else ()), {"model": choice(*asked)})
        for name, asked in ASKED_ON_PLANE.items()
    )


engine = Engine(
    name="pinocchio",
    distribution=DISTRIBUTION,
    version=str(pin.__version__),
    integrators=integrators(),
    models=frozenset({"gravity", "translation", "rotation", "contact", "friction", "drag"}),
    variants={"plane": ("law-force:model=planar-joint",)},
)


def refuse(scene: Scene, method: Method) -> None:
    """Raises `SceneUnsupported` for a contact or a model that a scene cannot have."""
    if scene.plane is not None and (reason := unsupported_contact(scene, scene.plane)) is not None:
        raise SceneUnsupported(f"{engine.name} {engine.version} does not model {reason}")
    if scene.plane is not None or (asked := method.option("model")) is None:
        return
    if asked not in (there := growth.in_flight(scene, method.integrator)):
        raise SceneUnsupported(f"no model {asked!r} of this scene for {method.integrator!r}; there are: {', '.join(there)}")


def unsupported_contact(scene: Scene, plane: Plane) -> str | None:
    """What of a contact is not modelled here, in words; None where all of it is."""
    if scene.drag:
        return "drag together with contact"
    if not scene.gravity:
        return "contact without a weight"
    try:
        planar_state(scene)
        friction(scene.body, plane, scene.gravity)
    except (NotFlat, ValueError) as error:
        return f"this contact: {error}"
    return None


def models(scene: Scene, integrator: str) -> dict[str, Model]:
    """The models of a scene; those on a plane that touch it are those of `admm`."""
    if scene.plane is not None:
        own = {"contact": "admm", "everything": "admm:model=everything"}
        asked = {name: own.get(name, f"law-force:model={name}") for name in growth.ON_PLANE}
        return (
            {name: Model(asked[name], growth.ON_PLANE[name]) for name in growth.ON_PLANE} if integrator == "law-force" else {}
        )
    if integrator not in SCHEMES:
        return {}
    return {name: Model(f"{integrator}:model={name}", growth.IN_FLIGHT[name]) for name in growth.in_flight(scene, integrator)}


def model_of(scene: Scene, method: Method) -> str:
    """The model that a method asks for, or the smallest on which its integrator remains the same scheme."""
    if (asked := method.option("model")) is not None:
        return asked
    if scene.plane is not None:
        return SMALLEST_ON_PLANE[method.integrator]
    return next(iter(growth.in_flight(scene, method.integrator)))


def contact_law(scene: Scene, method: Method) -> Plane | None:
    """The law of friction of a method's contacts: rigid corners, or for `law-force` the scene's own."""
    if scene.plane is None or method.integrator != "admm":
        return scene.plane
    return replace(scene.plane, law="corners", pressure="balanced")


def contact_load(scene: Scene, method: Method, steps: int) -> None:
    """Not known: Pinocchio's contacts are rigid and bear the weight at all times."""


def prepare(scenes: Sequence[Scene], method: Method) -> Loop[tuple[Array, Array]]:
    """The simulation of one scene; `admm` is for bodies with corners only."""
    (scene,) = scenes
    refuse(scene, method)
    model = model_of(scene, method)
    touches = scene.plane is not None and method.integrator == "admm"
    if scene.plane is None:
        joints = growth.JOINTS[model](scene, scene.gravity)
        scheme, _ = SCHEMES[method.integrator]
        step = in_flight(scene, scheme, joints, method.timestep)
    elif touches:
        joints = growth.JOINTS_ON_PLANE[model](scene, scene.gravity)
        step = contact.rigid_contact(scene, scene.plane, joints, method.timestep)
    else:
        joints = growth.JOINTS_ON_PLANE[model](scene, 0.0)
        step = law_force(scene, scene.plane, joints, method.timestep)
    if scene.body.shape is not None and model in ("far-geometry", "everything"):
        step = growth.with_collision_detection(step, joints, scene.body.shape, 0.0 if touches else growth.FAR)
    return loop(growth.with_all_terms(step, joints) if model == "everything" else step, joints)


def loop(step: Step, joints: Joints) -> Loop[tuple[Array, Array]]:
    """The simulation that takes a step at a time from where the joints stand."""
    nq = joints.model.nq
    return Loop(
        (joints.q, joints.v),
        lambda state: step(*state),
        lambda state: np.concatenate(state),
        lambda seen: joints.rows(seen[:, :nq], seen[:, nq:]),
    )


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
