"""The charts of a case.

- `curves`: the errors and the angular momentum over time, as datasets with few enough points to be stored in a page.
- `joint_curves`: the coordinates of joints over time, as a dataset.
- `time_charts`: the charts that draw these datasets.
- `step_charts`: charts of the errors over the time step.
"""
