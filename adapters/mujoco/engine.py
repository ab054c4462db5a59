"""MuJoCo: a body with an inertia, the joints that the scene needs, and what it needs besides, stepped in C (`mujoco_stepping`).

Of a free joint qpos is (position world, quaternion w x y z), and qvel is linear in the world frame, angular in the body frame.
What other joints there are, and what models that are larger than need be, is in `mujoco_models`.

Drag is a force from outside, evaluated wherever MuJoCo evaluates its own passive forces, so that every integrator keeps its
order. The integrators whose names end in `-fluid` have MuJoCo's own fluid model instead: an inertia box in a medium, which
meets a drag along each axis of the body and one against its rotation. The medium is as dense as it must be for the drag along
the axis of the least moment, that in which a long body flies, to be the scene's.

A body on a plane touches it by MuJoCo's own soft contact; what can be chosen of it is in `mujoco_contact`. `Euler-planar` has
the smallest model instead, of three coordinates, and friction as a force from outside, by the reference's law.
"""

import math
from dataclasses import replace

import mujoco
import numpy as np

from bodycheck.adapters.contract import MODEL_OPTION, Claim, Method, SceneUnsupported, Strides
from bodycheck.adapters.mujoco import contact as mujoco_contact
from bodycheck.adapters.mujoco import models as mujoco_models
from bodycheck.adapters.mujoco.stepping import Rollouts, Steps, quiet, refuse_warnings, stepping
from bodycheck.reference.requirements import missing, requirements
from bodycheck.reference.scene import Brick, Plane, Scene
from bodycheck.reference.trajectory import Array

MODEL = """
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
      <inertial pos="0 0 0" mass="{mass!r}" quat="{axes}" diaginertia="{moments}"/>
      {parts.geoms}
    </body>
  </worldbody>
  {parts.sensors}
</mujoco>
"""

FLUID = "-fluid"

PLANAR = "Euler-planar"

#: What MuJoCo can model of what a scene may require.
MODELLED = frozenset({"gravity", "translation", "rotation", "contact", "friction", "drag"})


def version() -> str:
    return str(mujoco.__version__)


def plain_integrators() -> tuple[str, ...]:
    # The names of the XML, which are those of the enumeration in another spelling.
    spelling = {"EULER": "Euler", "RK4": "RK4"}
    members = (name.removeprefix("mjINT_") for name in mujoco.mjtIntegrator.__members__)
    return tuple(spelling.get(name, name.lower()) for name in members)


def integrators(scene: Scene | None = None) -> tuple[str, ...]:
    plain = plain_integrators()
    if scene is not None and scene.plane is not None:
        return (*plain, *mujoco_contact.DEFAULTS, PLANAR)
    fluid = tuple(name + FLUID for name in plain)
    if scene is None:
        return (*plain, *fluid, PLANAR)
    return (*plain, *fluid) if scene.drag else plain


def claim(integrator: str) -> Claim:
    """By MuJoCo's documentation all but RK4 are of first order."""
    stages = 4 if integrator.partition(":")[0].removesuffix(FLUID) == "RK4" else 1
    return Claim(order=stages, evaluations=stages)


def unsupported(scene: Scene) -> str | None:
    if (lacking := missing(scene, MODELLED)) is not None or scene.plane is None:
        return lacking
    return mujoco_contact.unsupported(scene)


def models(scene: Scene, integrator: str) -> dict[str, str]:
    known = plain_integrators() if scene.plane is not None else integrators(scene)
    return mujoco_models.growing(scene) if integrator in known else {}


def model_of(scene: Scene, integrator: str) -> str:
    """The model that a method's name asks for, or that it has where it asks for none: the smallest that leaves it the same.

    A body that turns has a free joint even where it stays in its place. On a ball joint, which would do, `implicitfast` and
    `discrete` are other schemes: semi-implicit Euler, as `Euler` is.
    """
    name, asked, model = integrator.partition(MODEL_OPTION)
    if asked:
        return model
    if scene.plane is not None:
        return "planar" if name == PLANAR else "contact"
    return "translation" if requirements(scene).rotation == "none" else "six-coordinates"


def contact_law(scene: Scene, integrator: str) -> Plane | None:
    if scene.plane is not None and model_of(scene, integrator) not in mujoco_models.TOUCHING:
        return scene.plane
    # MuJoCo finds four contacts of a box with a plane; what it finds of a cylinder, and pads, are no law of the reference.
    if scene.plane is None or not isinstance(scene.body.shape, Brick) or "pads=" in integrator:
        return None
    return replace(scene.plane, law="corners", pressure="balanced")


def prepare(scene: Scene, method: Method) -> Rollouts | Steps:
    """As the contract has it; on a plane with any options of `mujoco_contact`, whether `integrators` lists them or not."""
    if (lacking := unsupported(scene)) is not None:
        raise SceneUnsupported(lacking)
    integrator, model, options = read(scene, method.integrator)
    touches = scene.plane is not None and model in mujoco_models.TOUCHING
    braked = scene.plane is not None and not touches
    contact = None
    if scene.plane is not None and touches:
        # For stability, MuJoCo keeps the contact slower than the step; `discrete` is stable without.
        shortest = 0.0 if integrator == "discrete" else 2 * method.timestep
        contact = mujoco_contact.parts(scene, scene.plane, options, shortest)
    fluid = integrator.endswith(FLUID)
    joints = mujoco_models.joints(scene, model)
    xml = MODEL.format(
        timestep=method.timestep,
        integrator=integrator.removesuffix(FLUID),
        # Where friction is a force, so would be what bears the weight: neither is in the model.
        gravity=0.0 if braked else -scene.gravity,
        density=fluid_density(scene) if fluid else 0.0,
        origin=mujoco_contact.numbers_written(*joints.origin),
        joints=joints.xml,
        mass=scene.body.mass,
        axes=mujoco_models.principal_axes(scene, joints),
        moments=mujoco_contact.numbers_written(*scene.body.moments),
        parts=mujoco_models.parts(scene, model, contact),
    )
    try:
        compiled = mujoco.MjModel.from_xml_string(xml)
    except ValueError as error:
        raise SceneUnsupported(f"MuJoCo refuses the model: {' '.join(str(error).split())}") from error
    data = mujoco.MjData(compiled)
    data.qpos[:], data.qvel[:] = joints.qpos, joints.qvel
    force = None
    if scene.plane is not None and braked:
        force = mujoco_models.braking(scene, scene.plane, method.timestep, data)
    elif scene.drag and not fluid and model != "rotation":
        force = mujoco_models.resistance(scene.drag, data)
    return stepping(compiled, data, joints, force)


def read(scene: Scene, method: str) -> tuple[str, str, str | None]:
    """What a method's name asks for: integrator, with `-fluid` or without, model, and options of contact where it has any.

    Raises `SceneUnsupported` for what there is not.
    """
    name, asked, _ = method.partition(MODEL_OPTION)
    integrator, colon, options = name.partition(":")
    known = plain_integrators()
    known += (PLANAR,) if scene.plane is not None else tuple(plain + FLUID for plain in known)
    if integrator not in known:
        raise SceneUnsupported(
            f"MuJoCo {version()} has no integrator {integrator!r} for this scene; there are: {', '.join(known)}"
        )
    model = model_of(scene, method)
    if asked and model not in (there := models(scene, name)):
        raise SceneUnsupported(f"no model {model!r} of this scene for {name!r}; there are: {', '.join(there) or 'none'}")
    if colon and (scene.plane is None or integrator == PLANAR):
        without = "scene without a plane" if scene.plane is None else "model without contact"
        raise SceneUnsupported(f"contact options {options!r} for a {without}")
    return "Euler" if integrator == PLANAR else integrator, model, options if colon else None


def fluid_density(scene: Scene) -> float:
    """Density (kg/m^3) at which MuJoCo's inertia box meets the scene's drag along the axis of the least moment.

    The box of half-lengths r_i^2 = 3 (I_j + I_k - I_i) / 2m meets 2 rho r_j r_k |v| v along axis i.
    """
    _, *across = sorted(scene.body.moments)
    total = sum(scene.body.moments)
    r = [math.sqrt(3 * (total - 2 * moment) / (2 * scene.body.mass)) for moment in across]
    return scene.drag / (2 * r[0] * r[1])


def contact_load(scene: Scene, method: Method, steps: int) -> Array | None:
    touches = model_of(scene, method.integrator) in mujoco_models.TOUCHING
    return contact_loads(scene, method, steps)[0] if touches else None


def contact_loads(scene: Scene, method: Method, steps: int) -> tuple[Array, Strides]:
    """The normal force between body and plane (n,) (N), and how many contacts bear it (n,), in each of n steps.

    That is what MuJoCo has at the beginning of a step; RK4 leaves what its last stage had. Raises `SceneUnsupported`, also
    where there is no plane or the model does not touch it, and `EngineDiverged`.
    """
    if scene.plane is None or model_of(scene, method.integrator) not in mujoco_models.TOUCHING:
        raise SceneUnsupported("contact loads of a model without contact")
    simulation = prepare(scene, method)
    model, data = simulation.model, simulation.data
    load, touching, force = np.zeros(steps), np.zeros(steps, dtype=np.int64), np.empty(6)
    with quiet():
        for step in range(steps):
            time = data.time
            mujoco.mj_step(model, data)
            refuse_warnings(data, time)
            for contact in range(data.ncon):
                mujoco.mj_contactForce(model, data, contact, force)
                load[step] += force[0]
                touching[step] += force[0] > 0
    return load, touching
