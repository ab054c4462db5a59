"""Two robots, a URDF and an MJCF file, and cases of them."""

from pathlib import Path
from typing import Any

URDF = """\
<robot name="arm">
  <link name="base"><inertial><mass value="5"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="upper">
    <inertial>
      <origin xyz="0 0.02 0.3" rpy="0.3 -0.2 0.5"/><mass value="2"/>
      <inertia ixx="0.1" iyy="0.11" izz="0.02" ixy="0.001" ixz="0.002" iyz="0"/>
    </inertial>
  </link>
  <link name="frame"/>
  <link name="slider">
    <inertial>
      <origin xyz="0.1 0 0"/><mass value="0.5"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/>
    </inertial>
  </link>
  <link name="tool">
    <inertial><mass value="0.5"/><inertia ixx="0.01" iyy="0.02" izz="0.03" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <joint name="shoulder" type="revolute">
    <parent link="base"/><child link="upper"/><origin xyz="0 0 1" rpy="0.1 0.2 0.3"/><axis xyz="0 1 1"/>
    <limit lower="-1" upper="1" effort="3" velocity="4"/><dynamics damping="0.1" friction="0.02"/>
  </joint>
  <joint name="end" type="fixed"><parent link="upper"/><child link="frame"/><origin xyz="0 0 0.6" rpy="1 0 0"/></joint>
  <joint name="reach" type="prismatic"><parent link="frame"/><child link="slider"/><origin xyz="0 0.1 0"/>
    <limit effort="1" velocity="1" lower="-1" upper="1"/></joint>
  <joint name="wrist" type="continuous">
    <parent link="slider"/><child link="tool"/><origin xyz="0.2 0 0"/><axis xyz="0 0 1"/>
  </joint>
</robot>
"""

MJCF = """\
<mujoco>
  <compiler angle="degree" eulerseq="ZYX"/>
  <default>
    <joint damping="0.2"/>
    <default class="light"><geom density="200"/><joint armature="0.05"/></default>
  </default>
  <worldbody>
    <geom type="plane" size="1 1 1"/>
    <body name="post" pos="0.1 0.2 0.3" euler="10 20 30">
      <body name="swing" pos="0 0 1" axisangle="0 1 0 40" childclass="light">
        <joint name="hinge" pos="0.1 0.05 0.2" axis="1 1 0" stiffness="3" springref="20" frictionloss="0.1"/>
        <geom type="capsule" size="0.05 0.3" pos="0 0 -0.3"/>
        <body name="tip" pos="0 0 -0.7" quat="0.9 0.1 0.2 0.3">
          <joint name="ball" type="ball" pos="0 0.02 0.1" armature="0"/>
          <inertial mass="0.3" pos="0.01 0.02 -0.1" diaginertia="0.01 0.02 0.025" quat="0.5 0.5 0.1 0.7"/>
          <body name="weight" pos="0.1 0 0"><geom type="sphere" size="0.1" class="light"/></body>
          <body name="drawer" pos="0 0 -0.3">
            <joint name="slide" type="slide" axis="0 1 0"/><geom type="box" size="0.1 0.2 0.1"/>
          </body>
        </body>
      </body>
    </body>
    <body name="satellite" pos="3 0 1" xyaxes="0 1 0 -1 0 0">
      <freejoint name="free"/><geom type="ellipsoid" size="0.1 0.2 0.3"/>
    </body>
  </worldbody>
</mujoco>
"""

HEAD = 'format = 2\nname = "robot"\ntitle = "A robot"\nscene = {gravity = 9.81}\nrun = {duration = 1.0, samples = 3}\n[model]\n'


def case_file(folder: Path, model: str, starts: str, name: str = "robot.xml") -> Path:
    (folder / name).write_text(model)
    path = folder / "robot.case.toml"
    path.write_text(f'{HEAD}file = "{name}"\n{starts}')
    return path


def start(joint: str, **keys: Any) -> str:
    return f"[initial.joints.{joint}]\n" + "".join(f"{key} = {value}\n" for key, value in keys.items())
