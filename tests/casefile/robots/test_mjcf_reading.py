"""MJCF files are read for a case as MuJoCo reads them: the same masses, poses, forces, starts and limits."""

from random import Random
from typing import Any

import hypothesis
import numpy as np
import pytest
from hypothesis import strategies as st

from bodycheck.casefile.robots.mjcf import (
    file,
    geoms,
    inertia,
    joints,
    meshes,
    options,
    parts,
    settings,
    solids,
    springs,
    tree,
)
from bodycheck.casefile.robots.reading import Read
from bodycheck.casefile.robots.tables import HERE
from bodycheck.errors import BadInput
from bodycheck.reference.exact.numbers import MP
from bodycheck.reference.exact.rotations import IDENTITY, ORIGIN
from bodycheck.robots.orientations import turned_inertia
from tests.support.mjcf_texts import MESHES, RULES, model, random_text

mujoco: Any = pytest.importorskip("mujoco")

from tests.support.mjcf_readers import TREE_ALONE, disagreement, read_text  # noqa: E402  (needs MuJoCo)

#: MuJoCo's types of slides and hinges.
SINGLE = (2, 3)

#: Relative to the largest entry, for the rounding of a few products of matrices in double precision.
ROUNDING = 1e-12

#: MuJoCo's compiler ends its search for the principal axes of a mesh at a rotation of 1.4e-6 rad.
COARSE_ROUNDING = 3e-6

#: MuJoCo takes the bounds of a mesh from corners in single precision.
MESH_ROUNDING = 3e-7


def compared(text: str) -> dict[str, float]:
    """Return the differences of a text as a case reads it from MuJoCo, with those of starts and limits."""
    read, compiled = read_text(text, ignore=TREE_ALONE), mujoco.MjModel.from_xml_string(text)
    differences = disagreement(read, compiled)
    differences["start"] = np.abs(_start(read) - compiled.qpos0).max() if compiled.nq else 0.0
    return differences | {"limits": _limits(read, compiled), "friction": _friction(read, compiled)}


def _start(read: Read) -> Any:
    """Return the coordinates at the start, with the sign of quaternions by which MuJoCo has a positive w."""
    values: list[float] = []
    for joint in read.tables["joints"]:
        initial = joint.get("initial", {})
        match joint["type"]:
            case "revolute" | "prismatic":
                values.append(initial.get("position", 0.0))
            case "spherical":
                values += initial.get("quaternion", [1.0, 0.0, 0.0, 0.0])
            case "free":
                values += [*initial["position"], *initial["quaternion"]]
    return np.array(values)


def _limits(read: Read, compiled: Any) -> float:
    """Return the largest difference of a limit; infinity if other joints are limited."""
    moving = [joint["name"] for joint in read.tables["joints"] if joint["type"] != "fixed"]
    limited = {
        moving[index]: compiled.jnt_range[index]
        for index in range(compiled.njnt)
        if compiled.jnt_limited[index] and compiled.jnt_type[index] in SINGLE
    }
    if [each.name for each in read.ranges] != list(limited):
        return np.inf
    ends = [
        abs(end - there)
        for each in read.ranges
        for end, there in zip((each.lower, each.upper), limited[each.name], strict=True)
    ]
    return max(ends, default=0.0)


def _friction(read: Read, compiled: Any) -> float:
    own = [joint.get("friction", 0.0) for joint in read.tables["joints"] if joint["type"] in ("revolute", "prismatic")]
    single = [compiled.jnt_dofadr[index] for index in range(compiled.njnt) if compiled.jnt_type[index] in SINGLE]
    return float(np.abs(np.array(own) - compiled.dof_frictionloss[single]).max(initial=0.0))


@pytest.mark.parametrize("rule", RULES)
def test_each_rule_is_that_of_mujoco(rule: str) -> None:
    assert max(compared(RULES[rule]).values()) < ROUNDING


@pytest.mark.parametrize("rule", MESHES)
def test_each_rule_of_meshes_is_that_of_mujoco(rule: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """To rounding along the axes that MuJoCo's compiler has, and with exact axes as far as those are exact."""
    assert max(compared(MESHES[rule]).values()) < COARSE_ROUNDING
    turn = mujoco.MjModel.from_xml_string(MESHES[rule]).mesh_quat[0].tolist()

    def axes(components: Any) -> Any:
        w, x, y, z = map(MP.mpf, turn)
        a, b, c, *_ = turned_inertia(components, (w, -x, -y, -z))
        return (a, b, c), (w, x, y, z)

    monkeypatch.setattr(meshes, "principal_axes", axes)
    assert max(compared(MESHES[rule]).values()) < (MESH_ROUNDING if "bounds" in rule else ROUNDING)


def test_the_shell_of_an_ellipsoid_is_that_of_mujoco() -> None:
    """MuJoCo computes it as the difference of two ellipsoids that differ by 1e-6 m, whose roundings are parts of 1e-9 of it."""
    geom = '<geom type="ellipsoid" size="1 2 3" shellinertia="true"/>'
    assert max(compared(model(f"<joint/>{geom}")).values()) < 1e-8


@hypothesis.settings(max_examples=25, deadline=None)
@hypothesis.given(st.integers(0, 10**6))
def test_random_files_are_read_as_by_mujoco(seed: int) -> None:
    text = random_text(Random(seed))
    try:
        mujoco.MjModel.from_xml_string(text)
    except ValueError:  # such as a ball that a turn follows
        return
    assert max(compared(text).values()) < ROUNDING


#: A fault in each rule: the text that shows it, what is replaced, and by what.
FAULTS: dict[str, tuple[str, Any, str, Any]] = {
    "anchors": ("several joints", joints, "anchor", lambda part: ORIGIN),
    "references": ("reference", joints, "displacement", lambda kind, axis, coordinate: HERE),
    "degrees": ("reference", settings.Settings, "angle", lambda self, value: value),
    "limits in degrees": ("radian", settings.Settings, "angle", lambda self, value: value * 2),
    "frames": ("frames", parts, "pose_of", lambda element, rules: HERE),
    "alignment": ("aligned", tree, "_aligned", lambda joint, parts, read: False),
    "carried moments": ("moments without mass", tree, "_carry", lambda *_: None),
    "total mass": ("total mass", tree, "_scale", lambda read: None),
    "bounds": ("smallest moment", inertia, "_bounded", lambda mass_properties, rules: mass_properties),
    "balance": ("balance", inertia, "_bounded", lambda mass_properties, rules: mass_properties),
    "groups": ("groups", settings.Settings, "counts", lambda self, group: True),
    "tiny volumes": ("tiny geoms", geoms, "NO_VOLUME", 0.0),
    "density": ("box", geoms, "DENSITY", 999.0),
    "shells": (
        "cylinder shell",
        solids,
        "moments",
        lambda kind, sizes, shell, right=solids.moments: right(kind, sizes, False),
    ),
    "springs and dampers": ("spring and damper", tree, "set_springs", lambda tree: None),
    "inertia of springs": ("spring and damper", springs, "_position", lambda joint: (0.0,)),
    "attitudes": ("frames", settings, "from_z", lambda z: IDENTITY),
    "flags": ("no springs", options, "FLAGS", {}),
    "replicas": ("replicas", file, "turned", lambda turn, vector: vector),
    "classes": (
        "classes",
        settings.Defaults,
        "resolved",
        lambda self, element, name, right=settings.Defaults.resolved: right(self, element, None),
    ),
    "frames of meshes": ("mesh moved", meshes, "_placed", lambda mesh, corners: corners),
    "rule of meshes": (
        "mesh not convex",
        meshes,
        "_extents",
        lambda normals, areas, arms, rule, right=meshes._extents: right(normals, areas, arms, "exact"),
    ),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_in_a_rule_is_found(fault: str, monkeypatch: pytest.MonkeyPatch) -> None:
    rule, place, name, wrong = FAULTS[fault]
    monkeypatch.setattr(place, name, wrong)
    try:
        worst = max(compared((RULES | MESHES)[rule]).values())
    except (AssertionError, BadInput):
        return
    assert worst > 10 * COARSE_ROUNDING
