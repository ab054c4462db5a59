"""The moments of inertia that a body loaded from a URDF has about x, y and z: an impulse of torque J turns it with J / I."""

import rapier3d
from rapier3d.loaders import urdf

URDF = """<robot name="a"><link name="l"><inertial><origin rpy="{}"/><mass value="1"/>
<inertia ixx="{}" iyy="{}" izz="{}" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"""


def felt(moments, axis, rpy="0 0 0"):
    world = rapier3d.PhysicsWorld(gravity=(0, 0, 0))
    options = urdf.UrdfLoaderOptions(rigid_body_blueprint=rapier3d.RigidBody.dynamic())
    robot, _ = urdf.UrdfRobot.from_str(URDF.format(rpy, *moments), options)
    handles = robot.insert_using_impulse_joints(world.rigid_bodies, world.colliders, world.impulse_joints)
    body = world.rigid_bodies[handles.links[0].body]
    body.recompute_mass_properties_from_colliders(world.colliders)
    body.apply_torque_impulse(tuple(moments[0] * (index == axis) for index in range(3)))
    return moments[0] / body.angvel.to_tuple()[axis]


for axis, name in enumerate("xyz"):
    print(f"given_2_1_1_{name} {felt((2, 1, 1), axis):.6g}")
    print(f"finger_{name} {felt((2.375e-6, 2.375e-6, 7.5e-7), axis):.6g}")
print(f"turned_x {felt((0.001, 0.02, 0.02), 0, '0 0 1.5707963267948966'):.6g}")
