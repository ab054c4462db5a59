"""Load a link with principal moments from a URDF into Rapier, and feel them by an impulse of torque J: w = J / I about an axis.

Needs rapier3d 0.36.1 alone.
"""

import rapier3d
from rapier3d.loaders import urdf

URDF = """<robot name="a"><link name="l"><inertial><origin rpy="{rpy}"/><mass value="1"/>
<inertia ixx="{x}" iyy="{y}" izz="{z}" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"""


def felt(moments, rpy="0 0 0"):
    """Return the moments (kg m^2) about the axes x, y and z of the link."""
    answers = []
    for axis in range(3):
        world = rapier3d.PhysicsWorld(gravity=(0, 0, 0))
        options = urdf.UrdfLoaderOptions(rigid_body_blueprint=rapier3d.RigidBody.dynamic())
        x, y, z = moments
        robot, _ = urdf.UrdfRobot.from_str(URDF.format(rpy=rpy, x=x, y=y, z=z), options)
        handles = robot.insert_using_impulse_joints(world.rigid_bodies, world.colliders, world.impulse_joints)
        body = world.rigid_bodies[handles.links[0].body]
        body.recompute_mass_properties_from_colliders(world.colliders)
        body.apply_torque_impulse(tuple(moments[0] * (index == axis) for index in range(3)))
        answers.append(moments[0] / body.angvel.to_tuple()[axis])
    return " ".join(f"{answer:9.4g}" for answer in answers)


print("given, and felt about x, y and z (kg m^2)")
for given in (
    (2, 1, 1),
    (1, 2, 1),
    (1, 1, 2),
    (3, 2, 1.5),
    (3e-3, 2e-3, 1.5e-3),
    (3e-5, 2e-5, 1.5e-5),
    (3e-6, 2e-6, 1.5e-6),
    (2.375e-6, 2.375e-6, 7.5e-7),
):
    print(" ".join(f"{moment:9.4g}" for moment in given), "  ", felt(given))
print(
    "(0.001, 0.02, 0.02) turned by rpy = 0 0 pi/2, expected 0.02 0.001 0.02:",
    felt((0.001, 0.02, 0.02), "0 0 1.5707963267948966"),
)
