"""The charts of a case.

- `curves`: the errors and the angular momentum over time, as datasets with few enough points to be stored in a page.
  `joint_curves`: those of joints. `time_charts` draws both.
- `step_charts`: the errors over the time step.
"""
