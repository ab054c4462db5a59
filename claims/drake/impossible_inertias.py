"""Print what Drake makes of an inertia that no body can have, of a link without mass, and of a continuous joint with limits."""

import logging

from pydrake.all import MultibodyPlant, Parser, Simulator

ROBOT = """<robot name="robot"><link name="base"/>
<link name="impossible"><inertial><mass value="0.1"/>
<inertia ixx="1" iyy="1e-6" izz="1e-6" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="massless"><inertial><mass value="0"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="hinge" type="continuous"><parent link="base"/><child link="impossible"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" effort="1" velocity="100"/></joint>
<joint name="weld" type="fixed"><parent link="base"/><child link="massless"/></joint></robot>"""

logging.getLogger("drake").setLevel(logging.ERROR)  # Drake warns of both inertias
plant = MultibodyPlant(0.001)
Parser(plant).AddModelsFromString(ROBOT, "urdf")
plant.WeldFrames(plant.world_frame(), plant.GetBodyByName("base").body_frame())
plant.Finalize()
inertia = plant.GetBodyByName("impossible").default_spatial_inertia()
print("moment", inertia.CalcRotationalInertia().get_moments()[0])
print("mass", plant.GetBodyByName("massless").default_mass())
simulator = Simulator(plant)
plant.SetVelocities(simulator.get_mutable_context(), [5.0])
simulator.AdvanceTo(2.0)
print("angle", plant.GetPositions(simulator.get_context())[0])
