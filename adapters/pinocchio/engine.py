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
    gripping,
    mechanism_script,
    mechanisms,
    robots,
    sensing,
    single,
    touching,
)
from bodycheck.adapters.pinocchio import models as scene_models
from bodycheck.adapters.pinocchio.schemes import SCHEMES
from bodycheck.adapters.stepping import InTurn, Loop
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.requirements import grips, touches
from bodycheck.reference.scene import Plane, Scene
from bodycheck.reference.trajectory import Array

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
            demonstrates=DEMONSTRATES.get(name, ""),
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
        {
            *("gravity", "translation", "rotation", "contact", "friction", "drag"),
            *(*mechanisms.MODELS, *touching.MODELS, *gripping.MODELS),
        }
    ),
    variants={"plane": ("law-force:model=planar-joint",)},
    batch=2,
    varies=frozenset({"body"}),
    defaults=defaults(),
    reads=("step", "forward"),
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
lacking, prepare_sensing = sensing.lacking, sensing.prepare_sensing


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


def contact_law(scene: Scene, method: Method) -> Plane | None:
    """Return the friction law of a method's contacts: rigid corners for `admm`, the scene's own law for `law-force`."""
    if scene.plane is None or method.integrator != "admm":
        return scene.plane
    return replace(scene.plane, law="corners", pressure="balanced")


def prepare(scenes: Sequence[AnyScene], method: Method) -> Simulation:
    """Return the simulation of one or more scenes, as `Adapter.prepare` does."""
    if grips(scenes[0]):
        return gripping.prepare(scenes[0], method)
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
    if first.plane is None and (coordinates := scene_models.COORDINATES.get(single.model_of(first, method))) is not None:
        single.check_supported(first, method)
        return flights.flights(scenes, method, coordinates)
    if len(scenes) == 1:
        return single.alone(first, method)
    return InTurn([((index,), single.alone(scene, method)) for index, scene in enumerate(scenes)])


def prepare_links(links: Sequence[Link], scene: Scene, method: Method) -> Loop[tuple[Array, Array]]:
    """Return the simulation of a free body that is made of links, as `Links.prepare_links` does."""
    scheme, body_twist = SCHEMES[method.integrator]
    model = method.option("model") or ("six-coordinates" if body_twist else "translation-and-rotation")
    if model not in scene_models.OF_LINKS:
        raise SceneUnsupported(f"links with the model {model!r}; there are: {', '.join(scene_models.OF_LINKS)}")
    joints = scene_models.OF_LINKS[model](scene, scene.gravity, links)
    acceleration = flights.acceleration_of(scene, joints.model, joints.model.createData(), 1)
    return single.loop(single.flight_step(acceleration, scheme, joints, method.timestep), joints)


def script(scene: AnyScene, method: Method, duration: float, samples: int) -> str:
    """Return a script for Pinocchio alone, as `Scripts.script` does."""
    if touches(scene):
        raise SceneUnsupported(touching.NO_SCRIPT)
    if isinstance(scene, Mechanism):
        return mechanism_script.script(scene, method, duration, samples)
    single.check_supported(scene, method)
    model = single.model_of(scene, method)
    if scene.plane is None:
        joints = scene_models.JOINTS[model](scene, scene.gravity)
        return exporting.script(scene, method, joints, model, duration, samples)
    if method.integrator != "admm":
        raise SceneUnsupported(f"a script of {method.name!r}: its friction is a force of bodycheck, not of Pinocchio")
    joints = scene_models.JOINTS_ON_PLANE[model](scene, scene.gravity)
    return exporting.contact_script(scene, scene.plane, joints, model, method.timestep, duration, samples)
