"""Write single bodies in flight, or lying flat on a plane, as MuJoCo's XML, and step them.

For a free joint, qpos is (position in the world frame, quaternion w x y z), and qvel is (linear velocity in the world frame,
angular velocity in the body frame). The module `models` contains the other joints and the larger models, and `stepping` the
loop of steps.

Drag is an external force that is evaluated together with MuJoCo's own passive forces, so that every integrator keeps its
order. The option `drag=fluid` selects MuJoCo's own fluid model instead: an inertia box in a medium, with a drag along each
axis of the body and a drag against its rotation. The density of the medium is chosen such that the drag along the axis of
the smallest moment, along which a long body flies, equals that of the scene.

A body that lies flat on a level plane touches it by MuJoCo's own soft contact, whose options the module `contact` defines. The
option `model=planar` selects the smallest model instead: three coordinates, with the reference's friction as an external force.
"""

import math
from collections.abc import Sequence

import mujoco

from bodycheck.adapters.contract import Method, SceneUnsupported
from bodycheck.adapters.links import Link
from bodycheck.adapters.mujoco import contact
from bodycheck.adapters.mujoco import models as scene_models
from bodycheck.adapters.mujoco.models import compiled_model
from bodycheck.adapters.mujoco.stepping import Stepper
from bodycheck.adapters.touching import not_flat
from bodycheck.reference.requirements import requirements
from bodycheck.reference.scene import Scene

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


def stepper(scene: Scene, method: Method) -> Stepper:
    """Return the simulation of one scene. Raises `SceneUnsupported`."""
    model = model_of(scene, method)
    simulation = started(*description(scene, method, model))
    simulation.force = external_force(scene, method, model, simulation.data)
    return simulation


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
        raise SceneUnsupported(f"mujoco {mujoco.__version__} does not model {reason}")
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
