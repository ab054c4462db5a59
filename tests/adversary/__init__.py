"""Attacks: hostile case files, damaged results and baselines, and commands that are killed, drawn by seed.

The default tests draw a few of each kind, `make slow` as many as the variables in `sizes` say. Each draw follows from one
number, its seed, and a failure says how to repeat it alone.
"""
