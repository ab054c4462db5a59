"""The table of joint types: what kinematics, the grammar and the reading of models rely on."""

import ast
from pathlib import Path
from typing import get_args

import pytest

from bodycheck.reference.mechanisms import lagrangian
from bodycheck.reference.mechanisms.joint_types import JOINT_TYPES, JointForm, JointType
from bodycheck.reference.mechanisms.loops import body_space

EVERY = pytest.mark.parametrize("form", JOINT_TYPES.values(), ids=JOINT_TYPES)

#: The modules of the witnesses, which share no decision about joints with the ways that they check.
WITNESSES = [*Path(lagrangian.__path__[0]).glob("*.py"), Path(body_space.__file__)]


def test_type_checkers_know_every_type() -> None:
    assert get_args(JointType) == tuple(JOINT_TYPES)


@EVERY
def test_slides_come_before_turns(form: JointForm) -> None:
    """Otherwise a turn would move what slides have moved, which neither `kinematics` nor `start` reckons with."""
    assert form.motions == (*form.slides, *form.turns)


@EVERY
def test_a_file_gives_every_coordinate_and_velocity_once(form: JointForm) -> None:
    if form.start is None:
        assert not form.motions
        return
    sizes = {key.name: max(key.size, 1) for key in form.start.keys}
    assert sum(sizes[name] for name in form.start.position) == len(form.coordinates)
    assert sum(sizes[name] for name in form.start.velocity) == len(form.velocities)
    assert sorted((*form.start.position, *form.start.velocity)) == sorted(sizes)


def test_a_joint_of_a_model_has_one_type() -> None:
    for names in ([form.robot for form in JOINT_TYPES.values()], [form.mjcf for form in JOINT_TYPES.values()]):
        read = [name for name in names if name is not None]
        assert len(set(read)) == len(read)


@pytest.mark.parametrize("path", WITNESSES, ids=lambda path: path.stem)
def test_a_witness_does_not_read_the_table(path: Path) -> None:
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.ImportFrom):
            assert node.module != JointForm.__module__
        assert not (isinstance(node, ast.Attribute) and node.attr == "form")
