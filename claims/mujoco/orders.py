"""Print the attitude errors (rad) within 10 s of OSRF's tumbling box in MuJoCo, and the orders of its integrators."""

import mujoco
import numpy as np

MODEL = """<mujoco><option integrator="{}" timestep="{}"/><worldbody>
<body><freejoint/><geom type="box" size="0.05 0.2 0.45" mass="10"/></body></worldbody></mujoco>"""


def rate(state, slope, h):
    """Return Euler's equations for a quaternion and an angular velocity (axes of the box) at state + h slope."""
    w, x, y, z, a, b, c = (s + h * r for s, r in zip(state, slope, strict=True))
    turn = (-x * a - y * b - z * c) / 2, (w * a + y * c - z * b) / 2, (w * b + z * a - x * c) / 2, (w * c + x * b - y * a) / 2
    return *turn, b * c * 65 / 97, -c * a * 40 / 41, a * b * 15 / 17  # from moments in the ratio 97 : 82 : 17


exact, h, before = [[1, 0, 0, 0, 0.1, 5, 0.1]], 1e-4, 1.0  # Runge-Kutta 4, whose own error is 1e-10 rad
for _ in range(100000):
    k = [rate(exact[-1], exact[-1], 0.0)]
    for part in (h / 2, h / 2, h):
        k.append(rate(exact[-1], k[-1], part))
    exact.append([s + h / 6 * (p + 2 * q + 2 * r + u) for s, p, q, r, u in zip(exact[-1], *k, strict=True)])
for name, step in (("Euler", 2), ("Euler", 1), ("implicit", 2), ("implicit", 1), ("RK4", 10), ("RK4", 5)):
    data, worst = mujoco.MjData(model := mujoco.MjModel.from_xml_string(MODEL.format(name, step / 1000))), 0.0
    data.qvel = [-2, 2, 8, *exact[0][4:]]
    for reference in np.array(exact)[100::100, :4]:
        mujoco.mj_step(model, data, 10 // step)
        worst = max(worst, 4 * np.arcsin(min(np.linalg.norm(data.qpos[3:] - s * reference) for s in (1, -1)) / 2))
    print(f"{name}_{step}ms {worst}\n{name}_order_{step}ms {np.log2(before / worst)}")
    before = worst
