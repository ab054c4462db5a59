"""One body of a robot model, URDF or MJCF, as the text of a case file.

A robot model comes from a stranger and is data: it is read by `bodycheck.robots.elements`, and no file that it names is opened.
`urdf` and `mjcf` read the body; `template` writes it into a case.
"""
