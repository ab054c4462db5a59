"""Mechanisms: bodies on joints, and their motion.

`mechanism` defines a mechanism, `joint_types` contains the table of the types of joints, `coordinates` describes the layout of
the coordinates of joints in arrays, and `exact` computes the numbers of a mechanism in exact arithmetic.

`recursion` computes the truth of mechanisms without loops. `tree` splits a mechanism into trees of links on elementary joints,
with `frames` in exact arithmetic. `articulated` contains the articulated-body recursion in any arithmetic, and `link_states`
the system of first order that follows from it. `mimicry` has the rules of joints that follow others, and `coupling` the
equations of the coordinates that they share. `tree_equations` and, with dry friction, `friction` solve these equations by
heyoka in any floating-point type; where heyoka is not installed, `recursion` solves them by DOP853. `poses` computes the motion
of joints and bodies from the motion of links. `ranges` has the instants at which joints pass limits.

`control` defines controllers and stops, `driven` has the motion of one joint with them in closed form, and `hybrid` follows
trees with them. `forms` contains the other motions in closed form, `lagrangian` the witness, and `loops` the motions and
witnesses of mechanisms with closed chains.
"""
