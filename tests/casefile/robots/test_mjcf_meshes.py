"""Meshes in files carry mass and inertia as in MuJoCo, and files of strangers cannot make us read without bound."""

import struct
from itertools import pairwise
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest

from bodycheck.casefile.robots.mjcf import mesh_files
from bodycheck.casefile.robots.mjcf.mesh_files import triangles
from bodycheck.errors import BadInput

mujoco: Any = pytest.importorskip("mujoco")

from tests.support.mjcf_readers import TREE_ALONE, disagreement, read_file  # noqa: E402  (needs MuJoCo)

#: MuJoCo stops the search of principal axes at a rotation of 1.4e-6 rad.
COARSE_ROUNDING = 3e-6

#: The corners of a wedge, and its faces as polygons with their corners counted from 1.
CORNERS = ((0, 0, 0), (1.1, 0, 0), (1, 2.3, 0), (0, 2, 0), (0, 0, 3.7), (1, 0, 3))
POLYGONS = ((1, 4, 3, 2), (1, 2, 6, 5), (5, 6, 3, 4), (1, 5, 4), (2, 3, 6))


def faces() -> list[tuple[int, int, int]]:
    return [(polygon[0], one, other) for polygon in POLYGONS for one, other in pairwise(polygon[1:])]


def stl() -> bytes:
    records = b"".join(
        struct.pack("<12fH", 0, 0, 0, *(part for corner in face for part in CORNERS[corner - 1]), 0) for face in faces()
    )
    return bytes(80) + struct.pack("<I", len(faces())) + records


def stl_text() -> bytes:
    lines = ["solid wedge"]
    for face in faces():
        lines += [
            "facet normal 0 0 0",
            "outer loop",
            *(f"vertex {' '.join(map(repr, CORNERS[corner - 1]))}" for corner in face),
        ]
        lines += ["endloop", "endfacet"]
    return "\n".join([*lines, "endsolid wedge"]).encode()


def obj() -> bytes:
    lines = ["mtllib wedge.mtl", "o wedge", *(f"v {' '.join(map(repr, corner))}" for corner in CORNERS)]
    lines += [f"f {' '.join(str(corner) + '//' for corner in polygon)}" for polygon in POLYGONS[:3]]
    lines += [f"f {' '.join(str(corner - 1 - len(CORNERS)) for corner in polygon)}" for polygon in POLYGONS[3:]]
    return "\n".join([*lines, "o other", "v 0 0 0", "v 9 0 0", "v 0 9 0", "f 7 8 9"]).encode()


def msh() -> bytes:
    corners = [float(part) for corner in CORNERS for part in corner]
    indices = [corner - 1 for face in faces() for corner in face]
    count = len(CORNERS)
    head = struct.pack("<4i", count, count, count, len(faces()))
    return head + struct.pack(f"<{3 * count}f", *corners) + bytes(20 * count) + struct.pack(f"<{len(indices)}i", *indices)


@pytest.mark.parametrize(("name", "content"), [("m.stl", stl()), ("m.STL", stl()), ("m.obj", obj()), ("m.msh", msh())])
def test_a_mesh_in_a_file_is_that_of_mujoco(tmp_path: Path, name: str, content: bytes) -> None:
    path = tmp_path / "robot.xml"
    (tmp_path / "meshes").mkdir()
    (tmp_path / "meshes" / name).write_bytes(content)
    path.write_text(
        f'<mujoco><compiler meshdir="meshes"/><asset><mesh file="{name}" scale="0.5 1 2"/></asset><worldbody><body name="a">'
        '<joint axis="1 0 0"/><joint axis="0 1 1"/><geom type="mesh" mesh="m" pos="1 0 0"/></body></worldbody></mujoco>'
    )
    differences = disagreement(read_file(path, ignore=TREE_ALONE), mujoco.MjModel.from_xml_path(str(path)))
    assert max(differences.values()) < COARSE_ROUNDING


def test_a_text_of_triangles_is_read_as_their_binary_form() -> None:
    one, other = triangles(stl(), ".stl"), triangles(stl_text(), ".stl")
    np.testing.assert_array_equal(one.corners, other.corners)
    np.testing.assert_array_equal(one.faces, other.faces)


def test_a_mesh_that_carries_no_mass_need_not_be_there(tmp_path: Path) -> None:
    path = tmp_path / "robot.xml"
    inside = (
        '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/><geom type="mesh" mesh="m"/><geom type="mesh" mesh="m" mass="0"/>'
    )
    text = f'<mujoco><asset><mesh file="m.stl"/></asset><worldbody><body><joint/>{inside}</body></worldbody></mujoco>'
    path.write_text(text)
    assert read_file(path).tables["bodies"][0]["mass"] == 1.0
    path.write_text(text.replace('<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>', ""))
    with pytest.raises(BadInput, match=r"robot.xml:1: <mesh file>: 'm.stl' is not there"):
        read_file(path)


def test_meshes_of_strangers_have_limits(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mesh_files, "MAX_TRIANGLES", 7)
    for suffix, content in ((".stl", stl()), (".stl", stl_text()), (".obj", obj()), (".msh", msh())):
        with pytest.raises(BadInput, match="has more than 7 triangles"):
            triangles(content, suffix)
    many = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf " + "1 2 3 " * 100
    with pytest.raises(BadInput, match="has more than 7 triangles"):
        triangles(many.encode(), ".obj")
    with pytest.raises(BadInput, match="has more than 7 triangles"):
        mesh_files.of_numbers(range(30), [0.0, 1.0, 2.0] * 8)
    with pytest.raises(BadInput, match="is no STL, OBJ or MSH file"):
        triangles(b"", ".dae")


@pytest.mark.parametrize(("suffix", "content"), [(".stl", stl()), (".stl", stl_text()), (".obj", obj()), (".msh", msh())])
def test_a_damaged_mesh_is_a_mesh_or_a_fault(suffix: str, content: bytes) -> None:
    chance = Random(7)
    for _ in range(100):
        damaged = bytearray(content[: chance.choice([len(content), chance.randrange(len(content))])])
        for _ in range(chance.randrange(4)):
            if damaged:
                damaged[chance.randrange(len(damaged))] = chance.randrange(256)
        try:
            mesh = triangles(bytes(damaged), suffix)
        except BadInput:
            continue
        assert np.isfinite(mesh.corners).all()
        assert not len(mesh.faces) or mesh.faces.max() < len(mesh.corners)


@pytest.mark.parametrize(
    ("corners", "faces", "words"),
    [
        ([0.0] * 4, [], "states no mesh"),
        ([0.0] * 12, [0.0, 1.0], "states no mesh"),
        ([0.0] * 12, [0.0, 1.0, 1.5], "states no mesh"),
        ([0.0] * 12, [0.0, 1.0, 4.0], "has a triangle without all of its corners"),
        ([0.0] * 12, [0.0, 1.0, 1e99], "has a triangle without all of its corners"),
        ([1e50] * 12, [], "has a coordinate that is not finite"),
    ],
)
def test_what_is_no_mesh(corners: list[float], faces: list[float], words: str) -> None:
    with pytest.raises(BadInput, match=words):
        mesh_files.of_numbers(corners, faces)
