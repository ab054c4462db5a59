"""Write the copy of a robot model in which MuJoCo looks for contacts, with the meshes of its shapes beside it.

The file comes from a stranger: the copy of a URDF has only links, their inertia and collision shapes, and joints. Its root link
floats, so that MuJoCo takes the root and its neighbours for parent and child, as it does for all other links. A small mesh
stands in for each mesh that cannot be copied.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from bodycheck.adapters.robot_reading import RobotFile
from bodycheck.errors import BadInput
from bodycheck.files import writing
from bodycheck.robots import elements, mjcf_copy, mjcf_meshes
from bodycheck.robots.checked import written
from bodycheck.robots.elements import Element
from bodycheck.robots.mjcf_assembly import tops_of
from bodycheck.robots.named_files import Folders, Removed, folders

#: The elements of links and joints of a URDF that the copy keeps.
KEPT = {"link": ("inertial", "collision"), "joint": ("origin", "parent", "child", "axis", "limit")}

#: The name of the link to which the copy of a URDF joins the root, which MuJoCo takes for its world, and the name of the joint
#: if the base of the robot is fixed.
WORLD, BASE = "world", "bodycheck's base"

#: Settings of MuJoCo's compiler: links keep their names, and links without mass or with an impossible inertia may move.
COMPILER = {"fusestatic": "false", "boundmass": "1e-6", "boundinertia": "1e-9", "balanceinertia": "true"}


#: The content of the OBJ file that stands in for a mesh of a URDF: a tetrahedron.
STAND_IN = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"


@dataclass(frozen=True)
class TouchingCopy:
    """The copy of a robot model.

    file: the copy. absent: the names of the meshes in it that stand in for others, which cannot be copied, each with the
    reason.
    """

    file: RobotFile
    absent: Mapping[str, str]


def copied(path: Path, packages: Sequence[Path], into: Path, base: str | None) -> TouchingCopy:
    """Write the copy of a robot model, URDF or MJCF, into an empty folder, and return it.

    base: the name of the joint by which the root link floats; None if it is fixed.

    Raises `BadInput` if a file is included that is not inside the folder of the model or those of packages, and `NotWritten`.
    """
    absent: dict[str, str] = {}
    root = elements.read(path)
    allowed = folders(path, packages)
    match root.tag:
        case "robot":
            _prepare_urdf(root, allowed, into, base or BASE, absent)
            copy = RobotFile(str(into / "robot.urdf"), "urdf")
        case "mujoco":
            mjcf_copy.prepare(root, allowed, into, Removed(), mjcf_meshes.TOUCHING, absent)
            root.children = [child for child in root.children if child.tag != "keyframe"]  # it may have no values for the base
            if base is not None:
                _float(root, base)
            copy = RobotFile(str(into / "robot.xml"), "mjcf")
        case _:
            elements.refuse_root(root)
    writing.write(Path(copy.path), written(root))
    return TouchingCopy(copy, absent)


def _float(root: Element, base: str) -> None:
    """Give the one body in the world of an MJCF file a free joint of a name, unless the file has that joint."""
    if not any(joint.attributes.get("name") == base for joint in root.everything() if joint.tag in ("joint", "freejoint")):
        for top in tops_of(root):
            top.children.insert(0, Element("freejoint", {"name": base}, top.file, top.line))


def _prepare_urdf(root: Element, allowed: Folders, into: Path, base: str, absent: dict[str, str]) -> None:
    """Change a URDF into one of the elements that collisions need, and copy the meshes."""
    parts = [child for child in root.children if child.tag in KEPT]
    room = mjcf_meshes.MAX_BYTES
    count = 0
    for part in parts:
        part.children = [child for child in part.children if child.tag in KEPT[part.tag]]
        for mesh in (element for element in part.everything() if element.tag == "mesh"):
            name = mesh.attributes.get("filename", "")
            copy = f"mesh-{count}"  # MuJoCo gives the mesh this name
            try:
                data, suffix = mjcf_meshes.content(mesh, name, (allowed.home,), allowed, room, mjcf_meshes.TOUCHING.what)
            except BadInput as error:
                absent[copy] = str(error)
                data, suffix = STAND_IN, ".obj"
            room -= len(data)
            mesh.attributes["filename"] = copy + suffix
            writing.write(into / mesh.attributes["filename"], data)
            count += 1
    children = {child.attributes.get("link") for part in parts for child in part.all("child")}
    links = [part.attributes.get("name", "") for part in parts if part.tag == "link"]
    top = next((name for name in links if name not in children), WORLD)

    def made(tag: str, attributes: dict[str, str], *inside: Element) -> Element:
        return Element(tag, attributes, root.file, root.line, list(inside))

    root.children = [made("mujoco", {}, made("compiler", COMPILER)), *parts]
    if top != WORLD:
        joined = made("parent", {"link": WORLD}), made("child", {"link": top})
        root.children += [made("link", {"name": WORLD}), made("joint", {"name": base, "type": "floating"}, *joined)]
