"""Write bodies on joints that touch free bodies, such as fingers that hold a body, as MuJoCo's XML.

The bodies and joints are those of `mechanism_xml`, and the contacts those of `touching`: an element `pair` for each pair that
touches. `mechanisms` steps them.
"""

from bodycheck.adapters.contract import Method, SceneUnsupported
from bodycheck.adapters.mujoco import touching
from bodycheck.adapters.mujoco.mechanism_xml import add_bodies
from bodycheck.reference.mechanisms.exact import nearest_inertia
from bodycheck.reference.mechanisms.mechanism import Mechanism, shape_of

#: The requirements of bodies on joints that touch others.
MODELS = frozenset({"contacts of bodies on joints"})


def document(mechanism: Mechanism, method: Method) -> str:
    """Return MuJoCo's XML of a mechanism of which bodies touch. Raises `SceneUnsupported`."""
    root, world = touching.surrounded(mechanism, method)
    elements = add_bodies(world, mechanism, {joint.name: {} for joint in mechanism.joints})
    for index in sorted({index for pair in mechanism.contacts for index in pair.bodies}):
        body = mechanism.bodies[index]
        shape = shape_of(body)
        if shape is None:
            raise SceneUnsupported(f"the body {body.name}, which has no shape and touches others")
        touching.add_geom(elements[index], index, shape, nearest_inertia(body).centre)
    return touching.written(root)
