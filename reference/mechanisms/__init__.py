"""Mechanisms: bodies on joints, and their motion.

`mechanism` has what a mechanism is, `coordinates` how the coordinates of joints are laid out in arrays, and `exact` the numbers
of a mechanism in exact arithmetic.
"""
