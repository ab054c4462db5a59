"""Print whether MuJoCo compiles a moving body that has mass, but no moments of inertia."""

import mujoco

MODEL = """<mujoco><worldbody><body><joint type="slide"/><inertial pos="0 0 0" mass="1" diaginertia="{0} {0} {0}"/></body>
</worldbody></mujoco>"""
for name, moment in (("point", 0), ("small", 1e-6)):
    try:
        mujoco.MjModel.from_xml_string(MODEL.format(moment))
        print(name, "compiled")
    except ValueError:
        print(name, "refused")
