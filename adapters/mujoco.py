"""MuJoCo: a free joint with an inertia, and what the scene needs besides, stepped in C.

qpos is (position world, quaternion w x y z); qvel is linear in the world frame, angular in the body frame.

Drag is a force from outside, evaluated wherever MuJoCo evaluates its own passive forces, so that every integrator keeps its
order. The integrators whose names end in `-fluid` have MuJoCo's own fluid model instead: an inertia box in a medium, which
meets a drag along each axis of the body and one against its rotation. The medium is as dense as it must be for the drag along
the axis of the least moment, that in which a long body flies, to be the scene's.

A body on a plane touches it by MuJoCo's own soft contact; what can be chosen of it is in `mujoco_contact`.
"""

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

import mujoco
import numpy as np
from mujoco import rollout

from bodycheck.adapters import mujoco_contact
from bodycheck.adapters.contract import EngineDiverged, Method, SceneUnsupported, Strides
from bodycheck.reference.scene import Brick, Plane, Scene
from bodycheck.reference.trajectory import Array

MODEL = """
<mujoco>
  <compiler balanceinertia="false" inertiafromgeom="false"/>
  <option timestep="{timestep!r}" integrator="{integrator}" gravity="0 0 {gravity!r}" density="{density!r}" {contact.option}>
    <flag contact="{contact.switch}" constraint="{contact.switch}"/>
  </option>
  {contact.default}
  <worldbody>
    {contact.plane}
    <body>
      <freejoint/>
      <inertial pos="0 0 0" mass="{mass!r}" quat="{axes}" diaginertia="{moments}"/>
      {contact.geoms}
    </body>
  </worldbody>
</mujoco>
"""

CHUNK = 8192
"""Steps of one rollout. It returns every state, so this bounds the memory; a call costs as much as some 30 steps."""

FLUID = "-fluid"

RESETS = {mujoco.mjtWarning.mjWARN_BADQPOS, mujoco.mjtWarning.mjWARN_BADQVEL, mujoco.mjtWarning.mjWARN_BADQACC}


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
        return (*plain, *mujoco_contact.DEFAULTS)
    return plain if scene is not None and not scene.drag else (*plain, *(name + FLUID for name in plain))


def unsupported(scene: Scene) -> str | None:
    return mujoco_contact.unsupported(scene) if scene.plane is not None else None


def contact_law(scene: Scene, integrator: str) -> Plane | None:
    # MuJoCo finds four contacts of a box with a plane; what it finds of a cylinder, and pads, are no law of the reference.
    if scene.plane is None or not isinstance(scene.body.shape, Brick) or "pads=" in integrator:
        return None
    return replace(scene.plane, law="corners", pressure="balanced")


def prepare(scene: Scene, method: Method) -> "Rollout":
    """As the contract has it; on a plane with any options of `mujoco_contact`, whether `integrators` lists them or not."""
    if (missing := unsupported(scene)) is not None:
        raise SceneUnsupported(missing)
    integrator, colon, options = method.integrator.partition(":")
    known = integrators() if scene.plane is None else plain_integrators()
    if integrator not in known:
        raise SceneUnsupported(
            f"MuJoCo {version()} has no integrator {integrator!r} for this scene; there are: {', '.join(known)}"
        )
    if scene.plane is not None:
        # For stability, MuJoCo keeps the contact slower than the step; `discrete` is stable without.
        shortest = 0.0 if integrator == "discrete" else 2 * method.timestep
        contact = mujoco_contact.parts(scene, scene.plane, options if colon else None, shortest)
    elif colon:
        raise SceneUnsupported(f"contact options {options!r} for a scene without a plane")
    else:
        contact = mujoco_contact.Parts()
    fluid = integrator.endswith(FLUID)
    xml = MODEL.format(
        timestep=method.timestep,
        integrator=integrator.removesuffix(FLUID),
        gravity=-scene.gravity,
        density=fluid_density(scene) if fluid else 0.0,
        mass=scene.body.mass,
        axes=" ".join(map(repr, scene.body.axes)),
        moments=" ".join(map(repr, scene.body.moments)),
        contact=contact,
    )
    try:
        model = mujoco.MjModel.from_xml_string(xml)
    except ValueError as error:
        raise SceneUnsupported(f"MuJoCo refuses the model: {' '.join(str(error).split())}") from error
    data = mujoco.MjData(model)
    initial = scene.initial
    data.qpos[:] = (*initial.position, *initial.quaternion)
    data.qvel[:] = (*initial.velocity, *initial.angular_velocity)
    return Rollout(model, data, 0.0 if fluid else scene.drag)


def fluid_density(scene: Scene) -> float:
    """Density (kg/m^3) at which MuJoCo's inertia box meets the scene's drag along the axis of the least moment.

    The box of half-lengths r_i^2 = 3 (I_j + I_k - I_i) / 2m meets 2 rho r_j r_k |v| v along axis i.
    """
    _, *across = sorted(scene.body.moments)
    total = sum(scene.body.moments)
    r = [math.sqrt(3 * (total - 2 * moment) / (2 * scene.body.mass)) for moment in across]
    return scene.drag / (2 * r[0] * r[1])


def contact_load(scene: Scene, method: Method, steps: int) -> Array:
    return contact_loads(scene, method, steps)[0]


def contact_loads(scene: Scene, method: Method, steps: int) -> tuple[Array, Strides]:
    """The normal force between body and plane (n,) (N), and how many contacts bear it (n,), in each of n steps.

    That is what MuJoCo has at the beginning of a step; RK4 leaves what its last stage had. Raises `SceneUnsupported`, also
    where there is no plane, and `EngineDiverged`.
    """
    if scene.plane is None:
        raise SceneUnsupported("contact without a plane")
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


@contextmanager
def quiet() -> Iterator[None]:
    """Keeps MuJoCo from writing its warnings to a log file in the working directory."""
    mujoco.set_mju_user_warning(lambda text: None)
    try:
        yield
    finally:
        mujoco.set_mju_user_warning(None)


def refuse_warnings(data: mujoco.MjData, time: float) -> None:
    """Raise `EngineDiverged` where MuJoCo has warned of anything up to a time (s): only its warnings tell."""
    kinds = {name: kind for name, kind in mujoco.mjtWarning.__members__.items() if name.startswith("mjWARN_")}
    given = {name.removeprefix("mjWARN_"): kind for name, kind in kinds.items() if data.warning[kind].number}
    if given:
        # It answers a bad state by starting over from the initial one, and drops what its buffers cannot hold.
        answer = "reset itself after" if RESETS & set(given.values()) else "warned of"
        raise EngineDiverged(f"MuJoCo {answer} {', '.join(given)} at t = {time:.6g} s")


class Rollout:
    """A MuJoCo model and its data, advanced by `mujoco.rollout`."""

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, drag: float) -> None:
        self.model, self.data, self.drag = model, data, drag
        self.pool = rollout.Rollout(nthread=0)
        # Row 0 is the state at which the simulation stands, the rows below are those of one rollout.
        self.states = np.empty((CHUNK + 1, mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS)))
        mujoco.mj_getState(model, data, self.states[0], mujoco.mjtState.mjSTATE_FULLPHYSICS)

    def advance(self, strides: Strides) -> Array:
        ends = np.cumsum(strides)
        rows = np.empty((len(strides), 13))
        done = 0
        while True:
            count = min(CHUNK, int(ends[-1]) - done)
            if count:
                self._step(count)
            first, last = np.searchsorted(ends, (done, done + count + 1))
            rows[first:last] = self.states[ends[first:last] - done, 1:14]
            self.states[0] = self.states[count]
            done += count
            if done == ends[-1]:
                return rows

    def _step(self, count: int) -> None:
        start, following = self.states[0], self.states[1 : count + 1]
        mujoco.set_mjcb_passive(self._resist if self.drag else None)
        try:
            with quiet():
                self.pool.rollout(
                    self.model,
                    self.data,
                    start[None],
                    nstep=count,
                    initial_warmstart=self.data.qacc_warmstart[None],
                    state=following[None],
                )
        finally:
            mujoco.set_mjcb_passive(None)
        # A rollout stands still after a warning, and a reset turns its clock back.
        refuse_warnings(self.data, float(np.max(following[:, 0], initial=start[0])))

    def _resist(self, _model: mujoco.MjModel, data: mujoco.MjData) -> None:
        x, y, z = data.qvel[:3].tolist()
        slowing = -self.drag * math.sqrt(x * x + y * y + z * z)
        data.qfrc_passive[:3] = slowing * x, slowing * y, slowing * z
