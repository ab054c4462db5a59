"""Build Drake's model of a scene: a plant with one body, in a diagram if the scene has contact or drag, and its simulator."""

import math
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from pydrake.common.eigen_geometry import Quaternion
from pydrake.math import RigidTransform
from pydrake.multibody.plant import AddMultibodyPlant, ApplyMultibodyPlantConfig, MultibodyPlant, MultibodyPlantConfig
from pydrake.multibody.tree import RotationalInertia, SpatialInertia
from pydrake.systems.analysis import ResetIntegratorFromFlags, Simulator
from pydrake.systems.framework import DiagramBuilder, EventStatus, LeafSystem

from bodycheck.adapters.contract import EngineDiverged, Method, SceneUnsupported, Work
from bodycheck.adapters.drake.contact import add_contact, contact_of
from bodycheck.adapters.links import Link, links_of
from bodycheck.adapters.stepping import Controlled
from bodycheck.reference.kinematics import normalise, rotate
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array

#: The integrator that Drake offers only for a plant of the name `PLANT`, in a diagram with a scene graph; and this name. It
#: does not count its evaluations.
CENIC, PLANT = "cenic", "plant"

#: The numbers of positions (quaternion w x y z, position) and of velocities (angular, then linear; world) of a free body.
POSITIONS, VELOCITIES = 7, 6

#: The largest step of an integrator in time steps. Steps end at multiples of the time step, which are rounded. If the largest
#: step were the time step itself, Drake would divide every step that is longer because of rounding into two steps.
LARGEST_STEP = 1 + 1e-6


@dataclass(frozen=True, eq=False)
class Model:
    """Drake's model of a scene.

    Attributes
    ----------
    simulator
        The simulator, initialized at the scene's initial state and t = 0.
    plant
        The plant.
    context
        The plant's part of the simulator's context, which holds the current state.
    """

    simulator: Any
    plant: Any
    context: Any


class Drag(LeafSystem):  # type: ignore[misc]  # Drake has no types here
    """The drag -c |v| v of a free body as a generalized force on its velocities.

    Parameters
    ----------
    coefficient
        The coefficient c (kg/m).
    """

    def __init__(self, coefficient: float) -> None:
        LeafSystem.__init__(self)  # Drake requires a call by this name
        self._coefficient = coefficient
        self.DeclareVectorInputPort("state", POSITIONS + VELOCITIES)
        self.DeclareVectorOutputPort("force", VELOCITIES, self._force)

    def _force(self, context: Any, force: Any) -> None:
        *_, x, y, z = self.get_input_port().Eval(context).tolist()
        slowing = -self._coefficient * math.sqrt(x * x + y * y + z * z)
        force.SetFromVector([0.0, 0.0, 0.0, slowing * x, slowing * y, slowing * z])


def build(scene: Scene, method: Method, approximations: tuple[str, ...], links: Sequence[Link] = ()) -> Model:
    """Return the model of a scene for a method, at its initial state.

    Parameters
    ----------
    scene, method
        The scene and the method.
    approximations
        The names of the integrators that are approximations of contact of the discrete plant.
    links
        The links that replace the scene's body; if empty, the body stays.

    Raises
    ------
    SceneUnsupported
        If Drake refuses the body, or has no such contact.
    """
    scheme, config = method.integrator, configured(method, approximations)
    builder = DiagramBuilder()
    # A scene graph costs up to a fifth of a step, so a free body has one only if the integrator needs it.
    alone = scene.plane is None and not scene.drag and scheme != CENIC
    if alone:
        plant = MultibodyPlant(config.time_step)
        ApplyMultibodyPlantConfig(config, plant)
    else:
        plant, _ = AddMultibodyPlant(config, builder)
    plant.set_name(PLANT)
    body = add_body(plant, links_of(scene, links))
    plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, -scene.gravity])
    if scene.plane is not None:
        add_contact(plant, body, scene, scene.plane, contact_of(method))
    plant.Finalize()
    if scene.drag:
        drag = builder.AddSystem(Drag(scene.drag))
        builder.Connect(plant.get_state_output_port(), drag.get_input_port())
        builder.Connect(drag.get_output_port(), plant.get_applied_generalized_force_input_port())
    return started(scene, method, plant if alone else builder.Build(), plant, scheme not in approximations)


def configured(method: Method, approximations: tuple[str, ...]) -> Any:
    """Return the configuration of a plant for a method: continuous, or discrete with one of the approximations of contact.

    The output ports of a discrete plant keep the values of its last step, unless sensors are read with `sensors=forward`.
    """
    config = MultibodyPlantConfig()
    config.time_step = method.timestep if method.integrator in approximations else 0.0
    if method.integrator in approximations:
        config.discrete_contact_approximation = method.integrator
        config.use_sampled_output_ports = method.option("sensors") != "forward"
    return config


def add_body(plant: Any, links: Sequence[Link]) -> Any:
    """Add a free body of links to a plant, and return its first link. Raises `SceneUnsupported` if Drake refuses a link."""
    bodies = [add_link(plant, "body", links[0])]
    for number, link in enumerate(links[1:], 1):
        bodies.append(add_link(plant, f"link {number}", link))
        pose = RigidTransform(Quaternion(normalise(np.array(link.quaternion))), link.position)
        plant.WeldFrames(bodies[0].body_frame(), bodies[-1].body_frame(), pose)
    return bodies[0]


def add_link(plant: Any, name: str, link: Link) -> Any:
    """Add a link to a plant, and return it. Raises `SceneUnsupported` if Drake refuses it."""
    if not link.mass:
        return plant.AddRigidBody(name, SpatialInertia.Zero())  # the other function ends the process
    try:
        inertia = SpatialInertia.MakeFromCentralInertia(link.mass, link.center_of_mass, RotationalInertia(*link.inertia))
    except RuntimeError as error:
        raise SceneUnsupported(f"Drake refuses the body: {' '.join(str(error).split())}") from error
    return plant.AddRigidBody(name, inertia)


def started(scene: Scene, method: Method, system: Any, plant: Any, continuous: bool) -> Model:
    """Return the model of a scene at its initial state.

    Parameters
    ----------
    scene, method
        The scene and the method.
    system, plant
        The system to simulate, and the plant, which is the system itself or a part of it.
    continuous
        Whether an integrator steps the plant; otherwise the plant steps itself.
    """
    simulator = Simulator(system)
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    initial = scene.initial
    spin = rotate(np.array(initial.quaternion), np.array(initial.angular_velocity))
    plant.SetPositions(context, [*initial.quaternion, *initial.position])
    plant.SetVelocities(context, [*spin, *initial.velocity])
    integrated(simulator, method, continuous)
    return Model(simulator, plant, context)


def integrated(simulator: Any, method: Method, continuous: bool) -> None:
    """Initialize a simulator at the state of its context, with the method's integrator for a continuous plant.

    The integrator takes steps of fixed size, or controls the error of its steps if the method has an accuracy.
    """
    if continuous:
        largest = method.timestep if method.accuracy is not None else LARGEST_STEP * method.timestep
        ResetIntegratorFromFlags(simulator, method.integrator, largest)
        integrator = simulator.get_mutable_integrator()
        integrator.set_fixed_step_mode(method.accuracy is None)
        if method.accuracy is not None:
            integrator.set_target_accuracy(method.accuracy)
    simulator.Initialize()


#: A time (s) that no run reaches, so that it shortens no step.
NEVER = 1e9

#: The kinetic energy (J) above which the next acceleration may overflow. Integrators that iterate end the process above it.
LARGEST_ENERGY_J = 1e200


def stepper(model: Model, timestep: float) -> Callable[[int], int]:
    """Return a function that takes a time step of a model; its argument and its result are the numbers of steps taken so far.

    The function raises `EngineDiverged` as that of `stepping_to` does.
    """
    step_to = stepping_to(model)

    def step(taken: int) -> int:
        step_to((taken + 1) * timestep)
        return taken + 1

    return step


#: Builds a model, and returns it with a function that returns a copy of the numbers (k,) that describe its current state.
Built = Callable[[], tuple[Model, Callable[[], Array]]]


def controlled(built: Built, method: Method, rows: Callable[[Array], Array]) -> Controlled:
    """Return the simulation of a model by a method with error control. rows: as `Controlled.rows`."""
    model, seen = built()
    step_to, integrator = stepping_to(model), model.simulator.get_integrator()

    def at(time: float) -> Array:
        step_to(time)
        return seen()

    def work() -> Work:
        rejected = integrator.get_num_step_shrinkages_from_error_control()
        rejected += integrator.get_num_step_shrinkages_from_substep_failures()
        evaluations = integrator.get_num_derivative_evaluations()
        return Work(integrator.get_num_steps_taken(), rejected, None if method.integrator == CENIC else evaluations)

    return Controlled(method.timestep, at, rows, work, lambda times: between(model, built, times))


def between(model: Model, built: Built, times: Array) -> Iterator[Array]:
    """Yield the numbers that describe the states at ascending times (n,), in s, without ending a step of the model there.

    Each state is computed in another model of the same kind: from the end of the last own step before its time.
    """
    side, seen = built()
    step_to, own_steps_to = stepping_to(side), own_steps(model)
    for time in times.tolist():
        start, state = own_steps_to(time)
        side.simulator.get_mutable_context().SetTime(start)
        side.plant.SetPositionsAndVelocities(side.context, state)
        side.simulator.Initialize()
        step_to(time)
        yield seen()


def own_steps(model: Model) -> Callable[[float], tuple[float, Array]]:
    """Return a function that takes own steps of a model until one ends after a time (s), which is not before the last one.

    It returns the time (s) and the state of the plant at the end of the last step that ends at this time or before it.
    """
    simulator, plant, context = model.simulator, model.plant, model.context
    ends = [(context.get_time(), np.array(plant.GetPositionsAndVelocities(context)))] * 2
    wanted = 0.0

    def monitor(_: Any) -> EventStatus:
        if context.get_time() > ends[-1][0]:
            ends[:] = [ends[-1], (context.get_time(), np.array(plant.GetPositionsAndVelocities(context)))]
        return EventStatus.ReachedTermination(plant, "reached") if ends[-1][0] > wanted else EventStatus.DidNothing()

    simulator.set_monitor(monitor)
    step_to = stepping_to(model)

    def own_steps_to(time: float) -> tuple[float, Array]:
        nonlocal wanted
        wanted = time
        if ends[-1][0] <= time:
            step_to(NEVER)
        return ends[0]

    return own_steps_to


def stepping_to(model: Model) -> Callable[[float], None]:
    """Return a function that steps a model to a time (s), where a step ends.

    The function raises `EngineDiverged` if Drake fails, or if its next accelerations may overflow.
    """
    simulator, plant, context = model.simulator, model.plant, model.context

    def step_to(time: float) -> None:
        if time <= context.get_time():  # a step of no length of `cenic` would end the process
            return
        if not plant.CalcKineticEnergy(context) < LARGEST_ENERGY_J:
            raise EngineDiverged(f"Drake's accelerations overflow at t = {context.get_time():.6g} s")
        try:
            simulator.AdvanceTo(time)
        except RuntimeError as error:
            # The number is different in each run, because Drake counts the sources of poses in a process.
            words = re.sub(r" with source id \d+", "", " ".join(str(error).split()))
            raise EngineDiverged(f"Drake at t = {context.get_time():.6g} s: {words}") from error

    return step_to
