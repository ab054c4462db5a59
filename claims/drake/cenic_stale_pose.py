"""Print by how much the pose that Drake gives of a body at 1 m/s lags its positions after steps of 10 ms of `cenic`."""

from pydrake.all import AddMultibodyPlant, DiagramBuilder, MultibodyPlantConfig, ResetIntegratorFromFlags, Simulator
from pydrake.multibody.tree import SpatialInertia


def lag(scheme, fixed):
    """Return the x of the positions less the x of the pose after three steps."""
    builder = DiagramBuilder()
    plant, _ = AddMultibodyPlant(MultibodyPlantConfig(time_step=0.0), builder)
    plant.set_name("plant")  # the name that cenic needs
    body = plant.AddRigidBody("body", SpatialInertia.SolidBoxWithMass(1, 0.1, 0.2, 0.3))
    plant.Finalize()
    simulator = Simulator(builder.Build())
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    plant.SetVelocities(context, [0, 0, 0, 1, 0, 0])
    ResetIntegratorFromFlags(simulator, scheme, 0.01)
    simulator.get_mutable_integrator().set_fixed_step_mode(fixed)
    for step in (1, 2, 3):
        simulator.AdvanceTo(0.01 * step)
        pose = plant.EvalBodyPoseInWorld(context, body)
    return plant.GetPositions(context)[4] - pose.translation()[0]


for name, scheme, fixed in (("cenic", "cenic", True), ("controlled", "cenic", False), ("runge_kutta3", "runge_kutta3", True)):
    print(name, round(lag(scheme, fixed), 12))
