"""Print how a process ends in which a constraint connects a free body with Drake's world, or with a body welded to it."""

import subprocess
import sys

MODEL = """
from pydrake.all import DiscreteContactApproximation, MultibodyPlant, RigidTransform, Simulator, SpatialInertia
plant = MultibodyPlant(0.001)
plant.set_discrete_contact_approximation(DiscreteContactApproximation.kSap)
inertia = SpatialInertia.SolidBoxWithMass(1, 0.1, 0.1, 0.1)
body, anchor, world = plant.AddRigidBody("body", inertia), plant.AddRigidBody("anchor", inertia), plant.world_body()
plant.WeldFrames(plant.world_frame(), anchor.body_frame())
{}
plant.Finalize()
Simulator(plant).AdvanceTo(0.1)
"""
CONSTRAINTS = {
    "ball_anchor": "plant.AddBallConstraint(anchor, [0, 0, 0], body, [0.1, 0, 0])",
    "ball": "plant.AddBallConstraint(world, [0, 0, 0], body, [0.1, 0, 0])",
    "ball_reversed": "plant.AddBallConstraint(body, [0.1, 0, 0], world, [0, 0, 0])",
    "distance": "plant.AddDistanceConstraint(world, [0, 0, 0], body, [0.1, 0, 0], 0.3)",
    "weld": "plant.AddWeldConstraint(world, RigidTransform(), body, RigidTransform())",
}
for name, line in CONSTRAINTS.items():
    code = subprocess.run([sys.executable, "-c", MODEL.format(line)], capture_output=True).returncode
    print(name, {0: "completes", -11: "SIGSEGV"}.get(code, code))
