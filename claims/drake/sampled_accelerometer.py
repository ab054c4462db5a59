"""The distance (m/s^2) of Drake's accelerometer on a discrete pendulum from its readings at the present and the last state."""

import numpy as np
from pydrake.math import RigidTransform
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import RevoluteJoint, SpatialInertia, UnitInertia
from pydrake.systems.analysis import Simulator
from pydrake.systems.sensors import Accelerometer


def readings(sampled, step=0.002):
    plant = MultibodyPlant(step)
    plant.SetUseSampledOutputPorts(sampled)
    arm = plant.AddRigidBody("arm", SpatialInertia(1.0, [0.0, 0, -0.5], UnitInertia(0.3, 0.3, 0.01)))
    pin = plant.AddJoint(RevoluteJoint("pin", plant.world_frame(), arm.body_frame(), [0, 1, 0]))
    plant.Finalize()
    imu = Accelerometer(arm, RigidTransform([0, 0, -0.5]), plant.gravity_field().gravity_vector())
    simulator, inside = Simulator(plant), imu.CreateDefaultContext()
    context = simulator.get_mutable_context()
    pin.set_angle(context, 1.0)
    pin.set_angular_rate(context, 5.0)
    for number in (1, 2):
        simulator.AdvanceTo(number * step)
        for port in map(imu.get_input_port, range(imu.num_input_ports())):
            port.FixValue(inside, plant.GetOutputPort(port.get_name()).Eval(context))
        yield imu.get_output_port().Eval(inside)


(last, present), (_, sampled) = readings(False), readings(True)
print(f"from_present {np.linalg.norm(sampled - present):.4g}\nfrom_last {np.linalg.norm(sampled - last):.4g}")
