"""Textbook one-step schemes, applied to the exact equations of motion of one free rigid body.

An engine's trajectory is compared with these schemes to identify which of them the engine implements.

- `one_step`: open this for the schemes themselves (`SCHEMES`) and for `step_through`, which samples a run of one of them.
- `formulations`: the equations of motion that a scheme steps, with one of two choices of velocity (`FORMULATIONS`).
- `increments`: vectors, poses and the exponential map of SO(3) x R^3 and of SE(3), written for plain tuples.

Imports run from `one_step` to `formulations` to `increments`. Of the rest of the package only `scene`, `trajectory` and
`inertia` are imported.
"""
