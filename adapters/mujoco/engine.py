"""The adapter of MuJoCo. It writes a scene as XML (inertia, joints, and contact or drag if needed), and steps it in C.

Single bodies in flight, or lying flat on a plane, are in the module `single`, and bodies that touch in any other way, one or
several, in `touching`. Mechanisms are in `mechanisms`, and sensors in `sensing`.
"""

from collections.abc import Sequence
from dataclasses import replace

import mujoco
import numpy as np

from bodycheck.adapters import mechanism_models as larger_mechanisms
from bodycheck.adapters.contract import (
    KINDS,
    Engine,
    Integrator,
    Method,
    Model,
    SceneUnsupported,
    Simulation,
    Strides,
    choice,
    single_bodies,
)
from bodycheck.adapters.links import Link
from bodycheck.adapters.mujoco import (
    INSTALLATION,
    bodies,
    contact,
    exporting,
    file_motion,
    gripping,
    mechanism_xml,
    mechanisms,
    options,
    robots,
    sensing,
    single,
    touching,
)
from bodycheck.adapters.mujoco import models as scene_models
from bodycheck.adapters.mujoco.models import compiled_model
from bodycheck.adapters.mujoco.stepping import CALLS, Stepper, quiet, refuse_warnings
from bodycheck.adapters.mujoco.worlds import BATCH, Worlds
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.requirements import free_bodies_touch, touches
from bodycheck.reference.scene import Brick, Plane, Scene
from bodycheck.reference.trajectory import Array

#: The integrators of the newest known release, as its XML spells them.
KNOWN_INTEGRATORS = ("Euler", "RK4", "implicit", "implicitfast", "discrete")


def integrators() -> tuple[Integrator, ...]:
    """Return all known integrators; those that the installed release lacks are offered for no scene."""
    allowed = {
        "model": choice(*dict.fromkeys((*scene_models.IN_FLIGHT, *scene_models.ON_PLANE, *larger_mechanisms.ADDS))),
        "drag": choice("fluid", kinds=frozenset({"drag"})),
        **contact.OPTIONS,
        **mechanism_xml.OPTIONS,
        **sensing.OPTIONS,
    }
    here = options.available()
    # According to MuJoCo's documentation, all integrators except RK4 are of first order.
    return tuple(
        Integrator(
            name,
            stages,
            stages,
            KINDS if name in here else frozenset(),
            allowed | (mechanism_xml.OF_EULER if name == "Euler" else {}),
        )
        for name in dict.fromkeys((*here, *KNOWN_INTEGRATORS))
        for stages in (4 if name == "RK4" else 1,)
    )


engine = Engine(
    name="mujoco",
    distribution=INSTALLATION.distribution,
    version=str(mujoco.__version__),
    integrators=integrators(),
    models=frozenset(
        {
            "gravity",
            "translation",
            "rotation",
            "contact",
            "friction",
            "drag",
            *mechanisms.MODELS,
            *touching.MODELS,
            *gripping.MODELS,
        }
    ),
    variants={
        "drag": tuple(f"{name}:drag=fluid" for name in options.available()),
        "plane": ("Euler:cone=elliptic", "Euler:cone=elliptic,pads=4", "Euler:model=planar"),
        "contact": ("Euler:cone=elliptic",),
    },
    batch=BATCH,
    varies=frozenset({"body", "gravity"}),
    defaults=options.defaults(),
    roles=options.roles(),
    soft=mechanism_xml.SOFT,
    reads=("step", "forward"),
)


calls = CALLS

interface_loads, read_robot, compiled = touching.interface_loads, robots.read_robot, robots.compiled
step_robot = robots.step_robot
file_facts, run_file = file_motion.file_facts, file_motion.run_file
lacking, prepare_sensing = sensing.lacking, sensing.prepare_sensing


def models(scene: AnyScene, integrator: str) -> dict[str, Model]:
    """Return the models of a scene by name; empty for a method with contact options or with `model=`.

    The result is also empty for bodies that touch, unless a single body lies flat on a level plane.
    """
    method = Method.parse(integrator, 0.0)
    if touches(scene) or method.option("model"):
        return {}
    if isinstance(scene, Mechanism):
        return larger_mechanisms.models(scene, integrator)
    if scene.plane is not None and method.options:
        return {}
    methods = {name: method.with_option("model", name) for name in scene_models.available_models(scene)}
    return {name: Model(methods[name].name, adds) for name, adds in scene_models.available_models(scene).items()}


def contact_law(scene: Scene, method: Method) -> Plane | None:
    """Return the friction law of a method's contacts; None if the reference has no such law.

    MuJoCo finds four contacts between a box and a plane. The reference has no law for MuJoCo's contacts of a cylinder, for
    pads, or for contacts with torsion or rolling (condim 4 and 6). Contacts of one dimension have no friction.
    """
    if scene.plane is None or not single.touches_plane(scene, method):
        return scene.plane
    condim = method.option("condim")
    if not isinstance(scene.body.shape, Brick) or method.option("pads") or condim in ("4", "6"):
        return None
    coefficient = 0.0 if condim == "1" else scene.plane.friction
    return replace(scene.plane, friction=coefficient, law="corners", pressure="balanced")


def contact_terms(scene: AnyScene, method: Method) -> str:
    """Return what MuJoCo is handed in the place of friction and restitution, as `ContactTerms.contact_terms` does."""
    external = isinstance(scene, Scene) and not touches(scene) and not single.touches_plane(scene, method)
    return "" if external else touching.contact_terms(scene, method)


def prepare(scenes: Sequence[AnyScene], method: Method) -> Simulation:
    """Return the simulation of one or more scenes, as `Adapter.prepare` does."""
    if free_bodies_touch(scenes[0]):
        return touching.prepare(scenes[0], method)
    if isinstance(scenes[0], Mechanism):
        return mechanisms.prepare(scenes[0], method)
    return unjointed(single_bodies(scenes), method)


def unjointed(scenes: Sequence[Scene], method: Method) -> Stepper | Worlds:
    """Return the simulation of one or more single bodies in flight, or lying flat on a plane. Raises `SceneUnsupported`."""
    if len(scenes) == 1:
        return single.stepper(scenes[0], method)
    model = single.model_of(scenes[0], method)
    if differ_in_numbers_alone(scenes, method, model):
        for index in bodies.may_be_refused(scenes):
            compiled_model(single.description(scenes[index], method, model)[0])
        xml, _ = single.description(scenes[0], method, model)
        models = bodies.with_bodies(compiled_model(xml), scenes)
        joints = [scene_models.joints(scene, model) for scene in scenes]
    else:
        described = [single.description(scene, method, model) for scene in scenes]
        models = bodies.compiled([compiled_model(xml) for xml, _ in described])
        joints = [joints_of_scene for _, joints_of_scene in described]
    data = mujoco.MjData(models.at([0])[0])
    return Worlds(models, data, joints, [single.external_force(scene, method, model, data) for scene in scenes])


def differ_in_numbers_alone(scenes: Sequence[Scene], method: Method, model: str) -> bool:
    """Return whether the models of scenes differ at most in mass, moments and gravity."""
    plain = scenes[0].plane is None and model in scene_models.WITHOUT_STATE and method.option("drag") != "fluid"
    return plain and len({scene.body.axes for scene in scenes}) == 1


def prepare_links(given: Sequence[Link], scene: Scene, method: Method) -> Stepper:
    """Return the simulation of a free body that is made of links, as `Links.prepare_links` does."""
    return single.started(*single.description_of_links(given, scene, method))


def script(scene: AnyScene, method: Method, duration: float, samples: int) -> str:
    """Return a script for MuJoCo alone, as `Scripts.script` does."""
    if free_bodies_touch(scene):
        return exporting.touching_script(scene, method, duration, samples)
    if isinstance(scene, Mechanism):
        return mechanisms.script(scene, method, duration, samples)
    model = single.model_of(scene, method)
    xml, joints = single.description(scene, method, model)
    compiled_model(xml)  # raises an error if MuJoCo refuses the model
    return exporting.script(scene, method, xml, joints, model, duration, samples)


def contact_load(scene: Scene, method: Method, steps: int) -> Array | None:
    """Return the normal force (n,), in N, in each of n steps; None for a model that does not touch the plane."""
    return contact_loads(scene, method, steps)[0] if single.touches_plane(scene, method) else None


def contact_loads(scene: Scene, method: Method, steps: int) -> tuple[Array, Strides]:
    """Return the normal force between body and plane, and the number of contacts that bear it, in each of n steps.

    Parameters
    ----------
    scene
        A scene with a plane.
    method
        A method whose model touches the plane.
    steps
        The number of steps n.

    Returns
    -------
    The normal force (n,) in N and the number of contacts with a normal force (n,). MuJoCo reports both at the beginning of a
    step; for RK4 they belong to the last stage.

    Raises
    ------
    SceneUnsupported
        If the scene has no plane, the model does not touch it, or MuJoCo cannot model the scene.
    EngineDiverged
        If MuJoCo gives a warning.
    """
    if not single.touches_plane(scene, method):
        raise SceneUnsupported("contact loads of a model without contact")
    simulation = single.stepper(scene, method)
    model, data = simulation.model, simulation.data
    load, touching, force = np.zeros(steps), np.zeros(steps, dtype=np.int64), np.empty(6)
    with quiet():
        for step in range(steps):
            time = data.time
            mujoco.mj_step(model, data)
            refuse_warnings(data, time)
            for number in range(data.ncon):
                mujoco.mj_contactForce(model, data, number, force)
                load[step] += force[0]
                touching[step] += force[0] > 0
    return load, touching
