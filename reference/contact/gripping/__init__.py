"""A free body between two fingers, which slide on joints and press it with equal forces.

- `waves`: functions of time, and the first instant at which one becomes negative.
- `grip`: the body, its fingers, and the carriage that may bear them.
- `course`: phases in which the body is held or slips along a line.
- `turning`: a body that turns about its contacts.
- `way`: the motion at given instants, and its bounds.
"""
