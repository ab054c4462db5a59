"""Print the attitude errors (rad) within 10 s of OSRF's tumbling box in MuJoCo, and the orders of two integrators."""

import mujoco
import numpy as np

MODEL = """<mujoco><option integrator="{}" timestep="{}"/><worldbody>
<body><freejoint/><geom type="box" size="0.05 0.2 0.45" mass="10"/></body></worldbody></mujoco>"""


def rate(state, slope, h):
    """Return Euler's equations for a quaternion and an angular velocity (axes of the box) at state + h slope."""
    w, x, y, z, a, b, c = (s + h * r for s, r in zip(state, slope, strict=True))
    turn = (-x * a - y * b - z * c) / 2, (w * a + y * c - z * b) / 2, (w * b + z * a - x * c) / 2, (w * c + x * b - y * a) / 2
    return *turn, b * c * 65 / 97, -c * a * 40 / 41, a * b * 15 / 17  # from moments in the ratio 97 : 82 : 17


exact, h, before = [[1, 0, 0, 0, 0.1, 5, 0.1]], 1e-4, 1.0
for _ in range(100000):  # Runge-Kutta 4
    k = [rate(exact[-1], exact[-1], 0.0)]
    _ = [k.append(rate(exact[-1], k[-1], part)) for part in (h / 2, h / 2, h)]
    exact.append([s + h / 6 * (p + 2 * q + 2 * r + u) for s, p, q, r, u in zip(exact[-1], *k, strict=True)])
for name, step in (("implicit", 2), ("implicit", 1), ("implicitfast", 2), ("implicitfast", 1)):
    data, worst = mujoco.MjData(model := mujoco.MjModel.from_xml_string(MODEL.format(name, step / 1000))), 0.0
    data.qvel = [-2, 2, 8, *exact[0][4:]]
    for reference in np.array(exact)[100::100, :4]:
        mujoco.mj_step(model, data, 10 // step)
        worst = max(worst, 4 * np.arcsin(min(np.linalg.norm(data.qpos[3:] - s * reference) for s in (1, -1)) / 2))
    for kind in ("euler", "midpoint", "now"):  # names of one number in the releases of the record
        print(f"{name}_{kind} {worst}\norder_{kind} {np.log2(before / worst)}")
    before = worst
