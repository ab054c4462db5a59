"""The units of the results' columns."""

UNITS = {
    "position_error": "m",
    "velocity_error": "m/s",
    "attitude_error": "rad",
    "angular_velocity_error": "rad/s",
    "truth_error": "rad",
    "stop_time_error": "s",
    "stop_position_error": "m",
    "stop_yaw_error": "rad",
    "creep": "m/s",
    "penetration": "m",
    "tilt": "rad",
}
"""Of the columns that have one; all others are relative."""
