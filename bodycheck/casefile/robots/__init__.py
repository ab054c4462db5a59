"""Robot models, URDF and MJCF, for cases: one body, or all bodies and joints as tables.

A robot model comes from a stranger and is data: `bodycheck.robots.elements` reads it, and it may name files only in folders
that the user named. `reading` has the result of reading a whole model, by `urdf.tree` or `mjcf.tree`. `urdf.link` and
`mjcf.link` read one body. `direct` makes the case that a robot's file is by itself.
"""
