"""Simulate one body in flight, or lying flat on a level plane, in Pinocchio."""

import numpy as np
import pinocchio as pin

from bodycheck.adapters.contract import Method, SceneUnsupported
from bodycheck.adapters.pinocchio import contact, flights
from bodycheck.adapters.pinocchio import models as scene_models
from bodycheck.adapters.pinocchio.joints import Joints, Step
from bodycheck.adapters.pinocchio.schemes import SCHEMES, Acceleration, Scheme
from bodycheck.adapters.stepping import Loop
from bodycheck.adapters.touching import not_flat
from bodycheck.reference.errors import NotFlat
from bodycheck.reference.scene import Plane, Scene
from bodycheck.reference.sliding.friction import friction
from bodycheck.reference.sliding.motion import smallest_friction
from bodycheck.reference.trajectory import Array

#: The model of each integrator on a plane if the method does not select one.
SMALLEST_ON_PLANE = {"admm": "contact", "law-force": "planar"}


def check_supported(scene: Scene, method: Method) -> None:
    """Raise `SceneUnsupported` if the contact or the selected model does not fit the scene."""
    if scene.plane is not None and (reason := unsupported_contact(scene, scene.plane)) is not None:
        raise SceneUnsupported(f"pinocchio {pin.__version__} does not model {reason}")
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


def model_of(scene: Scene, method: Method) -> str:
    """Return the model named by `:model=`, or the smallest model on which the integrator is the same scheme."""
    if (model := method.option("model")) is not None:
        return model
    if scene.plane is not None:
        return SMALLEST_ON_PLANE[method.integrator]
    return next(iter(scene_models.in_flight(scene, method.integrator)))


def alone(scene: Scene, method: Method) -> Loop[tuple[Array, Array]]:
    """Return the simulation of one scene that is not stepped with others. Raises `SceneUnsupported`."""
    joints = jointed(scene, method)
    return loop(step_of(scene, method, joints, joints.model.createData()), joints)


def jointed(scene: Scene, method: Method) -> Joints:
    """Return the body of a scene on the joints of a method. Raises `SceneUnsupported`."""
    check_supported(scene, method)
    model = model_of(scene, method)
    if scene.plane is None:
        return scene_models.JOINTS[model](scene, scene.gravity)
    return scene_models.JOINTS_ON_PLANE[model](scene, scene.gravity if touching(scene, method) else 0.0)


def touching(scene: Scene, method: Method) -> bool:
    """Return whether the body touches the plane of a scene in the model of a method; if not, friction is an external force."""
    return scene.plane is not None and method.integrator == "admm"


def step_of(scene: Scene, method: Method, joints: Joints, data: pin.Data) -> Step:
    """Return the step of a body on the joints that `jointed` returns, which computes in some data of their model.

    Raises `SceneUnsupported`.
    """
    model, touches = model_of(scene, method), touching(scene, method)
    if scene.plane is None:
        scheme, _ = SCHEMES[method.integrator]
        step = flight_step(flights.acceleration_of(scene, joints.model, data, 1), scheme, joints, method.timestep)
    elif touches:
        step = contact.rigid_contact(scene, scene.plane, joints, data, method.timestep)
    else:
        step = friction_step(scene, scene.plane, joints, data, method.timestep)
    if scene.body.shape is not None and model in ("far-geometry", "everything"):
        step = scene_models.with_collision_detection(
            step, joints, scene.body.shape, 0.0 if touches else scene_models.FAR_PLANE_DEPTH_M
        )
    return scene_models.with_all_terms(step, joints) if model == "everything" else step


def loop(step: Step, joints: Joints) -> Loop[tuple[Array, Array]]:
    """Return a simulation that begins at the initial state of the joints and repeats a step."""
    nq = joints.model.nq
    return Loop(
        (joints.q, joints.v),
        lambda state: step(*state),
        lambda state: np.concatenate(state),
        lambda seen: joints.rows(seen[:, :nq], seen[:, nq:]),
    )


def flight_step(acceleration: Acceleration, scheme: Scheme, joints: Joints, timestep: float) -> Step:
    """Return the step of a body on joints with a scheme and a time step (s), from its accelerations."""
    model = joints.model
    return lambda q, v: scheme(model, acceleration, q, v, timestep)


def friction_step(scene: Scene, plane: Plane, joints: Joints, data: pin.Data, timestep: float) -> Step:
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
    data
        The data of their model in which the step computes.
    timestep
        The time step (s).
    """
    law, apart = smallest_friction(scene, plane)
    model, heading = joints.model, joints.heading
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
