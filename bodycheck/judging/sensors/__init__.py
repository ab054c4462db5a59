"""What the sensors of engines read: the error of readings, and the convention that explains them.

- `past`: the states of an engine at the instants of readings and some steps before each.
- `laws`: what a sensor would read by other conventions, such as other axes, or accelerations by differences of velocities.
- `identification`: which of these explains the readings best.
- `rows`, `measurement`: the table sensors.csv, and its rows of a run.
"""
