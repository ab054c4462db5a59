"""Print the degrees of freedom that Pinocchio reads from a robot with two hinges, one of which follows the other."""

from pathlib import Path

import pinocchio as pin

robot = str(Path(__file__).parents[1] / "robots" / "mimic.urdf")
print("by_default", pin.buildModelFromUrdf(robot).nv, "\nasked_for", pin.buildModelFromUrdf(robot, mimic=True).nv)
