"""Drake: an impossible inertia becomes that of a ball of water, a massless one 1 kg; limits of a continuous joint stop it."""

from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.analysis import Simulator

INERTIA = '<inertia ixx="{}" iyy="{}" izz="{}" ixy="0" ixz="0" iyz="0"/>'
LINK = '<link name="{}"><inertial><mass value="{}"/>' + INERTIA + "</inertial></link>"
TURN = '<axis xyz="0 0 1"/><limit lower="-6.28318530718" upper="6.28318530718" effort="1" velocity="10"/>'
JOINT = f'<joint name="joint" type="continuous"><parent link="base"/><child link="arm"/>{TURN}</joint>'


def plant_of(*inertial):
    """Return a plant with an arm of an inertia on a fixed base."""
    plant = MultibodyPlant(0.001)
    links = LINK.format("base", 1, 0.1, 0.1, 0.1) + LINK.format("arm", *inertial)
    Parser(plant).AddModelsFromString(f'<robot name="robot">{links}{JOINT}</robot>', "urdf")
    plant.WeldFrames(plant.world_frame(), plant.GetFrameByName("base"))
    plant.Finalize()
    return plant


for name, inertial in (("impossible", (0.05, 0.001, 0.001, 0.01)), ("massless", (0, 1e-6, 1e-6, 1e-6))):
    inertia = plant_of(*inertial).GetBodyByName("arm").default_spatial_inertia()
    print(f"{name}_mass", inertia.get_mass())
    print(f"{name}_moment", inertia.CalcRotationalInertia().get_moments()[2])
simulator = Simulator(plant := plant_of(1, 0.1, 0.1, 0.1))
plant.SetVelocities(simulator.get_mutable_context(), [5.0])
simulator.AdvanceTo(2.0)
print("position", plant.GetPositions(simulator.get_context())[0])
