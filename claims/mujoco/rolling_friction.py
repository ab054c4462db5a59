"""Print the deceleration of a ball that rolls in MuJoCo over that of its rolling friction, by settings."""

import mujoco

GRAVITY, RADIUS, STEP = 9.81, 0.1, 1e-3
MODEL = """<mujoco><option timestep="0.001" gravity="0 0 -9.81" {option}/>
<default><geom condim="6" friction="0.5 1e-5 {rolling}"/></default><worldbody><geom type="plane" size="0 0 1"/>
<body pos="0 0 0.1"><freejoint/><inertial pos="0 0 0" mass="1" diaginertia="0.004 0.004 0.004"/>
<geom type="sphere" size="0.1"/></body></worldbody></mujoco>"""


def part(option: str, rolling: float, speed: float) -> float:
    """Return the mean deceleration from 0.3 s to 0.5 s over mu_r g / (1.4 r)."""
    model = mujoco.MjModel.from_xml_string(MODEL.format(option=option, rolling=rolling))
    data = mujoco.MjData(model)
    data.qvel[[0, 4]] = speed, speed / RADIUS
    mujoco.mj_step(model, data, 300)
    first = data.qvel[0]
    mujoco.mj_step(model, data, 200)
    return float((first - data.qvel[0]) / (200 * STEP) / (rolling * GRAVITY / (1.4 * RADIUS)))


for name, option in (
    ("default", ""),
    ("elliptic", 'cone="elliptic"'),
    ("impratio", 'impratio="100"'),
    ("both", 'cone="elliptic" impratio="100"'),
):
    print(name, part(option, 2e-3, 0.1), f"\n{name}_small", part(option, 1e-4, 1.0))
