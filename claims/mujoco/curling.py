"""Print the error of the yaw (rad) at which a brick that slides and spins comes to rest in MuJoCo, with steps of 0.5 ms."""

import mujoco
import numpy as np

MODEL = """<mujoco><option timestep="0.0005" {}/><default><geom friction="0.5 0.005 0.0001"/></default><worldbody>
<geom type="plane" size="0 0 1"/><body><freejoint/><geom type="box" size="0.1 0.2 0.05" mass="1"/></body></worldbody>
</mujoco>"""
X, Y = np.meshgrid((np.arange(100) - 49.5) / 500, (np.arange(200) - 99.5) / 500)  # m, points of the face that touches


def rate(state):
    """Return the rates of yaw, velocity and spin under Coulomb friction that acts alike at all points of the face."""
    yaw, vx, vy, spin = state
    x, y = np.cos(yaw) * X - np.sin(yaw) * Y, np.sin(yaw) * X + np.cos(yaw) * Y
    px, py = vx - spin * y, vy + spin * x
    px, py = -0.5 * 9.81 * np.array([px, py]) / np.hypot(px, py)
    return np.array([spin, px.mean(), py.mean(), (x * py - y * px).mean() * 3 / 0.05])


exact, h = np.array([0.0, 2.0, 0.0, 10.0]), 1e-3
while exact[3] > 0.05:  # rad/s; it then turns by less than 1e-3 rad
    middle = exact + h / 2 * rate(exact)
    exact = exact + h * rate(middle)
for name, options in (("pyramidal", ""), ("elliptic", 'cone="elliptic"')):
    data = mujoco.MjData(model := mujoco.MjModel.from_xml_string(MODEL.format(options)))
    data.qpos[2], data.qvel = 0.05, [2, 0, 0, 0, 0, 10]
    mujoco.mj_step(model, data, 1600)
    print(name, 2 * np.arctan2(data.qpos[6], data.qpos[3]) - exact[0])
