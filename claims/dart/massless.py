"""DART: a link without `<inertial>` has 1 kg and 1 kg m^2; a stated mass of 0 stays."""

import tempfile

import dartpy as dart

INERTIA = '<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/>'
GIVEN = '<link name="{}"><inertial><mass value="{}"/>' + INERTIA + "</inertial></link>"
JOINT = '<joint name="{0}" type="fixed"><parent link="base"/><child link="{0}"/></joint>'
text = GIVEN.format("base", 2) + '<link name="bare"/>' + GIVEN.format("zero", 0) + JOINT.format("bare") + JOINT.format("zero")

with tempfile.NamedTemporaryFile("w", suffix=".urdf") as file:
    file.write(f'<robot name="robot">{text}</robot>')
    file.flush()
    robot = dart.utils.DartLoader().parseSkeleton(file.name)
print("bare_mass", robot.getBodyNode("bare").getInertia().getMass())
print("bare_moment", robot.getBodyNode("bare").getInertia().getMoment()[0][0])
print("zero_mass", robot.getBodyNode("zero").getInertia().getMass())
