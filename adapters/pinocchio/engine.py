"""The adapter of Pinocchio. It steps bodies by the articulated-body algorithm, in a Python loop.

Pinocchio computes accelerations and leaves the time integration to its user, so the integrators here are those that users
write. `semi-implicit-euler` integrates the linear velocity in the world frame and the angular velocity in the body frame. The
others integrate the body twist, which is a different scheme for a body that moves and rotates. The module `joints` builds the
joints of the body, as many as the scene needs, and `flights` steps one or several bodies in flight.

A body that lies flat on a level plane has two integrators, both semi-implicit Euler. `admm` uses Pinocchio's own rigid contact
at the corners. `law-force` applies the reference's law of friction as an external force; with `model=planar-joint` it
integrates the body twist of Pinocchio's planar joint instead of world velocities. Bodies that touch in any other way, one or
several, have `admm` alone: see the module `touching`.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pinocchio as pin

from bodycheck.adapters import mechanism_models as larger_mechanisms
from bodycheck.adapters.contract import (
    Engine,
    Integrator,
    Kind,
    Method,
    Model,
    SceneUnsupported,
    Simulation,
    choice,
    single_bodies,
)
from bodycheck.adapters.links import Link
from bodycheck.adapters.pinocchio import (
    INSTALLATION,
    contact,
    exporting,
    flights,
    mechanism_script,
    mechanisms,
    robots,
    touching,
)
from bodycheck.adapters.pinocchio import models as scene_models
from bodycheck.adapters.pinocchio.joints import Joints, Step
from bodycheck.adapters.pinocchio.schemes import SCHEMES, Scheme
from bodycheck.adapters.stepping import InTurn, Loop
from bodycheck.adapters.touching import not_flat
from bodycheck.reference.errors import NotFlat
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.requirements import touches
from bodycheck.reference.scene import Plane, Scene
from bodycheck.reference.sliding.friction import friction
from bodycheck.reference.sliding.motion import smallest_friction
from bodycheck.reference.trajectory import Array

#: The model of each integrator on a plane if the method does not select one.
SMALLEST_ON_PLANE = {"admm": "contact", "law-force": "planar"}

#: The models of each integrator on a plane that a method may select by the option `model`.
ASKED_ON_PLANE = {
    "admm": ("everything",),
    "law-force": ("planar", "planar-joint", "translation-and-rotation", "six-coordinates", "far-geometry"),
}


#: What integrators demonstrate that users may write by mistake and should not choose.
DEMONSTRATES = {
    "body-twist-euler": "the drift of a centre of mass whose velocity is integrated in turning axes",
    "rk4-naive": "the second order of a Runge-Kutta step that adds velocities of different tangent spaces",
}


def integrators() -> tuple[Integrator, ...]:
    """Return the schemes for flight and mechanisms, then those on a plane; `admm` needs a release with point contacts.

    The claimed order of `rk4-naive` is 4 as well, because users expect it from the classical Runge-Kutta scheme.
    """
    flying = tuple(
        Integrator(
            name,
            stages,
            stages,
            frozenset({"flight", "drag", "mechanism"}),
            {"model": choice(*scene_models.IN_FLIGHT, *larger_mechanisms.ADDS), **mechanisms.OPTIONS},
            DEMONSTRATES.get(name, ""),
        )
        for name in SCHEMES
        for stages in (4 if name in ("rk4", "rk4-naive") else 1,)
    )
    flat: frozenset[Kind] = frozenset({"plane"})
    any_contact: frozenset[Kind] = frozenset({"plane", "contact"} if contact.HAS_POINT_CONTACTS else ())
    return flying + tuple(
        Integrator(name, 1, 1, any_contact if name == "admm" else flat, {"model": choice(*asked, kinds=flat)})
        for name, asked in ASKED_ON_PLANE.items()
    )


def defaults() -> dict[str, str]:
    """Return the tolerance of Pinocchio's contact solver. It has no default integrator and no default time step."""
    if not contact.HAS_POINT_CONTACTS:
        return {}
    return {"tolerance": f"{pin.ADMMSolverSettings().absolute_feasibility_tol:g} of the contact solver"}


engine = Engine(
    name="pinocchio",
    distribution=INSTALLATION.distribution,
    version=str(pin.__version__),
    integrators=integrators(),
    models=frozenset(
        {"gravity", "translation", "rotation", "contact", "friction", "drag", *mechanisms.MODELS, *touching.MODELS}
    ),
    variants={"plane": ("law-force:model=planar-joint",)},
    batch=2,
    varies=frozenset({"body"}),
    defaults=defaults(),
)


#: The functions of Pinocchio that steps call from Python.
calls = tuple(
    (pin, name)
    for name in (
        *("aba", "rnea", "integrate", "dDifference", "computeAllTerms", "computeCollisions"),
        *("forwardKinematics", "computeJointJacobians", "computeMinverse", "getConstraintsJacobian", "constraintDynamics"),
    )
    if hasattr(pin, name)
)

interface_loads, read_robot = touching.interface_loads, robots.read_robot


def check_supported(scene: Scene, method: Method) -> None:
    """Raise `SceneUnsupported` if the contact or the selected model does not fit the scene."""
    if scene.plane is not None and (reason := unsupported_contact(scene, scene.plane)) is not None:
        raise SceneUnsupported(f"{engine.name} {engine.version} does not model {reason}")
    if scene.plane is not None or (model := method.option("model")) is None:
        return
    if model not in (available := scene_models.in_flight(scene, method.integrator)):
        raise SceneUnsupported(f"no model {model!r} of this scene for {method.integrator!r}; there are: {', '.join(available)}")


def unsupported_contact(scene: Scene, plane: Plane) -> str | None:
    """Return the feature of a scene with a plane that this adapter does not model, as a noun phrase; None if it models all."""
    if not scene.drag and not scene.gravity:
        return "contact without a weight"
    if (reason := not_flat(scene)) is not None:
        return reason
    try:
        friction(scene.body, plane, scene.gravity)
    except (NotFlat, ValueError) as error:
        return f"this contact: {error}"
    return None


def models(scene: AnyScene, integrator: str) -> dict[str, Model]:
    """Return the models of a scene by name; on a plane, the models in which the body touches the plane belong to `admm`."""
    if touches(scene):
        return {}
    if isinstance(scene, Mechanism):
        return {} if Method.parse(integrator, 0.0).option("model") else larger_mechanisms.models(scene, integrator)
    if scene.plane is not None:
        of_admm = {"contact": "admm", "everything": "admm:model=everything"}
        methods = {name: of_admm.get(name, f"law-force:model={name}") for name in scene_models.ON_PLANE}
        return (
            {name: Model(methods[name], scene_models.ON_PLANE[name]) for name in scene_models.ON_PLANE}
            if integrator == "law-force"
            else {}
        )
    if integrator not in SCHEMES:
        return {}
    return {
        name: Model(f"{integrator}:model={name}", scene_models.IN_FLIGHT[name])
        for name in scene_models.in_flight(scene, integrator)
    }


def model_of(scene: Scene, method: Method) -> str:
    """Return the model named by `:model=`, or the smallest model on which the integrator is the same scheme."""
    if (model := method.option("model")) is not None:
        return model
    if scene.plane is not None:
        return SMALLEST_ON_PLANE[method.integrator]
    return next(iter(scene_models.in_flight(scene, method.integrator)))


def contact_law(scene: Scene, method: Method) -> Plane | None:
    """Return the friction law of a method's contacts: rigid corners for `admm`, the scene's own law for `law-force`."""
    if scene.plane is None or method.integrator != "admm":
        return scene.plane
    return replace(scene.plane, law="corners", pressure="balanced")


def prepare(scenes: Sequence[AnyScene], method: Method) -> Simulation:
    """Return the simulation of one or more scenes, as `Adapter.prepare` does."""
    if touches(scenes[0]):
        return touching.prepare(scenes[0], method)
    if isinstance(scenes[0], Mechanism):
        return mechanisms.prepare(scenes[0], method)
    return unjointed(single_bodies(scenes), method)


def unjointed(scenes: Sequence[Scene], method: Method) -> Simulation:
    """Return the simulation of one or more single bodies in flight, or lying flat on a plane; `admm` needs bodies with corners.

    Raises `SceneUnsupported`.
    """
    first = scenes[0]
    if first.plane is None and (coordinates := scene_models.COORDINATES.get(model_of(first, method))) is not None:
        check_supported(first, method)
        return flights.flights(scenes, method, coordinates)
    if len(scenes) == 1:
        return alone(first, method)
    return InTurn([((index,), alone(scene, method)) for index, scene in enumerate(scenes)])


def alone(scene: Scene, method: Method) -> Loop[tuple[Array, Array]]:
    """Return the simulation of one scene that is not stepped with others. Raises `SceneUnsupported`."""
    check_supported(scene, method)
    model = model_of(scene, method)
    touches = scene.plane is not None and method.integrator == "admm"
    if scene.plane is None:
        joints = scene_models.JOINTS[model](scene, scene.gravity)
        scheme, _ = SCHEMES[method.integrator]
        step = flight_step(scene, scheme, joints, method.timestep)
    elif touches:
        joints = scene_models.JOINTS_ON_PLANE[model](scene, scene.gravity)
        step = contact.rigid_contact(scene, scene.plane, joints, method.timestep)
    else:
        joints = scene_models.JOINTS_ON_PLANE[model](scene, 0.0)
        step = friction_step(scene, scene.plane, joints, method.timestep)
    if scene.body.shape is not None and model in ("far-geometry", "everything"):
        step = scene_models.with_collision_detection(
            step, joints, scene.body.shape, 0.0 if touches else scene_models.FAR_PLANE_DEPTH_M
        )
    return loop(scene_models.with_all_terms(step, joints) if model == "everything" else step, joints)


def prepare_links(links: Sequence[Link], scene: Scene, method: Method) -> Loop[tuple[Array, Array]]:
    """Return the simulation of a free body that is made of links, as `Links.prepare_links` does."""
    scheme, body_twist = SCHEMES[method.integrator]
    model = method.option("model") or ("six-coordinates" if body_twist else "translation-and-rotation")
    if model not in scene_models.OF_LINKS:
        raise SceneUnsupported(f"links with the model {model!r}; there are: {', '.join(scene_models.OF_LINKS)}")
    joints = scene_models.OF_LINKS[model](scene, scene.gravity, links)
    return loop(flight_step(scene, scheme, joints, method.timestep), joints)


def script(scene: AnyScene, method: Method, duration: float, samples: int) -> str:
    """Return a script for Pinocchio alone, as `Scripts.script` does."""
    if touches(scene):
        raise SceneUnsupported(touching.NO_SCRIPT)
    if isinstance(scene, Mechanism):
        return mechanism_script.script(scene, method, duration, samples)
    check_supported(scene, method)
    model = model_of(scene, method)
    if scene.plane is None:
        joints = scene_models.JOINTS[model](scene, scene.gravity)
        return exporting.script(scene, method, joints, model, duration, samples)
    if method.integrator != "admm":
        raise SceneUnsupported(f"a script of {method.name!r}: its friction is a force of bodycheck, not of Pinocchio")
    joints = scene_models.JOINTS_ON_PLANE[model](scene, scene.gravity)
    return exporting.contact_script(scene, scene.plane, joints, model, method.timestep, duration, samples)


def loop(step: Step, joints: Joints) -> Loop[tuple[Array, Array]]:
    """Return a simulation that begins at the initial state of the joints and repeats a step."""
    nq = joints.model.nq
    return Loop(
        (joints.q, joints.v),
        lambda state: step(*state),
        lambda state: np.concatenate(state),
        lambda seen: joints.rows(seen[:, :nq], seen[:, nq:]),
    )


def flight_step(scene: Scene, scheme: Scheme, joints: Joints, timestep: float) -> Step:
    """Return the step of a body under gravity and drag.

    Parameters
    ----------
    scene
        The scene with the drag.
    scheme
        The integration scheme.
    joints
        The joints of the body, with gravity.
    timestep
        The time step (s).
    """
    model = joints.model
    acceleration = flights.acceleration_of(scene, model, model.createData(), 1)
    return lambda q, v: scheme(model, acceleration, q, v, timestep)


def friction_step(scene: Scene, plane: Plane, joints: Joints, timestep: float) -> Step:
    """Return the step of a flat body with the reference's friction as a generalized force on x, y and yaw.

    The plane bears the weight, so the model contains neither. If friction would reverse the motion within a step, in the sense
    of the scalar product of the kinetic energy, static friction holds the body at rest from then on. If the law brakes
    translation and spin separately, each of them stops separately.

    Parameters
    ----------
    scene
        The scene with the body.
    plane
        The plane with the law of friction.
    joints
        The joints of the body, without gravity.
    timestep
        The time step (s).
    """
    law, apart = smallest_friction(scene, plane)
    model, data, heading = joints.model, joints.model.createData(), joints.heading
    # A flat motion has only the first two velocities and the last one, so these entries of the mass matrix suffice.
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
