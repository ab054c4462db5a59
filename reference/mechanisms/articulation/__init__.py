"""The articulated-body recursion in any arithmetic: accelerations of a tree of links, joints that follow others included.

`articulated` has the recursion, `spatial` its vectors and matrices, and `coupling` the coordinates that several joints share.
`nudges` measures the growth of an error along motions by it.
"""
