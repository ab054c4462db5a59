"""Sensors of a scene: what each type reads, and the truth of its readings with a bound.

The module `sensor` has the types as data. A truth follows from the truth of the motion without differentiation: accelerations,
forces and moments come from the equations of motion at the states.
"""
