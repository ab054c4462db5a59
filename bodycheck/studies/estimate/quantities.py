"""The names of the quantities whose errors are estimated."""

#: The quantities that are estimated if none is named, and those that may be named.
USUAL = ("attitude_error", "position_error", "joint_position_error", "joint_slide_error", "energy_drift")
NAMED = (*USUAL, "velocity_error", "angular_velocity_error", "energy_error")

#: The quantities that are compared with `--error` if none is named: angles and lengths.
PLACES = USUAL[:4]

#: The quantities that are angles.
ANGLES = ("attitude_error", "joint_position_error")

#: The end of the name of a quantity at the last instant, where that without it is the largest over time.
AT_END = "_at_end"

#: Short names of quantities.
SHORT = {"attitude": "attitude_error", "position": "position_error", "energy": "energy_drift"}

#: The quantities of one run alone: their exact value is zero.
OF_ONE_RUN = ("energy_drift",)
