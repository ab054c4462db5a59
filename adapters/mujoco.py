"""MuJoCo: a free joint with an inertia and nothing else, stepped in C.

qpos is (position world, quaternion w x y z); qvel is linear in the world frame, angular in the body frame.

Drag is a force from outside, evaluated wherever MuJoCo evaluates its own passive forces, so that every integrator keeps its
order. The integrators whose names end in `-fluid` have MuJoCo's own fluid model instead: an inertia box in a medium, which
meets a drag along each axis of the body and one against its rotation. The medium is as dense as it must be for the drag along
the axis of the least moment, that in which a long body flies, to be the scene's.
"""

import math

import mujoco
import numpy as np
from mujoco import rollout

from bodycheck.adapters.contract import EngineDiverged, Method, SceneUnsupported, Strides
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array

MODEL = """
<mujoco>
  <compiler balanceinertia="false"/>
  <option timestep="{timestep!r}" integrator="{integrator}" gravity="0 0 {gravity!r}" density="{density!r}">
    <flag contact="disable" constraint="disable"/>
  </option>
  <worldbody>
    <body>
      <freejoint/>
      <inertial pos="0 0 0" mass="{mass!r}" quat="{axes}" diaginertia="{moments}"/>
    </body>
  </worldbody>
</mujoco>
"""

CHUNK = 8192
"""Steps of one rollout. It returns every state, so this bounds the memory; a call costs as much as some 30 steps."""

FLUID = "-fluid"

RESETS = (mujoco.mjtWarning.mjWARN_BADQPOS, mujoco.mjtWarning.mjWARN_BADQVEL, mujoco.mjtWarning.mjWARN_BADQACC)


def version() -> str:
    return str(mujoco.__version__)


def integrators(scene: Scene | None = None) -> tuple[str, ...]:
    # The names of the XML, which are those of the enumeration in another spelling.
    spelling = {"EULER": "Euler", "RK4": "RK4"}
    members = (name.removeprefix("mjINT_") for name in mujoco.mjtIntegrator.__members__)
    plain = tuple(spelling.get(name, name.lower()) for name in members)
    return plain if scene is not None and not scene.drag else (*plain, *(name + FLUID for name in plain))


def unsupported(scene: Scene) -> str | None:
    return "contact with a plane" if scene.plane is not None else None


def prepare(scene: Scene, method: Method) -> "Rollout":
    if (missing := unsupported(scene)) is not None:
        raise SceneUnsupported(missing)
    fluid = method.integrator.endswith(FLUID)
    xml = MODEL.format(
        timestep=method.timestep,
        integrator=method.integrator.removesuffix(FLUID),
        gravity=-scene.gravity,
        density=fluid_density(scene) if fluid else 0.0,
        mass=scene.body.mass,
        axes=" ".join(map(repr, scene.body.axes)),
        moments=" ".join(map(repr, scene.body.moments)),
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
        mujoco.set_mju_user_warning(lambda text: None)  # else MuJoCo writes a log file into the working directory
        mujoco.set_mjcb_passive(self._resist if self.drag else None)
        try:
            self.pool.rollout(
                self.model,
                self.data,
                start[None],
                nstep=count,
                initial_warmstart=self.data.qacc_warmstart[None],
                state=following[None],
            )
        finally:
            mujoco.set_mju_user_warning(None)
            mujoco.set_mjcb_passive(None)
        # MuJoCo answers a bad state by starting over from the initial one; only its warnings tell.
        for warning in RESETS:
            if self.data.warning[warning].number:
                time = float(np.max(following[:, 0], initial=start[0]))
                name = warning.name.removeprefix("mjWARN_")
                raise EngineDiverged(f"MuJoCo reset itself after {name} at t = {time:.6g} s")

    def _resist(self, _model: mujoco.MjModel, data: mujoco.MjData) -> None:
        x, y, z = data.qvel[:3].tolist()
        slowing = -self.drag * math.sqrt(x * x + y * y + z * z)
        data.qfrc_passive[:3] = slowing * x, slowing * y, slowing * z
