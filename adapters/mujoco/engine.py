"""The adapter of MuJoCo. It writes a scene as XML (inertia, joints, and contact or drag if needed), and steps it in C.

For a free joint, qpos is (position in the world frame, quaternion w x y z), and qvel is (linear velocity in the world frame,
angular velocity in the body frame). The module `models` contains the other joints and the larger models, and `stepping` the
loop of steps.

Drag is an external force that is evaluated together with MuJoCo's own passive forces, so that every integrator keeps its
order. The option `drag=fluid` selects MuJoCo's own fluid model instead: an inertia box in a medium, with a drag along each
axis of the body and a drag against its rotation. The density of the medium is chosen such that the drag along the axis of
the smallest moment, along which a long body flies, equals that of the scene.

A body that lies flat on a level plane touches it by MuJoCo's own soft contact, whose options the module `contact` defines. The
option `model=planar` selects the smallest model instead: three coordinates, with the reference's friction as an external force.
Bodies that touch in any other way, one or several, are in the module `touching`.
"""

import math
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
    mechanism_xml,
    mechanisms,
    options,
    robot_steps,
    robots,
    touching,
)
from bodycheck.adapters.mujoco import models as scene_models
from bodycheck.adapters.mujoco.models import compiled_model
from bodycheck.adapters.mujoco.stepping import CALLS, Stepper, quiet, refuse_warnings
from bodycheck.adapters.mujoco.worlds import BATCH, Worlds
from bodycheck.adapters.touching import not_flat
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.requirements import requirements, touches
from bodycheck.reference.scene import Brick, Plane, Scene
from bodycheck.reference.trajectory import Array

XML = """
<mujoco>
  <compiler balanceinertia="false" inertiafromgeom="false"/>
  <option timestep="{timestep!r}" integrator="{integrator}" gravity="0 0 {gravity!r}" density="{density!r}" {parts.option}>
    <flag {parts.flags}/>
  </option>
  {parts.default}
  <worldbody>
    {parts.plane}
    <body name="body" pos="{origin}">
      {joints}
      {inertial}
      {parts.geoms}
    </body>
  </worldbody>
  {parts.sensors}
</mujoco>
"""

INERTIAL = '<inertial pos="0 0 0" mass="{mass!r}" quat="{axes}" diaginertia="{moments}"/>'

#: The integrators of the newest known release, as its XML spells them.
KNOWN_INTEGRATORS = ("Euler", "RK4", "implicit", "implicitfast", "discrete")


def integrators() -> tuple[Integrator, ...]:
    """Return all known integrators; those that the installed release lacks are offered for no scene."""
    allowed = {
        "model": choice(*dict.fromkeys((*scene_models.IN_FLIGHT, *scene_models.ON_PLANE, *larger_mechanisms.ADDS))),
        "drag": choice("fluid", kinds=frozenset({"drag"})),
        **contact.OPTIONS,
        **mechanism_xml.OPTIONS,
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
        {"gravity", "translation", "rotation", "contact", "friction", "drag", *mechanisms.MODELS, *touching.MODELS}
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
)


calls = CALLS

interface_loads, read_robot, compiled = touching.interface_loads, robots.read_robot, robots.compiled
step_robot = robot_steps.step_robot


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
    methods = {
        name: replace(method, options=tuple(sorted((*method.options, ("model", name)))))
        for name in scene_models.available_models(scene)
    }
    return {name: Model(methods[name].name, adds) for name, adds in scene_models.available_models(scene).items()}


def model_of(scene: Scene, method: Method) -> str:
    """Return the model named by `:model=`, or the smallest model on which the integrator is the same scheme.

    A rotating body has a free joint even if it does not move away. On a ball joint, which would suffice, `implicitfast` and
    `discrete` would become another scheme: semi-implicit Euler, like `Euler`.
    """
    if (model := method.option("model")) is not None:
        return model
    if scene.plane is not None:
        return "contact"
    return "translation" if requirements(scene).rotation == "none" else "six-coordinates"


def touches_plane(scene: Scene, method: Method) -> bool:
    """Return whether the body touches a plane by MuJoCo's own contact."""
    return scene.plane is not None and model_of(scene, method) in scene_models.MODELS_WITH_CONTACT


def contact_law(scene: Scene, method: Method) -> Plane | None:
    """Return the friction law of a method's contacts; None if the reference has no such law.

    MuJoCo finds four contacts between a box and a plane. The reference has no law for MuJoCo's contacts of a cylinder, for
    pads, or for contacts with torsion or rolling (condim 4 and 6). Contacts of one dimension have no friction.
    """
    if scene.plane is None or not touches_plane(scene, method):
        return scene.plane
    condim = method.option("condim")
    if not isinstance(scene.body.shape, Brick) or method.option("pads") or condim in ("4", "6"):
        return None
    coefficient = 0.0 if condim == "1" else scene.plane.friction
    return replace(scene.plane, friction=coefficient, law="corners", pressure="balanced")


def prepare(scenes: Sequence[AnyScene], method: Method) -> Simulation:
    """Return the simulation of one or more scenes, as `Adapter.prepare` does."""
    if touches(scenes[0]):
        return touching.prepare(scenes[0], method)
    if isinstance(scenes[0], Mechanism):
        return mechanisms.prepare(scenes[0], method)
    return unjointed(single_bodies(scenes), method)


def unjointed(scenes: Sequence[Scene], method: Method) -> Stepper | Worlds:
    """Return the simulation of one or more single bodies in flight, or lying flat on a plane. Raises `SceneUnsupported`."""
    if len(scenes) == 1:
        return stepper(scenes[0], method)
    model = model_of(scenes[0], method)
    if differ_in_numbers_alone(scenes, method, model):
        for index in bodies.may_be_refused(scenes):
            compiled_model(description(scenes[index], method, model)[0])
        xml, _ = description(scenes[0], method, model)
        models = bodies.with_bodies(compiled_model(xml), scenes)
        joints = [scene_models.joints(scene, model) for scene in scenes]
    else:
        described = [description(scene, method, model) for scene in scenes]
        models = bodies.compiled([compiled_model(xml) for xml, _ in described])
        joints = [joints_of_scene for _, joints_of_scene in described]
    data = mujoco.MjData(models.at([0])[0])
    return Worlds(models, data, joints, [external_force(scene, method, model, data) for scene in scenes])


def differ_in_numbers_alone(scenes: Sequence[Scene], method: Method, model: str) -> bool:
    """Return whether the models of scenes differ at most in mass, moments and gravity."""
    plain = scenes[0].plane is None and model in scene_models.WITHOUT_STATE and method.option("drag") != "fluid"
    return plain and len({scene.body.axes for scene in scenes}) == 1


def stepper(scene: Scene, method: Method) -> Stepper:
    """Return the simulation of one scene. Raises `SceneUnsupported`."""
    model = model_of(scene, method)
    simulation = started(*description(scene, method, model))
    simulation.force = external_force(scene, method, model, simulation.data)
    return simulation


def prepare_links(given: Sequence[Link], scene: Scene, method: Method) -> Stepper:
    """Return the simulation of a free body that is made of links, as `Links.prepare_links` does."""
    return started(*description_of_links(given, scene, method))


def started(xml: str, joints: scene_models.Joints) -> Stepper:
    """Return the simulation of a model in its initial state, without an external force. Raises `SceneUnsupported`."""
    compiled = compiled_model(xml)
    data = mujoco.MjData(compiled)
    data.qpos[:], data.qvel[:] = joints.qpos, joints.qvel
    return Stepper(compiled, data, joints.rows)


def external_force(scene: Scene, method: Method, model: str, data: mujoco.MjData) -> scene_models.Force | None:
    """Return the external force that a model of a scene needs; None if it needs none. `data` is the data that is stepped."""
    if scene.plane is not None and model not in scene_models.MODELS_WITH_CONTACT:
        return scene_models.friction_force(scene, scene.plane, method.timestep, data)
    if scene.drag and method.option("drag") != "fluid" and model != "rotation":
        return scene_models.drag_force(scene.drag, data)
    return None


def script(scene: AnyScene, method: Method, duration: float, samples: int) -> str:
    """Return a script for MuJoCo alone, as `Scripts.script` does."""
    if touches(scene):
        return exporting.touching_script(scene, method, duration, samples)
    if isinstance(scene, Mechanism):
        return mechanisms.script(scene, method, duration, samples)
    model = model_of(scene, method)
    xml, joints = description(scene, method, model)
    compiled_model(xml)  # raises an error if MuJoCo refuses the model
    return exporting.script(scene, method, xml, joints, model, duration, samples)


def description(scene: Scene, method: Method, model: str) -> tuple[str, scene_models.Joints]:
    """Return the XML of a model of a scene, and the joints in it. Raises `SceneUnsupported`."""
    check_supported(scene, method, model)
    braked = scene.plane is not None and model not in scene_models.MODELS_WITH_CONTACT
    parts = None
    if scene.plane is not None and not braked:
        shortest = contact.shortest_time_constant(method.integrator, method.timestep)
        parts = contact.parts(scene, scene.plane, dict(method.options), shortest)
    joints = scene_models.joints(scene, model)
    xml = XML.format(
        timestep=method.timestep,
        integrator=method.integrator,
        # With friction as an external force, the model contains neither the weight nor the force that bears it.
        gravity=0.0 if braked else -scene.gravity,
        density=fluid_density(scene) if method.option("drag") == "fluid" else 0.0,
        origin=contact.numbers_written(*joints.origin),
        joints=joints.xml,
        inertial=INERTIAL.format(
            mass=scene.body.mass,
            axes=scene_models.principal_axes(scene, joints),
            moments=contact.numbers_written(*scene.body.moments),
        ),
        parts=scene_models.parts(scene, model, parts),
    )
    return xml, joints


def description_of_links(given: Sequence[Link], scene: Scene, method: Method) -> tuple[str, scene_models.Joints]:
    """Return the XML of a body of links on a free joint, and that joint. Raises `SceneUnsupported` for another model."""
    if (model := method.option("model") or "six-coordinates") != "six-coordinates":
        raise SceneUnsupported(f"links with the model {model!r}, whose joints are those of a body about its centre of mass")
    joints = scene_models.free_joint(scene)
    xml = XML.format(
        timestep=method.timestep,
        integrator=method.integrator,
        gravity=-scene.gravity,
        density=0.0,
        origin=contact.numbers_written(*joints.origin),
        joints=joints.xml,
        inertial=scene_models.inertial(given[0]),
        parts=contact.Parts(geoms=scene_models.welded(given[1:])),
    )
    return xml, joints


def check_supported(scene: Scene, method: Method, model: str) -> None:
    """Raise `SceneUnsupported` if the contact, the model or the contact options do not fit the scene."""
    if scene.plane is not None and (reason := not_flat(scene)) is not None:
        raise SceneUnsupported(f"{engine.name} {engine.version} does not model {reason}")
    if method.option("model") and model not in (models_of_scene := scene_models.available_models(scene)):
        raise SceneUnsupported(f"no model {model!r} of this scene; there are: {', '.join(models_of_scene)}")
    contact_options = [f"{key}={value}" for key, value in method.options if key in contact.OPTIONS]
    if contact_options and not touches_plane(scene, method):
        raise SceneUnsupported(f"contact options {', '.join(contact_options)} for the model {model!r}, which has no contact")


def fluid_density(scene: Scene) -> float:
    """Return the density (kg/m^3) at which MuJoCo's fluid model has the scene's drag along the axis of the smallest moment.

    MuJoCo's inertia box has half-lengths r_i^2 = 3 (I_j + I_k - I_i) / 2m and the drag 2 rho r_j r_k |v| v along axis i.
    """
    _, *across = sorted(scene.body.moments)
    total = sum(scene.body.moments)
    r = [math.sqrt(3 * (total - 2 * moment) / (2 * scene.body.mass)) for moment in across]
    return scene.drag / (2 * r[0] * r[1])


def contact_load(scene: Scene, method: Method, steps: int) -> Array | None:
    """Return the normal force (n,), in N, in each of n steps; None for a model that does not touch the plane."""
    return contact_loads(scene, method, steps)[0] if touches_plane(scene, method) else None


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
    if not touches_plane(scene, method):
        raise SceneUnsupported("contact loads of a model without contact")
    simulation = stepper(scene, method)
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
