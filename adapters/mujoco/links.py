"""Write a body of links as MuJoCo's XML: the inertia of the first link, and the others as bodies without a joint in it."""

from collections.abc import Sequence

from bodycheck.adapters.links import Link
from bodycheck.adapters.mujoco.contact import numbers_written, written


def inertial(link: Link) -> str:
    """Return the XML element of a link's inertia."""
    place = {"pos": numbers_written(*link.center_of_mass), "mass": numbers_written(link.mass)}
    return f"<inertial {written(place | {'fullinertia': numbers_written(*link.inertia)})}/>"


def welded(links: Sequence[Link]) -> str:
    """Return the XML elements of links that are welded to the body around them, in whose frame their frames are."""
    places = ({"pos": numbers_written(*link.position), "quat": numbers_written(*link.quaternion)} for link in links)
    return "\n      ".join(f"<body {written(place)}>{inertial(link)}</body>" for place, link in zip(places, links, strict=True))
