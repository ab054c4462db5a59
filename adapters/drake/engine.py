"""The adapter of Drake: its integrators, its approximations of contact, and the loop of its steps."""

import logging
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from importlib import metadata

import numpy as np
from pydrake.multibody.plant import DiscreteContactApproximation, MultibodyPlantConfig
from pydrake.systems.analysis import GetIntegrationSchemes, Simulator, SimulatorConfig

from bodycheck.adapters.contract import (
    ACCURACY,
    KINDS,
    Engine,
    Integrator,
    Kind,
    Method,
    Role,
    SensingSimulation,
    Simulation,
    Usage,
    states,
)
from bodycheck.adapters.drake import INSTALLATION, file_motion, mechanisms, sensing, touching
from bodycheck.adapters.drake.contact import ON_PLANE, OPTIONS, contact_of
from bodycheck.adapters.drake.models import Model, build, controlled, stepper
from bodycheck.adapters.drake.robots import read_robot as read_robot
from bodycheck.adapters.drake.robots import step_robot as step_robot
from bodycheck.adapters.links import Link
from bodycheck.adapters.stepping import Loop, Normalised, NormalisedControl
from bodycheck.reference.kinematics import conjugate, normalise, rotate
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.requirements import touches
from bodycheck.reference.scene import Brick, Plane, Scene
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.trajectory import Array

# Drake warns of features that every scene here uses: deprecated approximations, and rigid planes that deformable bodies would
# not touch.
logging.getLogger("drake").setLevel(logging.ERROR)

#: The orders that Drake's documentation claims, and the numbers of evaluations of the accelerations in one step of fixed size.
#: Integrators that iterate have no such number.
CLAIMS: dict[str, tuple[int, int | None]] = {
    "explicit_euler": (1, 1),
    "semi_explicit_euler": (1, 1),
    "runge_kutta2": (2, 2),
    "runge_kutta3": (3, 3),
    "bogacki_shampine3": (3, 4),
    "runge_kutta5": (5, 7),
    "implicit_euler": (1, None),
    "velocity_implicit_euler": (1, None),
    "radau1": (1, None),
    "radau3": (3, None),
    "cenic": (1, None),
}

#: The explicit integrators. With Drake's default stiffness of contact (1e6 N/m a point), a body of 1 kg leaves the plane unless
#: steps are well below 0.5 ms, so these integrators are offered only in flight.
EXPLICIT = {"explicit_euler", "semi_explicit_euler", "runge_kutta2", "runge_kutta3", "bogacki_shampine3", "runge_kutta5"}

#: The implicit integrators of first order, which are not offered where bodies roll, bounce or touch each other: their steps
#: cost as much as those of radau3, and impacts need its order.
FIRST_ORDER = {"implicit_euler", "velocity_implicit_euler", "radau1"}

#: The integrators that do not estimate the error of a step, and have no error control.
WITHOUT_ESTIMATE = {"explicit_euler", "semi_explicit_euler", "runge_kutta2"}

#: The approximation of contact that Drake uses by default.
DEFAULT = "lagged"

#: Drake's names of the approximations of contact in the installed release, the default first.
APPROXIMATIONS = tuple(
    sorted(
        (name.removeprefix("k").lower() for name in DiscreteContactApproximation.__members__),
        key=lambda name: (name != DEFAULT, name),
    )
)


def integrators() -> tuple[Integrator, ...]:
    """Return the integrators of the installed release for the continuous plant, then the approximations of the discrete one."""
    names = sorted(GetIntegrationSchemes(), key=lambda name: [*CLAIMS, name].index(name))
    claims = [(name, *CLAIMS.get(name, (None, None))) for name in names]
    return tuple(
        Integrator(
            *(name, order, count),
            KINDS - ON_PLANE if name in EXPLICIT else KINDS - {"contact"} if name in FIRST_ORDER else KINDS,
            OPTIONS if name in WITHOUT_ESTIMATE else OPTIONS | {"accuracy": ACCURACY},
        )
        for name, order, count in claims
    ) + tuple(Integrator(name, 1, None, KINDS if name == DEFAULT else ON_PLANE, OPTIONS) for name in APPROXIMATIONS)


def defaults() -> dict[str, str]:
    """Return the defaults of Drake's configuration of a plant, which is discrete, and of a simulator of a continuous plant."""
    plant, simulator = MultibodyPlantConfig(), SimulatorConfig()
    return {
        "integrator": f"{plant.discrete_contact_approximation}, {simulator.integration_scheme} of a continuous plant",
        "timestep": f"{plant.time_step:g} s, at most {simulator.max_step_size:g} s of a continuous plant",
        "tolerance": f"{simulator.accuracy:g} of a continuous plant",
    }


def roles() -> dict[Role, dict[Kind, Usage]]:
    """Return the method of Drake's configuration of a plant, which is also what Drake's documentation prefers."""
    config, plane = MultibodyPlantConfig(), f"{MultibodyPlantConfig().discrete_contact_approximation}:settings=engine"
    methods = {kind: plane if kind in ON_PLANE else config.discrete_contact_approximation for kind in KINDS}
    pages: dict[Role, str] = {
        "default": "https://drake.mit.edu/doxygen_cxx/structdrake_1_1multibody_1_1_multibody_plant_config.html",
        # "Currently, this is the preferred modality given its speed and robustness", of discrete plants.
        "recommended": "https://drake.mit.edu/doxygen_cxx/group__mbp__discrete.html",
    }
    usages = {
        role: {kind: Usage(method, config.time_step, page) for kind, method in methods.items()} for role, page in pages.items()
    }
    # "We recommend switching to this model unless other requirements such as simulation speed are a constraint", of
    # hydroelastic contact.
    hydroelastic = "https://drake.mit.edu/doxygen_cxx/group__compliant__contact.html"
    usages["recommended"]["contact"] = Usage(config.discrete_contact_approximation, config.time_step, hydroelastic)
    return usages


engine = Engine(
    name="drake",
    distribution=INSTALLATION.distribution,
    version=metadata.version(INSTALLATION.distribution),
    integrators=integrators(),
    models=frozenset({"gravity", "translation", "rotation", "contact", "friction", "drag"})
    | mechanisms.MODELS
    | touching.MODELS,
    variants={
        "plane": (*(f"{name}:contact=points" for name in APPROXIMATIONS), f"{DEFAULT}:settings=engine"),
        "contact": (f"{DEFAULT}:settings=engine",),
    },
    defaults=defaults(),
    roles=roles(),
    largest_step=SimulatorConfig().max_step_size,
    combines={"friction": "harmonic mean"},
    reads=("step", "forward"),
)

contact_terms, lacking = touching.terms, sensing.lacking
file_facts, run_file = partial(file_motion.file_facts, APPROXIMATIONS), partial(file_motion.run_file, APPROXIMATIONS)


#: The functions of Drake that steps call from Python. The time of drag, which Drake calls in turn, counts as Drake's time.
calls = ((Simulator, "AdvanceTo"),)


def contact_law(scene: Scene, method: Method) -> Plane | None:
    """Return the friction law of a method's contacts: rigid corners for the option `contact=points`, else None.

    The reference has no law for the centroids of a hydroelastic mesh, nor for a single point.
    """
    if scene.plane is None or contact_of(method) != "points" or not isinstance(scene.body.shape, Brick):
        return None
    return replace(scene.plane, law="corners", pressure="balanced")


def contact_load(scene: Scene, method: Method, steps: int) -> Array | None:
    """Return the normal force (n,), in N, in each of n steps of the discrete plant; None for integrators.

    Within a step of an integrator the force has several values, and Drake reports none of them.
    """
    if scene.plane is None or method.integrator not in APPROXIMATIONS:
        return None
    model = build(scene, method, APPROXIMATIONS)
    port = model.plant.get_generalized_contact_forces_output_port(model.plant.GetBodyByName("body").model_instance())
    simulation, load = loop(model, method.timestep), np.empty(steps)
    for step in range(steps):
        simulation.advance(np.array([1]))
        load[step] = port.Eval(model.context)[5]
    return load


def interface_loads(scene: AnyScene, method: Method, steps: int) -> dict[tuple[int, int], Array]:
    """Return the normal forces between pairs that touch after each of n steps, as `InterfaceLoads.interface_loads` does."""
    return touching.interface_loads(scene, method, APPROXIMATIONS, steps)


def prepare(scenes: Sequence[AnyScene], method: Method) -> Simulation:
    """Return the simulation of one scene, as `Adapter.prepare` does."""
    (scene,) = scenes
    if touches(scene):
        return touching.prepare(scene, method, APPROXIMATIONS)
    if isinstance(scene, Mechanism):
        return mechanisms.prepare(scene, method, APPROXIMATIONS)
    return simulated(lambda: build(scene, method, APPROXIMATIONS), method)


def prepare_links(links: Sequence[Link], scene: Scene, method: Method) -> Normalised:
    """Return the simulation of a free body that is made of links, as `Links.prepare_links` does."""
    return simulated(lambda: build(scene, method, APPROXIMATIONS, links), method)


def simulated(built: Callable[[], Model], method: Method) -> Normalised:
    """Return the simulation of a model that a function builds by a method, with unit quaternions."""
    if method.accuracy is None:
        return stepped(built(), method)

    def with_state() -> tuple[Model, Callable[[], Array]]:
        model = built()
        return model, lambda: seen(model)

    return NormalisedControl(controlled(with_state, method, rows))


def stepped(model: Model, method: Method) -> Normalised:
    """Return the simulation that steps one model, also to samples with error control, with unit quaternions."""
    if method.accuracy is None:
        return Normalised(loop(model, method.timestep))
    return NormalisedControl(replace(controlled(lambda: (model, lambda: seen(model)), method, rows), between=None))


def prepare_sensing(scene: AnyScene, sensors: Sequence[Sensor], method: Method) -> SensingSimulation:
    """Return the simulation of a scene with sensors, as `Sensing.prepare_sensing` does."""
    if touches(scene):
        touched = touching.built(scene, method, APPROXIMATIONS)
        return SensingSimulation(touching.stepped(touched, method), sensing.reader(touched.model, scene, sensors))
    if isinstance(scene, Mechanism):
        actuated = [each.joint for each in sensors if each.type == "joint_effort" and each.joint is not None]
        model, seen_states, joints = mechanisms.built(scene, method, APPROXIMATIONS, actuated)
        return SensingSimulation(
            mechanisms.stepped(scene, method, model, seen_states, joints), sensing.reader(model, scene, sensors)
        )
    model = build(scene, method, APPROXIMATIONS)
    return SensingSimulation(stepped(model, method), sensing.reader(model, scene, sensors))


def loop(model: Model, timestep: float) -> Loop[int]:
    """Return the simulation of a model, whose state is the number of steps taken. Its quaternions may have any norm."""
    return Loop(0, stepper(model, timestep), lambda _: seen(model), rows)


def seen(model: Model) -> Array:
    """Return a copy of Drake's current state (13,) of a model."""
    return np.array(model.plant.GetPositionsAndVelocities(model.context))


def rows(numbers: Array) -> Array:
    """Return the rows (n, 13) of the contract from Drake's states (n, 13). Quaternions may have any norm, which they keep."""
    attitude, position, spin, velocity = np.split(numbers, (4, 7, 10), axis=1)
    return states(position, attitude, velocity, rotate(conjugate(normalise(attitude)), spin))
