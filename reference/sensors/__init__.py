"""Sensors of a scene: what each type reads, and the truth of its readings with a bound.

The module `sensor` has the types as data, and `readings` what a truth and an engine read. A truth follows from the truth of the
motion without differentiation: accelerations, forces and moments come from the equations of motion at the states. `equations`
has these for mechanisms and flights, and `efforts` the controllers in them; `kinetics` and `wrenches` are the formulas of
readings. `expected` evaluates them at any states, `truth` at those of a truth, with the bounds of `bounding`, and `contacts`
for bodies that touch.
"""
