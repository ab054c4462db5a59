"""A flat body that slides and spins on a plane with Coulomb friction, until it stops [G, Example 2.2, corrected].

- `motion`: open this first. `slide` gives the motion with the bounds of its error; it chooses between closed forms and the
  coupled equations.
- `ways`: every way of computing a slide, with the bounds of each, for a cross-check.
- `bounds`: the bounds of a slide, from the errors that the witness estimates.
- `balance`: the witness, which checks the balance of momentum along a motion with the data of the case file.
- `quadrature`: the separate law of friction of the witness, by quadrature over the face.
- `coupled_motion`: sliding and spinning at once, integrated in two formulations.
- `stepping`: integration until rest, with time among the unknowns.
- `panels`: a motion in panels with Gauss nodes, the form that the witness needs.
- `friction`: the laws of friction, as functions of velocity and spin.
- `pressure`: the distribution of the load of a body over its footprint.
- `direction_moments`: integrals of the direction of sliding over a footprint, exact to rounding.
- `footprint`: the face on which a body lies.

Imports run in this order: `ways`, `motion`, `bounds`, then `balance` and `coupled_motion`. Below these, `coupled_motion`
depends on `stepping`, `friction`, `pressure`, `direction_moments` and `footprint`; `balance` imports `quadrature` and `panels`,
which import no other module of this folder.
"""
