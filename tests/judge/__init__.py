"""An independent judge of truths: scenes that are drawn, and their motions in arithmetic of fifty digits that shares no code.

The judge has nothing of bodycheck but the text of a case file and what a truth prints: states, bounds, and instants of events
with their errors. It reads the file with tomllib, takes each number as the double nearest to its decimals, and derives the
motion by equations of its own. A truth holds where no printed number is farther from the judge's than the bound beside it.

- `numerals`: numbers of fifty digits, vectors, matrices and attitudes.
- `series`: power series of the solutions of differential equations, their steps and roots.
- `turning`: attitudes of bodies whose angular velocity is known.
- `solids`, `states`, `planes`: inertia, states, and bodies on planes, as files state them.
- `jointed`: bodies on hinges and sliders with dry friction.
- `maximal`: trees of bodies on hinges, sliders and welds, free bases included, in the coordinates of every body.
- `rolling`: spheres with rolling and torsional friction.
- `slips`, `balls`, `blocks`, `drops`, `rods`, `coins`: bodies that touch a plane, by families.
- `mechanism_scenes`, `tree_scenes`, `contact_scenes`, `rolling_scenes`, `documents`: scenes drawn from a seed, and
  their case files.
- `verdicts`: the comparison.

`python -m tests.judge mechanisms 1 500`, with `trees` or `contacts` in place of `mechanisms` too, judges so many scenes from a
seed on and prints a line for each.
"""
