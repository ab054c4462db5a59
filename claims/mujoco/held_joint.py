"""Print the speed at which a slide joint creeps in MuJoCo that its dry friction of 2 N should hold against a force of 1 N."""

import mujoco

MODEL = """<mujoco><option timestep="0.002" {}/><worldbody><body><joint type="slide" axis="1 0 0" frictionloss="2" {}/>
<inertial pos="0 0 0" mass="1" diaginertia="0.1 0.1 0.1"/></body></worldbody></mujoco>"""

for name, option, joint in (
    ("default", "", ""),
    ("noslip", 'noslip_iterations="10"', ""),
    ("stiff", "", 'solimpfriction="0.9999 0.9999 0.001"'),
):
    model = mujoco.MjModel.from_xml_string(MODEL.format(option, joint))
    data = mujoco.MjData(model)
    data.qfrc_applied[0] = 1.0
    mujoco.mj_step(model, data, 2000)
    print(f"{name}_way", data.qpos[0], f"\n{name}_speed", data.qvel[0])
print("formula", (1 - 0.9) * 0.95 * 0.02 / (2 * 0.9))  # (1 - d) a d_max T / (2 d) with the default solimp and solref
