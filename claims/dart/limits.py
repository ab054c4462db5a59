"""DART: the limits of a joint of a URDF are kept, and stop the joint only after `setLimitEnforcement(True)`."""

import tempfile

import dartpy as dart

INERTIA = '<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/>'
LINKS = "".join(f'<link name="{name}"><inertial><mass value="1"/>{INERTIA}</inertial></link>' for name in ("base", "arm"))
LIMIT = '<limit lower="-1" upper="1" effort="1" velocity="10"/>'
JOINT = f'<joint name="joint" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>{LIMIT}</joint>'

for name, enforced in (("default", None), ("enforced", True)):
    loader = dart.utils.DartLoader()
    loader.setOptions(dart.utils.DartLoaderOptions(defaultRootJointType=dart.utils.DartLoaderRootJointType.FIXED))
    with tempfile.NamedTemporaryFile("w", suffix=".urdf") as file:
        file.write(f'<robot name="robot">{LINKS}{JOINT}</robot>')
        file.flush()
        robot = loader.parseSkeleton(file.name)
    joint = robot.getJoint("joint")
    if enforced:
        joint.setLimitEnforcement(True)
    world = dart.simulation.World()
    world.setGravity([0, 0, 0])
    world.addSkeleton(robot)
    robot.setVelocities([5.0])
    while world.getTime() < 2.0 - 1e-9:
        world.step()
    print(f"{name}_told", joint.getPositionUpperLimit(0))
    print(f"{name}_position", robot.getPositions()[0])
