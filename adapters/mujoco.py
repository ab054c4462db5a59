"""MuJoCo: a free joint with an inertia and nothing else, stepped in C.

qpos is (position world, quaternion w x y z); qvel is linear in the world frame, angular in the body frame.
"""

import mujoco
import numpy as np
from mujoco import rollout

from bodycheck.adapters.contract import EngineDiverged, Method, SceneUnsupported, Strides
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array

MODEL = """
<mujoco>
  <compiler balanceinertia="false"/>
  <option timestep="{timestep!r}" integrator="{integrator}" gravity="0 0 {gravity!r}">
    <flag contact="disable" constraint="disable"/>
  </option>
  <worldbody>
    <body>
      <freejoint/>
      <inertial pos="0 0 0" mass="{mass!r}" diaginertia="{moments}"/>
    </body>
  </worldbody>
</mujoco>
"""

CHUNK = 8192
"""Steps of one rollout. It returns every state, so this bounds the memory; a call costs as much as some 30 steps."""

RESETS = (mujoco.mjtWarning.mjWARN_BADQPOS, mujoco.mjtWarning.mjWARN_BADQVEL, mujoco.mjtWarning.mjWARN_BADQACC)


def version() -> str:
    return str(mujoco.__version__)


def integrators() -> tuple[str, ...]:
    # The names of the XML, which are those of the enumeration in another spelling.
    spelling = {"EULER": "Euler", "RK4": "RK4"}
    members = (name.removeprefix("mjINT_") for name in mujoco.mjtIntegrator.__members__)
    return tuple(spelling.get(name, name.lower()) for name in members)


def unsupported(scene: Scene) -> str | None:
    if scene.plane is not None:
        return "contact with a plane"
    if scene.drag:
        return "drag"
    return None


def prepare(scene: Scene, method: Method) -> "Rollout":
    if (missing := unsupported(scene)) is not None:
        raise SceneUnsupported(missing)
    xml = MODEL.format(
        timestep=method.timestep,
        integrator=method.integrator,
        gravity=-scene.gravity,
        mass=scene.body.mass,
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
    return Rollout(model, data)


class Rollout:
    """A MuJoCo model and its data, advanced by `mujoco.rollout`."""

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        self.model, self.data = model, data
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
        # MuJoCo answers a bad state by starting over from the initial one; only its warnings tell.
        for warning in RESETS:
            if self.data.warning[warning].number:
                time = float(np.max(following[:, 0], initial=start[0]))
                name = warning.name.removeprefix("mjWARN_")
                raise EngineDiverged(f"MuJoCo reset itself after {name} at t = {time:.6g} s")
