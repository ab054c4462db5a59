"""What all adapters with contacts ask of a scene with a plane: that one body with a flat face lies on it."""

from bodycheck.adapters.contract import SceneUnsupported
from bodycheck.reference.errors import NotFlat
from bodycheck.reference.planar import describe_shape, planar_state
from bodycheck.reference.scene import Brick, Cylinder, Scene


def unsupported(scene: Scene) -> str | None:
    """Return what no adapter models of a scene with a plane, as a noun phrase; None if there is nothing."""
    if scene.drag:
        return "drag together with contact"
    try:
        planar_state(scene)
    except NotFlat as error:
        return f"this contact: {error}"
    return None


def lying_shape(scene: Scene) -> Brick | Cylinder:
    """Return the shape of a body that lies flat on the plane z = 0. Raises `SceneUnsupported` for all other scenes."""
    if (reason := unsupported(scene)) is not None:
        raise SceneUnsupported(reason)
    shape = scene.body.shape
    if not isinstance(shape, Brick | Cylinder):
        raise SceneUnsupported(f"{describe_shape(shape)} has no face to lie on")
    return shape
