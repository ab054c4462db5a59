"""A flat body that slides and spins on a plane with Coulomb friction, until it stops [G, Example 2.2, corrected].

- `motion`: open this first. `slide` gives the motion with the bound of its error; it chooses between closed forms and the
  coupled equations.
- `coupled_motion`: sliding and spinning at once, integrated in two formulations.
- `friction`: the laws of friction, as functions of velocity and spin.
- `pressure`: how the load of a body is distributed over its footprint.
- `direction_moments`: integrals of the direction of sliding over a footprint, exact to rounding.
- `footprint`: the face on which a body lies.

Imports run in this order: `motion`, `coupled_motion`, `friction`, then `pressure` and `direction_moments`, then `footprint`.
"""
