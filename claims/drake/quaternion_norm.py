"""Print how far Drake's quaternions are from norm 1 after 10 s of steps of 2 ms of a brick that tumbles."""

from pydrake.all import MultibodyPlant, ResetIntegratorFromFlags, Simulator, SpatialInertia

for method in ("explicit_euler", "lagged"):
    plant = MultibodyPlant(0.002 if method == "lagged" else 0.0)
    plant.AddRigidBody("brick", SpatialInertia.SolidBoxWithMass(1.0, 0.2, 0.6, 0.4))
    plant.Finalize()
    simulator = Simulator(plant)
    context = simulator.get_mutable_context()
    plant.SetPositions(context, [0.5**0.5, 0.5**0.5, 0, 0, 0, 0, 0])
    plant.SetVelocities(context, [0.1, -10.0, 0.0, 1.0, 0.0, 2.0])
    if method != "lagged":
        ResetIntegratorFromFlags(simulator, method, 0.002)
        simulator.get_mutable_integrator().set_fixed_step_mode(True)
    largest = 0.0
    for step in range(1, 5001):
        simulator.AdvanceTo(0.002 * step)
        norm = sum(part**2 for part in plant.GetPositions(context)[:4]) ** 0.5
        largest = max(largest, abs(norm - 1))
    print(method, largest)
