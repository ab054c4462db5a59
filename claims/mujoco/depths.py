"""Print how deep a brick of 1 kg sinks into a plane in 1 s, as a peak and at the end, after it is set down at zero depth."""

import mujoco
import numpy as np

MODEL = """<mujoco><option timestep="0.002" gravity="0 0 -{gravity}" cone="{cone}" integrator="{integrator}"/>
<default><geom friction="{friction} 0.005 0.0001"/></default><worldbody><geom type="plane" size="0 0 1"/>
<body pos="0 0 0.05"><freejoint/><geom type="box" size="0.1 0.2 0.05" mass="1"/></body></worldbody></mujoco>"""


def depths(gravity=9.81, friction=0.5, cone="pyramidal", integrator="Euler"):
    """Return the largest and the last depth (m) of the lowest corner."""
    model = mujoco.MjModel.from_xml_string(MODEL.format(**locals()))
    data, turn, seen = mujoco.MjData(model), np.empty(9), []
    for _ in range(500):
        mujoco.mj_step(model, data)
        mujoco.mju_quat2Mat(turn, data.qpos[3:])
        seen.append(np.abs(turn[6:]) @ (0.1, 0.2, 0.05) - data.qpos[2])
    return max(seen), seen[-1]


for name, chosen in {
    "friction_3": {"friction": 3},
    "friction_10": {"friction": 10},
    **{f"sun_{name}": {"gravity": 274, "integrator": name} for name in ("Euler", "RK4", "discrete")},
    "strong": {"gravity": 1e4},
    "strong_RK4": {"gravity": 1e4, "integrator": "RK4"},
}.items():
    print(name, f"sinks {depths(**chosen)[0]:.3g} m into the plane")
print("elliptic", depths(friction=10, cone="elliptic")[0], "\nsun_rest", depths(274)[1], "\nstrong_rest", depths(1e4)[1])
