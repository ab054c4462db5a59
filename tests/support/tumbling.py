"""The text of a case whose layout is unusual and must be kept."""

TUMBLING = """\
# A comment before everything.
format = 1
name = "tumbling"
title = "A brick that tumbles"
[run]                 # not where it usually stands
samples = 11
duration = 0.1

[[expect]]  # of the first engine
timestep = 0.01
integrator = "Euler"
engine = "mujoco"
order = 1             # and this stays
attitude_error = 3.0  # set by hand
energy_drift = {at_most = 9.0}
velocity_error   =   9          # 3 x 9.99 measured with mujoco 1.0.0
angular_velocity_error=9.0

[body]
shape = "brick"
semi_axes = [0.1, 0.2, 0.3]
mass = 1.0
[initial]
angular_velocity = [1.0, 5.0, 0.1]
velocity = [1.0, 0.0, 0.0]
# A comment after everything."""
