"""Arms as MJCF."""

from bodycheck.reference.robots.state import RobotState
from tests.support.robot_texts import hinges

#: An arm that engines that read MJCF and know hinges and slides read alike.
ARM = """
<mujoco model="arm">
  <compiler angle="radian"/>
  <option gravity="0 0 -3"/>
  <worldbody>
    <body name="upper" pos="0.1 0.2 0.3" quat="0.5 0.1 -0.7 0.5">
      <inertial pos="0.1 0 0" mass="1" quat="0.6 0 0.8 0" diaginertia="0.1 0.2 0.25"/>
      <joint name="shoulder" type="hinge" axis="0 0.6 0.8" armature="0.3" damping="0.4"/>
      <geom type="sphere" size="0.01" contype="0" conaffinity="0"/>
      <body name="lower" pos="0.2 0 -0.3" quat="0.8 0 0 0.6">
        <inertial pos="0.02 0 0.1" mass="0.4" diaginertia="0.01 0.02 0.025"/>
        <joint name="elbow" type="slide" axis="1 0 0" range="-1 1.5"/>
      </body>
    </body>
  </worldbody>
</mujoco>
"""

STATE: RobotState = hinges("shoulder", "elbow")

#: A hinge between a base on the world and an arm with an inertia.
ON_A_HINGE = """<mujoco model="arm"><worldbody><body name="base"><body name="arm">
<inertial pos="0.1 0.2 0.3" mass="2" diaginertia="0.01 0.02 0.025"/>
<joint name="hinge" type="hinge" axis="0 0 1" damping="0.5"/>
</body></body></worldbody></mujoco>
"""
