"""Proofs of the motion of trees of links, by polynomials near to it, and of their rest.

- `tree`: the links, from a mechanism. `dynamics`: the efforts that a motion needs, and the poses. `derivatives`: of these
  efforts.
- `polynomials` and `flow`: polynomials near to the motion and to the motions beside it, which prove nothing.
- `defects`: how far the motion is from them in a step. `validated`: the whole motion, step by step.
- `rest`: whether dry friction holds a tree.
"""
