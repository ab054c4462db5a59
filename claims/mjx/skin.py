"""Print how deep (m) a brick that falls on a corner sinks into a plane in MJX, with its skin and without it, and in MuJoCo."""

import inspect
import os

os.environ |= {"JAX_ENABLE_X64": "true", "JAX_PLATFORMS": "cpu"}
import jax
import mujoco
import numpy as np
from mujoco import mjx
from mujoco.mjx._src import collision_convex, collision_driver

TURN, HALF = [0.8652195646343935, 0.34118474668287657, -0.03423265967898393, 0.36580896464700624], [0.1, 0.15, 0.05]
MODEL = """<mujoco><option timestep="0.002"/><default><geom friction="0.5 0.005 0.0001"/></default><worldbody>
<geom type="plane" size="0 0 1"/><body pos="0 0 0.5"><freejoint/><geom type="box" size="0.1 0.15 0.05" mass="1"/></body>
</worldbody></mujoco>"""
model = mujoco.MjModel.from_xml_string(MODEL)
data = mujoco.MjData(model)
data.qpos[3:] = TURN
corners, put = np.array(np.meshgrid(*([-half, half] for half in HALF))).reshape(3, -1), mjx.put_model(model)
deep = lambda one: -(one.xpos[1][2] + one.xmat[1].reshape(3, 3)[2] @ corners).min()  # noqa: E731
for name, skin in (("skin", "1e-3"), ("none", "1e3")):
    exec(inspect.getsource(collision_convex).replace("support.max() - 1e-3", f"support.max() - {skin}"), vars(collision_convex))
    collision_driver._COLLISION_FUNC[mjx.GeomType.PLANE, mjx.GeomType.BOX] = collision_convex.plane_convex
    own = mjx.make_data(model).replace(qpos=jax.numpy.array(data.qpos))
    step = jax.jit(lambda own: jax.lax.scan(lambda one, _: ((after := mjx.step(put, one)), deep(after)), own, length=1500))
    print(name, np.max(step(own)[1]))
print("mujoco", max((mujoco.mj_step(model, data), deep(data))[1] for _ in range(1500)))
