"""Links that are fixed to one another, of which one has an inertia that no body has."""

from pathlib import Path

import numpy as np
import pytest

from bodycheck import CaseFaults, load
from bodycheck.casefile.content import Case
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.mechanisms.start import mass_matrix

LINK = """<link name="{}"><inertial><origin xyz="{}"/><mass value="{}"/>
<inertia ixx="{}" iyy="{}" izz="{}" ixy="{}" ixz="0" iyz="0"/></inertial></link>
"""
JOINT = """<joint name="{}" type="{}"><parent link="{}"/><child link="{}"/><origin xyz="{}" rpy="{}"/>
<axis xyz="0 1 0"/></joint>
"""

#: The moments of the arm, of the tool on it, and of the sensor on the world, and a product of inertia of each.
ARM, TOOL, SENSOR = (0.3, 0.2, 0.25, 0.01), (0.002, 0.003, 0.009, 0.0), (0.1, -0.1, 0.1, 0.0)
NOTHING = (0.0, 0.0, 0.0, 0.0)


def robot(
    folder: Path,
    arm: tuple[float, ...] = ARM,
    tool: tuple[float, ...] = TOOL,
    sensor: tuple[float, ...] = NOTHING,
    base: str = "fixed",
) -> Case:
    """A robot with an arm, a tool that is fixed to it a quarter turn about x away, a finger on the tool, and a sensor."""
    parts = [
        '<link name="base"/>',
        LINK.format("sensor", "0 0 0.1", 0.2, *sensor),
        LINK.format("arm", "0.1 0 0.2", 2.0, *arm),
        LINK.format("tool", "0 0.02 0", 0.5, *tool),
        LINK.format("finger", "0 0 0.1", 0.1, 0.01, 0.01, 0.01, 0.0),
        JOINT.format("mount", "fixed", "base", "sensor", "0.3 0 0", "0 0 0"),
        JOINT.format("swing", "continuous", "base", "arm", "0 0 0", "0.3 0 0"),
        JOINT.format("flange", "fixed", "arm", "tool", "0 0.1 0.4", "1.5707963267948966 0 0"),
        JOINT.format("bend", "continuous", "tool", "finger", "0 0.05 0.1", "0 0.2 0"),
    ]
    (folder / "robot.urdf").write_text(f'<robot name="robot">{"".join(parts)}</robot>')
    (folder / "robot.case.toml").write_text(
        f'format = 2\nname = "robot"\ntitle = "A robot."\n[model]\nfile = "robot.urdf"\nbase = "{base}"\n'
        "[scene]\ngravity = 9.81\n[run]\nduration = 0.1\nsamples = 2\n[initial.joints.swing]\nposition = 0.4\nvelocity = 1.5\n"
        "[initial.joints.bend]\nposition = -0.7\nvelocity = 2.0\n"
    )
    return load(folder / "robot.case.toml")


def scene(case: Case) -> Mechanism:
    assert isinstance(case.scene, Mechanism)
    return case.scene


def test_fixed_links_are_one_body_where_one_alone_is_impossible(tmp_path: Path) -> None:
    """The moments of the tool move to the arm, whose axes they have after the quarter turn; its mass stays where it is.

    Roundings of doubles, and of the quarter turn, are allowed.
    """
    case = robot(tmp_path)
    x, y, z, product = ARM
    same = robot(tmp_path, (x + TOOL[0], y + TOOL[2], z + TOOL[1], product), NOTHING)
    assert [body.name for body in scene(case).bodies] == ["sensor", "arm:rigid", "finger"]
    assert [body.name for body in scene(same).bodies] == ["sensor", "arm", "tool", "finger"]
    one, other = (mass_matrix(scene(each))[1].astype(float) for each in (case, same))
    np.testing.assert_allclose(one, other, rtol=1e-14)
    assert case.robot is not None
    assert any(
        "1 link (line 5) has an inertia that no body has, and is read as one body with the links that it is fixed to, which is "
        "possible: tool (no moment may exceed the sum of the other two; the largest does by 0.004 kg m^2)." in notice
        for notice in case.robot.notices
    ), case.robot.notices


def test_links_that_are_impossible_together_stay_a_fault(tmp_path: Path) -> None:
    with pytest.raises(CaseFaults, match=r"body 'tool'.*the largest does by 9 "):
        robot(tmp_path, tool=(1.0, 1.0, 11.0, 0.0))
    with pytest.raises(CaseFaults, match="body 'arm'"):
        robot(tmp_path, arm=(0.3, 5.2, 0.25, 0.01))


def test_the_inertia_of_a_link_on_the_world_does_not_act(tmp_path: Path) -> None:
    case = robot(tmp_path, tool=NOTHING, sensor=SENSOR)
    same = robot(tmp_path, tool=NOTHING)
    assert [body.name for body in scene(case).bodies] == ["arm", "tool", "finger"]
    one, other = (mass_matrix(scene(each))[1].astype(float) for each in (case, same))
    np.testing.assert_array_equal(one, other)
    assert case.robot is not None
    assert any("fixed to the world, where inertia does not act: sensor (its smallest" in text for text in case.robot.notices)
    with pytest.raises(CaseFaults, match=r"body 'sensor'.*none may be negative"):
        robot(tmp_path, tool=NOTHING, sensor=SENSOR, base="free")
