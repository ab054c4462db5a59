"""Exceptions of the reference: the scenes it has no model of, and the motions it cannot compute.

Results show the text of these exceptions in their column `reason`, so each text must make sense on its own. Invalid arguments
raise `ValueError`.
"""


class NotModelled(Exception):
    """The reference has no model of something that the scene contains; the text names it."""


class OutOfReach(Exception):
    """The reference cannot compute this motion, or not in a reasonable number of steps; the text says why."""


class NotFlat(Exception):
    """The body does not lie flat on the plane, or has no face to lie on; the text lists what is wrong."""


class WouldTip(Exception):
    """A balanced pressure would have to be negative somewhere, so the body tips instead of sliding; the text says where."""
