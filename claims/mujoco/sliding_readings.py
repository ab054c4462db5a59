"""The largest error (m/s^2) of MuJoCo's accelerometer at the centre of a block that slides down a ramp of 0.5 rad in 1 s."""

import math

import mujoco
import numpy as np

MODEL = """<mujoco><option timestep="{step}"/><default><geom friction="{friction}" condim="{condim}"/></default>
<worldbody><body euler="0 {degrees} 0"><geom type="plane" size="0 0 1"/></body><body pos="{x} 0 {z}" euler="0 {degrees} 0">
<freejoint/><geom type="box" size="0.1 0.1 0.05" mass="1"/><site name="imu"/></body></worldbody>
<sensor><accelerometer site="imu"/></sensor></mujoco>"""
ANGLE, G, HEIGHT = 0.5, 9.81, 0.05
place = {"degrees": math.degrees(ANGLE), "x": HEIGHT * math.sin(ANGLE), "z": HEIGHT * math.cos(ANGLE)}
variants = {"usual": (0.002, 0.3, 3), "small_steps": (0.0002, 0.3, 3), "smooth": (0.002, 0.0, 1)}
for name, (step, friction, condim) in variants.items():
    model = mujoco.MjModel.from_xml_string(MODEL.format(step=step, friction=friction, condim=condim, **place))
    data = mujoco.MjData(model)
    normal = G * math.cos(ANGLE)
    truth, errors, free = np.array([-friction * normal, 0, normal]), [], 0
    for _ in range(round(1 / step)):
        mujoco.mj_step(model, data)
        errors.append(np.linalg.norm(data.sensordata - truth))
        free += not data.ncon
    print(f"{name} {max(errors[len(errors) // 2 :]):.4g}\nflying_{name} {free * step:.3g}")
