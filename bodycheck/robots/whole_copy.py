"""Write the copy of a robot model from which an engine runs the whole scene: with contacts, actuators, tendons and keyframes.

The file comes from a stranger: the copy contains the files that the original includes, and beside it are the meshes of shapes
and the height fields, which must be in the folder of the model or in those of packages. Nothing is converted.
"""

from collections.abc import Sequence
from pathlib import Path

from bodycheck.adapters.robot_reading import RobotFile
from bodycheck.files import writing
from bodycheck.robots import elements, mjcf_copy, mjcf_meshes, repetition
from bodycheck.robots.checked import sources, written
from bodycheck.robots.elements import Element
from bodycheck.robots.named_files import Folders, Removed, folders, local

#: The elements of a URDF that engines do not need for a motion, and that may name files.
UNWANTED = {"visual", "material", "texture", "plugin", "gazebo", "transmission", "sensor"}


def copied(path: Path, packages: Sequence[Path], into: Path) -> tuple[RobotFile, dict[int, str]]:
    """Write the copy of a robot model, URDF or MJCF, into an empty folder, and return it with the origin of its lines.

    The origin is the file and the line of the element that starts at a line of the copy, as in `robot.xml:12`.

    Raises `BadInput` if the file is no robot model, needs a plug-in, stands for too many parts, or names a file that cannot be
    read or is outside the folders, and `NotWritten`.
    """
    root = elements.read(path)
    allowed = folders(path, packages)
    match root.tag:
        case "robot":
            _prepare_urdf(root, allowed, into)
            copy = RobotFile(str(into / "robot.urdf"), "urdf")
        case "mujoco":
            mjcf_copy.prepare(root, allowed, into, Removed(), mjcf_meshes.WHOLE)
            repetition.check(root)
            copy = RobotFile(str(into / "robot.xml"), "mjcf")
        case _:
            elements.refuse_root(root)
    writing.write(Path(copy.path), written(root))
    return copy, sources(root)


def _prepare_urdf(root: Element, allowed: Folders, into: Path) -> None:
    """Remove what does not act from a URDF, and copy the meshes of its collision shapes."""
    room = mjcf_meshes.MAX_BYTES
    for element in root.everything():
        element.children = [child for child in element.children if local(child.tag) not in UNWANTED]
    for count, mesh in enumerate(element for element in root.everything() if element.tag == "mesh"):
        name = mesh.attributes.get("filename", "")
        data, suffix = mjcf_meshes.content(mesh, name, (allowed.home,), allowed, room, mjcf_meshes.WHOLE.what)
        room -= len(data)
        mesh.attributes["filename"] = f"mesh-{count}{suffix}"
        writing.write(into / mesh.attributes["filename"], data)
