"""Print the largest errors within 10 s of a brick that spins about its intermediate axis, in MuJoCo with steps of 2 ms."""

import mujoco
import numpy as np

MODEL = """<mujoco><option integrator="{}" timestep="0.002"/><worldbody>
<body><freejoint/><geom type="box" size="0.1 0.3 0.2" mass="1"/></body></worldbody></mujoco>"""


def rate(state, slope, h):
    """Return Euler's equations for a quaternion and an angular velocity (axes of the brick) at state + h slope."""
    w, x, y, z, a, b, c = (s + h * r for s, r in zip(state, slope, strict=True))
    turn = (-x * a - y * b - z * c) / 2, (w * a + y * c - z * b) / 2, (w * b + z * a - x * c) / 2, (w * c + x * b - y * a) / 2
    return *turn, -b * c * 5 / 13, -c * a * 3 / 5, a * b * 4 / 5  # from moments in the ratio 13 : 5 : 10


models = {n: mujoco.MjModel.from_xml_string(MODEL.format(n)) for n in ("Euler", "implicit", "implicitfast", "RK4")}
runs, exact, h, largest = {n: mujoco.MjData(models[n]) for n in models}, [0.5**0.5, 0.5**0.5, 0, 0, 0.1, 0, 10], 1e-4, {}
for data in runs.values():
    data.qpos[3:], data.qvel = exact[:4], [1, 0, 2, *exact[4:]]
for t in np.arange(1, 100001) * h:
    k = [rate(exact, exact, 0.0)]
    for part in (h / 2, h / 2, h):
        k.append(rate(exact, k[-1], part))  # Runge-Kutta 4, whose own error is 1e-10 rad
    exact = [s + h / 6 * (p + 2 * q + 2 * r + u) for s, p, q, r, u in zip(exact, *k, strict=True)]
    for n, data in runs.items() if round(t / h) % 20 == 0 else ():
        mujoco.mj_step(models[n], data)
        turn = 4 * np.arcsin(min(np.linalg.norm(data.qpos[3:] - np.multiply(exact[:4], sign)) for sign in (1, -1)) / 2)
        largest[n] = np.maximum(largest.get(n, 0), (turn, np.linalg.norm(data.qpos[:3] - [t, 0, 2 * t - 4.905 * t**2])))
print(*(f"{n}_attitude {turn}\n{n}_position {gap}" for n, (turn, gap) in largest.items()), sep="\n")
