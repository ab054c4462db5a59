"""The adapter of MuJoCo: a body with an inertia, the joints that the scene needs, and what it needs besides, stepped in C.

Of a free joint qpos is (position world, quaternion w x y z), and qvel is linear in the world frame, angular in the body frame.
The module `models` has other joints and models that are larger than need be, and `stepping` the steps.

Drag is a force from outside, evaluated wherever MuJoCo evaluates its own passive forces, so that every integrator keeps its
order. The option `drag=fluid` takes MuJoCo's own fluid model instead: an inertia box in a medium, which meets a drag along
each axis of the body and one against its rotation. The medium is as dense as it must be for the drag along the axis of the
least moment, that in which a long body flies, to be the scene's.

A body on a plane touches it by MuJoCo's own soft contact; the module `contact` has its options. The option `model=planar`
takes the smallest model instead, of three coordinates, and friction as a force from outside, by the reference's law.
"""

import math
from collections.abc import Sequence
from dataclasses import replace

import mujoco
import numpy as np

from bodycheck.adapters.contract import Engine, Integrator, Method, Model, SceneUnsupported, Strides, choice
from bodycheck.adapters.mujoco import DISTRIBUTION, contact
from bodycheck.adapters.mujoco import models as growth
from bodycheck.adapters.mujoco.stepping import Rollouts, Steps, quiet, refuse_warnings, stepping
from bodycheck.reference.requirements import requirements
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
      <inertial pos="0 0 0" mass="{mass!r}" quat="{axes}" diaginertia="{moments}"/>
      {parts.geoms}
    </body>
  </worldbody>
  {parts.sensors}
</mujoco>
"""

#: The integrators of the newest release, as its XML names them.
KNOWN = ("Euler", "RK4", "implicit", "implicitfast", "discrete")


def available() -> tuple[str, ...]:
    """The integrators of the installed release, in its order: the names of its enumeration as its XML spells them."""
    spelling = {"EULER": "Euler", "RK4": "RK4"}
    members = (name.removeprefix("mjINT_") for name in mujoco.mjtIntegrator.__members__)
    return tuple(spelling.get(name, name.lower()) for name in members)


def integrators() -> tuple[Integrator, ...]:
    """All integrators that there are; those that the installed release lacks are offered for no scene."""
    options = {
        "model": choice(*dict.fromkeys((*growth.IN_FLIGHT, *growth.ON_PLANE))),
        "drag": choice("fluid", kinds=frozenset({"drag"})),
        **contact.OPTIONS,
    }
    here = available()
    # By MuJoCo's documentation all but RK4 are of first order.
    return tuple(
        Integrator(name, order=stages, evaluations=stages, options=options, **({} if name in here else {"kinds": frozenset()}))
        for name in dict.fromkeys((*here, *KNOWN))
        for stages in (4 if name == "RK4" else 1,)
    )


engine = Engine(
    name="mujoco",
    distribution=DISTRIBUTION,
    version=str(mujoco.__version__),
    integrators=integrators(),
    models=frozenset({"gravity", "translation", "rotation", "contact", "friction", "drag"}),
    variants={
        "drag": tuple(f"{name}:drag=fluid" for name in available()),
        "plane": ("Euler:cone=elliptic", "Euler:cone=elliptic,pads=4", "Euler:model=planar"),
    },
)


def models(scene: Scene, integrator: str) -> dict[str, Model]:
    """The models of a scene; on a plane those of an integrator without options."""
    method = Method.parse(integrator, 0.0)
    if method.option("model") or (scene.plane is not None and method.options):
        return {}
    own = {name: replace(method, options=tuple(sorted((*method.options, ("model", name))))) for name in growth.growing(scene)}
    return {name: Model(own[name].name, adds) for name, adds in growth.growing(scene).items()}


def model_of(scene: Scene, method: Method) -> str:
    """The model that a method asks for, or the smallest on which its integrator remains the same scheme.

    A body that turns has a free joint even where it stays in its place. On a ball joint, which would do, `implicitfast` and
    `discrete` are other schemes: semi-implicit Euler, as `Euler` is.
    """
    if (asked := method.option("model")) is not None:
        return asked
    if scene.plane is not None:
        return "contact"
    return "translation" if requirements(scene).rotation == "none" else "six-coordinates"


def touches(scene: Scene, method: Method) -> bool:
    """Whether the body touches a plane by MuJoCo's own contact."""
    return scene.plane is not None and model_of(scene, method) in growth.TOUCHING


def contact_law(scene: Scene, method: Method) -> Plane | None:
    """The law of friction of a method's contacts; None where it is none of the reference's.

    MuJoCo finds four contacts of a box with a plane. What it finds of a cylinder, pads, and contacts with torsion or rolling
    (condim 4 and 6) are no law of the reference. Contacts of one dimension have no friction.
    """
    if scene.plane is None or not touches(scene, method):
        return scene.plane
    condim = method.option("condim")
    if not isinstance(scene.body.shape, Brick) or method.option("pads") or condim in ("4", "6"):
        return None
    coefficient = 0.0 if condim == "1" else scene.plane.friction
    return replace(scene.plane, friction=coefficient, law="corners", pressure="balanced")


def prepare(scenes: Sequence[Scene], method: Method) -> Rollouts | Steps:
    """The simulation of one scene."""
    (scene,) = scenes
    model = model_of(scene, method)
    refuse(scene, method, model)
    braked = scene.plane is not None and model not in growth.TOUCHING
    parts = None
    if scene.plane is not None and not braked:
        # For stability, MuJoCo keeps the contact slower than the step; `discrete` is stable without.
        shortest = 0.0 if method.integrator == "discrete" else 2 * method.timestep
        parts = contact.parts(scene, scene.plane, dict(method.options), shortest)
    fluid = method.option("drag") == "fluid"
    joints = growth.joints(scene, model)
    xml = XML.format(
        timestep=method.timestep,
        integrator=method.integrator,
        # Where friction is a force, so would be what bears the weight: neither is in the model.
        gravity=0.0 if braked else -scene.gravity,
        density=fluid_density(scene) if fluid else 0.0,
        origin=contact.numbers_written(*joints.origin),
        joints=joints.xml,
        mass=scene.body.mass,
        axes=growth.principal_axes(scene, joints),
        moments=contact.numbers_written(*scene.body.moments),
        parts=growth.parts(scene, model, parts),
    )
    try:
        compiled = mujoco.MjModel.from_xml_string(xml)
    except ValueError as error:
        raise SceneUnsupported(f"MuJoCo refuses the model: {' '.join(str(error).split())}") from error
    data = mujoco.MjData(compiled)
    data.qpos[:], data.qvel[:] = joints.qpos, joints.qvel
    force = None
    if scene.plane is not None and braked:
        force = growth.braking(scene, scene.plane, method.timestep, data)
    elif scene.drag and not fluid and model != "rotation":
        force = growth.resistance(scene.drag, data)
    return stepping(compiled, data, joints, force)


def refuse(scene: Scene, method: Method, model: str) -> None:
    """Raises `SceneUnsupported` for a contact, a model or options that a scene cannot have."""
    if scene.plane is not None and (reason := contact.unsupported(scene)) is not None:
        raise SceneUnsupported(f"{engine.name} {engine.version} does not model {reason}")
    if method.option("model") and model not in (there := growth.growing(scene)):
        raise SceneUnsupported(f"no model {model!r} of this scene; there are: {', '.join(there)}")
    own = [f"{key}={value}" for key, value in method.options if key in contact.OPTIONS]
    if own and not touches(scene, method):
        raise SceneUnsupported(f"contact options {', '.join(own)} for the model {model!r}, which has no contact")


def fluid_density(scene: Scene) -> float:
    """Density (kg/m^3) at which MuJoCo's inertia box meets the scene's drag along the axis of the least moment.

    The box of half-lengths r_i^2 = 3 (I_j + I_k - I_i) / 2m meets 2 rho r_j r_k |v| v along axis i.
    """
    _, *across = sorted(scene.body.moments)
    total = sum(scene.body.moments)
    r = [math.sqrt(3 * (total - 2 * moment) / (2 * scene.body.mass)) for moment in across]
    return scene.drag / (2 * r[0] * r[1])


def contact_load(scene: Scene, method: Method, steps: int) -> Array | None:
    """The normal force (n,), N, in each of n steps; None for a model that does not touch the plane."""
    return contact_loads(scene, method, steps)[0] if touches(scene, method) else None


def contact_loads(scene: Scene, method: Method, steps: int) -> tuple[Array, Strides]:
    """The normal force between body and plane (n,) (N), and how many contacts bear it (n,), in each of n steps.

    That is what MuJoCo has at the beginning of a step; RK4 leaves what its last stage had. Raises `SceneUnsupported`, also
    where there is no plane or the model does not touch it, and `EngineDiverged`.
    """
    if not touches(scene, method):
        raise SceneUnsupported("contact loads of a model without contact")
    simulation = prepare([scene], method)
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
