"""Textbook one-step schemes, applied to the exact equations of motion of one free rigid body, or of bodies on joints.

An engine's trajectory is compared with these schemes to identify which of them the engine implements. A scheme is a rule that
integrates a formulation of the equations of motion; rules and formulations can be combined.

- `catalogue`: open this for all schemes by the names that results show (`CATALOGUE`).
- `one_step`: the rules of Euler's kind, substeps, and `step_through`, which samples a run. `runge_kutta`: explicit and implicit
  Runge-Kutta schemes from their tableaus.
- `formulations`: equations of motion with the attitude by the exponential map, in two choices of velocity. `coordinates`:
  equations of motion with a quaternion or angles as coordinates.
- `jointed`: schemes in the coordinates of the joints of a mechanism (`JOINTED`), independent of all other modules here.
- `increments`: vectors, poses and the exponential map of SO(3) x R^3 and of SE(3), written for plain tuples.

Imports run from `catalogue` to `runge_kutta`, `one_step`, `coordinates`, `formulations` and `increments`. From the rest of the
package, only `scene`, `trajectory`, `inertia` and, by `jointed`, `mechanisms` are imported.
"""
