"""A URDF as a case against the same file as the comparison of robot models reads it: two readers, and two ways to its terms."""

from dataclasses import replace
from pathlib import Path
from typing import Literal

import numpy as np
import pytest

from bodycheck.casefile.robots.direct import scene_of_robot
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.robots.dynamics import terms_at, velocity_labels
from bodycheck.reference.robots.states import seeded_states
from bodycheck.robots import urdf
from bodycheck.robots.from_mechanism import robot_model
from tests.support.robot_cases import URDF

#: Several links without mass, of which some move, a mimic chain, inertia without mass, and names of all kinds.
LINK = (
    '<link name="{name}"><inertial><origin xyz="{x} 0.1 -0.2" rpy="{x} 0.4 1"/><mass value="1.5"/>'
    '<inertia ixx="0.1" iyy="0.2" izz="0.25" ixy="0.01" ixz="0" iyz="-0.02"/></inertial></link>'
)
WEIGHTLESS = '<inertial><mass value="0"/><inertia ixx="0.01" iyy="0.02" izz="0.03" ixy="0.001" ixz="0" iyz="0"/></inertial>'
CHAIN = (
    '<robot name="chain">'
    + "".join(LINK.format(name=name, x=index / 7) for index, name in enumerate(("world", "8", "left knee", "größe")))
    + f'<link name="between"/><link name="frame"/><link name="sole">{WEIGHTLESS}</link>'
    + "".join(
        f'<joint name="{child}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="0.1 {index} 0.3" rpy="0.2 {index} -1"/><axis xyz="1 {index} 2"/><dynamics damping="0.{index}"/>{more}'
        "</joint>"
        for index, (parent, child, kind, more) in enumerate(
            [
                ("world", "8", "continuous", ""),
                ("8", "between", "continuous", '<mimic joint="8" multiplier="-0.5" offset="0.3"/>'),
                ("between", "left knee", "prismatic", '<limit effort="1" velocity="1" lower="-1" upper="1"/>'),
                ("left knee", "frame", "fixed", ""),
                ("frame", "größe", "continuous", '<mimic joint="between" multiplier="3"/>'),
                ("frame", "sole", "fixed", ""),
            ]
        )
    )
    + "</robot>"
)


def disagreement(folder: Path, text: str, read_as: str, base: Literal["fixed", "free"]) -> float:
    """Return the largest difference of terms of a URDF and of a case, relative to the largest entry of each term.

    text: the file that the case is made of. read_as: the same file for the other reader.
    """
    (folder / "robot.urdf").write_text(text)
    scene = scene_of_robot(folder / "robot.urdf", base=base).scene
    assert isinstance(scene, Mechanism)
    model, own = urdf.read(read_as.encode(), "robot.urdf").model, robot_model(scene, "robot")
    assert model is not None
    states = seeded_states(model, 3, 1)
    still = [
        replace(
            state,
            positions={**state.positions, "base": (0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)},
            **{part: {**getattr(state, part), "base": (0.0,) * 6} for part in ("velocities", "accelerations", "efforts")},
        )
        for state in states
    ]
    order = [velocity_labels(own).index(label) for label in velocity_labels(model)]
    worst = 0.0
    for expected, read in zip(terms_at(model, states, (0, 0, -9.81)), terms_at(own, still, (0, 0, -9.81)), strict=True):
        for name in ("mass_matrix", "gravity_force", "coriolis_force", "passive_force"):
            one, other = getattr(expected, name), getattr(read, name)[order]
            other = other[:, order] if other.ndim == 2 else other
            worst = max(worst, float(np.abs(one - other).max() / np.abs(one).max()))
    return worst


@pytest.mark.parametrize("base", ["fixed", "free"])
@pytest.mark.parametrize("text", [URDF, CHAIN], ids=["arm", "chain"])
def test_both_readers_agree(tmp_path: Path, text: str, base: Literal["fixed", "free"]) -> None:
    """The numbers of a case are rounded once to doubles, so that some roundings are allowed."""
    assert disagreement(tmp_path, text, text, base) < 1e-14


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('ixy="0.01"', 'ixy="-0.01"'),
        ('rpy="0.2 1 -1"', 'rpy="0.2 1 1"'),
        ('axis xyz="1 4 2"', 'axis xyz="1 4 -2"'),
        ('damping="0.2"', 'damping="0.3"'),
        ('value="1.5"', 'value="1.6"'),
        ('ixx="0.01"', 'ixx="0.011"'),
        ('xyz="0.1 3 0.3"', 'xyz="0.1 3.1 0.3"'),
    ],
)
def test_a_planted_fault_of_reading_is_found(tmp_path: Path, old: str, new: str) -> None:
    assert old in CHAIN
    assert disagreement(tmp_path, CHAIN.replace(old, new), CHAIN, "free") > 1e-5
