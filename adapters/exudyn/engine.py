"""The adapter of Exudyn; the docstring of the package describes the methods."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import exudyn
import numpy as np
from exudyn import itemInterface, utilities

from bodycheck.adapters.contract import (
    ACCURACY,
    KINDS,
    Engine,
    Integrator,
    Kind,
    Law,
    Method,
    Role,
    SceneUnsupported,
    SensingSimulation,
    Simulation,
    Usage,
    choice,
)
from bodycheck.adapters.exudyn import (
    INSTALLATION,
    contact,
    formulations,
    jointed_bodies,
    kinematic_trees,
    sensing,
    stepping,
    touching,
)
from bodycheck.adapters.exudyn.driving import Actuated, follows
from bodycheck.adapters.exudyn.formulations import FORMULATIONS, Formulation
from bodycheck.adapters.exudyn.stepping import Stepper
from bodycheck.adapters.links import Link, links_of, state_in
from bodycheck.adapters.mechanisms import stops_of
from bodycheck.adapters.stepping import Controlled, Normalised, Taking, TakingControl, TakingLaws
from bodycheck.adapters.touching import corners
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.requirements import touches
from bodycheck.reference.scene import Scene
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.trajectory import Array

# In addition to raising errors, Exudyn prints warnings and errors, and writes errors to a file.
exudyn.config.printToConsole = exudyn.special.exceptions.writeErrorsToLogFile = False

#: The address of Exudyn's documentation.
DOCUMENTATION = "https://exudyn.readthedocs.io/en/latest/docs/RST"

#: The orders that Exudyn claims, and the numbers of evaluations in a step, of the explicit solvers.
ORDERS = {
    "ExplicitEuler": (1, 1),
    "ExplicitMidpoint": (2, 2),
    "RK33": (3, 3),
    "RK44": (4, 4),
    "RK67": (6, 7),
    "ODE23": (3, 4),
    "DOPRI5": (5, 7),
    "VelocityVerlet": (2, 1),
}

#: The features of mechanisms that Exudyn models; see `Engine.models`.
OF_MECHANISMS = frozenset(
    {
        "mechanisms",
        "revolute joints",
        "ball joints",
        "free joints",
        "prismatic joints",
        "fixed joints",
        "planar joints",
        "universal joints",
        "armature",
        "joint damping",
        "joint springs",
        "joint friction",
        "joint efforts",
        "loops",
        "massless bodies",
        "point masses",
        "controllers",
        "elastic stops",
    }
)

VARIANTS = ("RK44:formulation=Rxyz", "GeneralizedAlpha:settings=engine", "TrapezoidalIndex2:formulation=EP")


def integrators() -> tuple[Integrator, ...]:
    """Return the explicit solvers, then the implicit ones."""
    explicit = {"formulation": choice("Rxyz")}
    # On a plane, the stiffness of the contacts depends on the time step.
    controlled = explicit | {"accuracy": replace(ACCURACY, kinds=KINDS - {"plane"})}
    implicit = {"formulation": choice("EP", "Rxyz")}
    # Contacts need the iterations for discontinuities, which explicit solvers do not make.
    smooth = KINDS - {"contact"}
    return (
        *(
            Integrator(name, *ORDERS[name], smooth, options=controlled if name in stepping.CONTROLLED else explicit)
            for name in ORDERS
        ),
        Integrator("GeneralizedAlpha", 2, options={**implicit, "settings": choice("engine")}),
        Integrator("TrapezoidalIndex2", 2, options=implicit),
    )


def defaults() -> dict[str, str]:
    """Return the defaults of Exudyn's settings of simulations."""
    time = exudyn.SimulationSettings().timeIntegration
    return {
        "integrator": time.solverType.name,
        "timestep": f"{time.endTime / time.numberOfSteps:g} s",
        "tolerance": f"{time.newton.relativeTolerance:g} relative, {time.newton.absoluteTolerance:g} absolute",
    }


def roles() -> dict[Role, dict[Kind, Usage]]:
    """Return the method of Exudyn's default settings, and the same at the step of the tutorial that recommends it."""
    time = exudyn.SimulationSettings().timeIntegration
    usual = Usage(
        f"{time.solverType.name}:settings=engine",
        time.endTime / time.numberOfSteps,
        f"{DOCUMENTATION}/RunASimpleExampleInPython.html",  # "simulates everything with default values"
    )
    # "For fixed step sizes, this is the recommended integrator."
    advised = Usage("GeneralizedAlpha:settings=engine", 1e-3, f"{DOCUMENTATION}/RigidBodyAndJointsTutorial.html")
    return {"default": dict.fromkeys(KINDS, usual), "recommended": dict.fromkeys(KINDS, advised)}


engine = Engine(
    name="exudyn",
    distribution=INSTALLATION.distribution,
    version=str(exudyn.__version__),
    integrators=integrators(),
    models=frozenset({"gravity", "translation", "rotation", "contact", "friction", "drag"}) | OF_MECHANISMS | touching.MODELS,
    variants={
        "flight": VARIANTS,
        "drag": VARIANTS,
        "plane": VARIANTS[1:],
        "mechanism": VARIANTS[1:2],
        "contact": VARIANTS[1:],
    },
    defaults=defaults(),
    roles=roles(),
    reads=("step",),
)

#: The friction law of contacts.
contact_law = corners

lacking = sensing.lacking
interface_loads, contact_terms = touching.interface_loads, touching.contact_terms

#: The functions of Exudyn that steps call from Python. Exudyn itself calls the Python functions of forces.
calls = tuple((kind, "SolveSteps") for kind in (exudyn.MainSolverExplicit, exudyn.MainSolverImplicitSecondOrder))


@dataclass(frozen=True, eq=False)
class Model:
    """A model of a scene with its initialised solver.

    Parameters
    ----------
    stepper
        The simulation.
    formulation
        The formulation of the body's rotation.
    contacts
        The contacts of Exudyn; None in a scene without a plane.
    read
        Returns the readings of the sensors.
    """

    stepper: Stepper | Controlled
    formulation: Formulation
    contacts: "exudyn.GeneralContact | None"
    read: Callable[[], tuple[Array, ...]]


def prepare(scenes: Sequence[AnyScene], method: Method) -> Simulation:
    """Return the simulation of one scene, as `Adapter.prepare` does."""
    (scene,) = scenes
    if touches(scene):
        return touching.prepare(scene, method)
    if isinstance(scene, Mechanism):
        return jointed(scene, method).simulation
    return normalised(model(scene, method))


def prepare_sensing(scene: AnyScene, sensors: Sequence[Sensor], method: Method) -> SensingSimulation:
    """Return the simulation of a scene with sensors, as `Sensing.prepare_sensing` does."""
    if touches(scene):
        together = touching.built(scene, method, sensors)
        return SensingSimulation(touching.simulated(scene, together, method), together.read)
    if isinstance(scene, Mechanism):
        return jointed(scene, method, sensors)
    built = model(scene, method, sensors=sensors)
    return SensingSimulation(normalised(built), built.read)


def prepare_links(links: Sequence[Link], scene: Scene, method: Method) -> Simulation:
    """Return the simulation of a free body that is made of links, as `Links.prepare_links` does."""
    return normalised(model(scene, method, links))


def normalised(built: Model) -> Simulation:
    """Return the simulation of a model, with quaternions of norm 1."""
    # Only Euler parameters can have another norm; for the other formulations, the adapter computes the quaternions.
    return Normalised(built.stepper) if built.formulation is FORMULATIONS["EP"] else built.stepper


def model(scene: Scene, method: Method, links: Sequence[Link] = (), sensors: Sequence[Sensor] = ()) -> Model:
    """Return the model of a scene for a method, with the scene's body, or with links in place of it, and with sensors.

    Raises `SceneUnsupported`.
    """
    formulation = formulations.of_method(method)
    container = exudyn.SystemContainer()
    system = container.AddSystem()
    body = add_body(system, formulation, links_of(scene, links), scene)
    contacts = None if scene.plane is None else contact.add(system, body, scene, scene.plane, method)
    read = sensing.of_single_body(system, body, contacts, sensors)

    def seen() -> Array:
        data, count = system.systemData, formulations.coordinates(formulation)  # the first link comes first
        return np.concatenate([data.GetODE2Coordinates()[:count], data.GetODE2Coordinates_t()[:count]])

    stepper = stepping.initialised(container, system, method, seen, lambda seen: formulations.rows(formulation, seen))
    return Model(stepper, formulation, contacts, read)


def add_body(system: "exudyn.MainSystem", formulation: Formulation, links: Sequence[Link], scene: Scene) -> Any:
    """Add to a system a body of links with the weight and the drag of a scene, and return the number of its first link."""
    body = add_link(system, formulation, links[0], scene)
    for link in links[1:]:
        part = add_link(system, formulation, link, scene)
        turn = utilities.EulerParameters2RotationMatrix(link.quaternion)
        parent_marker = system.AddMarker(
            itemInterface.MarkerBodyRigid(bodyNumber=body, localHT=exudyn.HT(rotation=turn, translation=[*link.position]))
        )
        child_marker = system.AddMarker(itemInterface.MarkerBodyRigid(bodyNumber=part))
        system.AddObject(itemInterface.GenericJoint(markerNumbers=[parent_marker, child_marker]))
    if not scene.drag:
        return body
    node = system.GetObjectParameter(body, "nodeNumber")

    def force(system: "exudyn.MainSystem", time: float, load: Sequence[float]) -> list[float]:
        velocity = system.GetNodeOutput(node, exudyn.OutputVariableType.Velocity)
        return [float(part) for part in -scene.drag * np.linalg.norm(velocity) * velocity]

    centre = system.AddMarker(itemInterface.MarkerBodyPosition(bodyNumber=body))
    system.AddLoad(itemInterface.LoadForceVector(markerNumber=centre, loadVectorUserFunction=force))
    return body


def add_link(system: "exudyn.MainSystem", formulation: Formulation, link: Link, scene: Scene) -> Any:
    """Add to a system a link with its weight, at its place in the initial state of a scene, and return its number."""
    return formulations.add_body(
        system, formulation, link, state_in((link.position, link.quaternion), scene.initial), scene.gravity
    )


def contact_load(scene: Scene, method: Method, steps: int) -> Array:
    """Return the normal force (n,), in N, in each of n steps, from Exudyn's last evaluation in the step."""
    built = model(scene, method)
    assert built.contacts is not None  # the caller passes only scenes with a plane
    built.contacts.computeContactForces = True
    load = np.empty(steps)
    for step in range(steps):
        built.stepper.advance(np.array([1]))
        load[step] = built.contacts.GetSystemODE2RhsContactForces(copy=True)[2]
    return load


def jointed(mechanism: Mechanism, method: Method, sensors: Sequence[Sensor] = ()) -> SensingSimulation:
    """Return the simulation of a mechanism with sensors: as a kinematic tree if `fits` allows it, else as jointed bodies.

    Raises `SceneUnsupported`.
    """
    container = exudyn.SystemContainer()
    system = container.AddSystem()
    redundant = bool(mechanism.loops)
    if kinematic_trees.fits(mechanism):
        seen, rows, joints = kinematic_trees.add(system, mechanism, method)
        read = sensing.of_tree(system, joints.tree, mechanism, sensors)
        stepper = stepping.initialised(container, system, method, seen, rows, redundant)
        return SensingSimulation(driven(stepper, mechanism, method, joints), read)
    if mechanism.driven or any(stops_of(joint, method) for joint in mechanism.joints):
        only = "in its kinematic trees only, which begin at the world and have no balls"
        raise SceneUnsupported(f"Exudyn has stops, and efforts that change, {only}")
    formulation = formulations.of_method(method)
    assembly = jointed_bodies.add(system, mechanism, formulation)
    read = sensing.of_bodies(system, assembly, mechanism, sensors)
    stepper = stepping.initialised(container, system, method, assembly.seen, assembly.rows, redundant)
    return SensingSimulation(Normalised(stepper) if formulation is FORMULATIONS["EP"] else stepper, read)


def driven(simulation: Stepper | Controlled, mechanism: Mechanism, method: Method, joints: Actuated) -> Simulation:
    """Return the simulation of a kinematic tree whose driven joints take efforts; as it is if none are driven."""
    if not mechanism.driven:
        return simulation
    if isinstance(simulation, Controlled):
        return TakingControl(simulation, joints.state, joints.apply)
    if not follows(mechanism, method):
        return Taking(simulation, joints.state, joints.apply)

    def obey(law: Law) -> None:
        joints.obey(law)
        simulation.restart()

    return TakingLaws(simulation, joints.state, joints.apply, obey)
