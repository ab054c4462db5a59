"""Print whether MJX takes a model in which a ball can touch a cylinder, and one in which a cylinder can touch a box."""

import mujoco
from mujoco import mjx

MODEL = """<mujoco><worldbody><geom type="{}" size="1 1 1"/><body pos="0 0 3"><freejoint/><geom type="{}" size="0.1 0.1"/>
</body></worldbody></mujoco>"""
for name, kinds in (("ball_cylinder", ("cylinder", "sphere")), ("cylinder_box", ("box", "cylinder"))):
    try:
        mjx.put_model(mujoco.MjModel.from_xml_string(MODEL.format(*kinds)))
        print(name, "taken")
    except NotImplementedError:
        print(name, "refused")
