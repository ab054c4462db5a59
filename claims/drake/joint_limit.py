"""Print how far a hinge at 2 rad/s goes beyond its limit of 0.1 rad in Drake, and which part of its rate the limit returns."""

import pydrake.all as drake


def turned(step, scheme):
    builder = drake.DiagramBuilder()
    plant, _ = drake.AddMultibodyPlantSceneGraph(builder, step)
    if step:
        plant.set_discrete_contact_approximation(getattr(drake.DiscreteContactApproximation, scheme))
    body = plant.AddRigidBody("arm", drake.SpatialInertia(1.0, [0, 0, 0], drake.UnitInertia(0.01, 0.01, 0.01)))
    joint = drake.RevoluteJoint("pin", plant.world_frame(), body.body_frame(), [0, 1, 0], -1.0, 0.1)
    joint = plant.AddJoint(joint)
    plant.mutable_gravity_field().set_gravity_vector([0, 0, 0])
    plant.Finalize()
    simulator = drake.Simulator(builder.Build())
    if not step:
        config = drake.SimulatorConfig(integration_scheme=scheme, max_step_size=1e-3, use_error_control=False)
        drake.ApplySimulatorConfig(config, simulator)
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    joint.set_angular_rate(context, 2.0)
    angles = [simulator.AdvanceTo(n * 1e-3) and joint.get_angle(context) for n in range(1, 301)]
    return sorted(angles)[-1] - 0.1, -joint.get_angular_rate(context) / 2


runs = {"sap": (1e-3, "kSap"), "tamsi": (1e-3, "kTamsi"), "cenic": (0.0, "cenic"), "rk3": (0.0, "runge_kutta3")}
for name, (step, scheme) in runs.items():
    print("{0}_beyond {1}\n{0}_returned {2}".format(name, *turned(step, scheme)))
