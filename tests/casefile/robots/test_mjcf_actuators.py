"""Actuators of MJCF as controllers of a case, against the efforts of MuJoCo itself."""

import math
from typing import Any

import numpy as np
import pytest

from bodycheck.casefile.robots.reading import Read
from bodycheck.errors import BadInput

mujoco: Any = pytest.importorskip("mujoco")

from tests.support.mjcf_readers import read_text  # noqa: E402  (needs MuJoCo)

#: Two bodies: the inertia that moves a joint depends on the other one, and both joints begin elsewhere than at zero.
BODIES = """
<body name="a"><joint name="j" axis="0 1 0" ref="20" range="-30 50" armature="0.02" {}/><geom size="0.1" pos="0.4 0.1 0"/>
<body name="b" pos="1 0 0"><joint name="k" type="slide" axis="1 1 0" ref="0.3" range="-1 2"/><geom size="0.2" pos="0 0.3 0"/>
</body></body>"""

USED = frozenset({"actuators"})


def model(actuators: str, of_joint: str = "", sections: str = "", keyframe: str = "") -> str:
    return (
        f"<mujoco>{sections}<worldbody>{BODIES.format(of_joint)}</worldbody><actuator>{actuators}</actuator>"
        f"{keyframe and f'<keyframe><key {keyframe}/></keyframe>'}</mujoco>"
    )


def effort(table: dict[str, Any], q: float, v: float) -> float:
    """Return the effort of a table of a controller, whose signals are constant, at a state."""
    law = table.get("kp", 0.0) * (table.get("target", 0.0) - q) + table.get("kd", 0.0) * (table.get("target_velocity", 0.0) - v)
    limit = table.get("effort_limit", math.inf)
    return float(np.clip(law + table.get("effort", 0.0), -limit, limit))


def agrees(text: str, control: list[float] | None = None, **choice: Any) -> Read:
    """Assert that the controllers exert the efforts of MuJoCo, and return the result of reading the file."""
    read = read_text(text, use=USED, keyframe=-1, **choice)
    compiled = mujoco.MjModel.from_xml_string(text)
    data, generator = mujoco.MjData(compiled), np.random.default_rng(7)
    tables = {table["joint"]: table for table in read.controllers}
    for scale in (0.1, 1.0, 1.0, 30.0, 30.0):
        data.qpos, data.qvel = generator.normal(size=(2, 2)) * scale
        data.ctrl = 0.0 if control is None else control
        mujoco.mj_forward(compiled, data)
        for index, joint in enumerate(("j", "k")):
            expected = effort(tables[joint], data.qpos[index], data.qvel[index]) if joint in tables else 0.0
            # Sums of a few products of this size, in double precision.
            size = abs(expected) + 1e3 * (1.0 + float(np.max(np.abs(data.qpos)) + np.max(np.abs(data.qvel))))
            assert abs(data.qfrc_actuator[index] - expected) <= 1e-14 * size
    return read


DEFAULTS = """<default><general biastype="affine" gainprm="30" biasprm="1 -30 -2"/><default class="strong"><motor gear="9"/>
<position kp="70" kv="3"/><velocity kv="6"/></default></default>"""


def of_class(attributes: str) -> str:
    """Return the default class "p" of position servos."""
    return f'<default><default class="p"><position {attributes}/></default></default>'


#: Actuators, their control, and further parts of the file.
ACTUATORS: list[tuple[str, float, dict[str, str]]] = [
    ('<motor joint="j" gear="-3"/>', 0.7, {}),
    ('<motor joint="j" gear="3" ctrlrange="-0.5 0.5"/>', 0.7, {}),
    ('<motor joint="j" gear="3" ctrlrange="-0.5 0.5" ctrllimited="false"/>', 0.7, {}),
    ('<motor joint="j" gear="3" ctrlrange="-0.5 0.5"/>', 0.7, {"sections": '<option><flag clampctrl="disable"/></option>'}),
    ('<motor joint="j" gear="3" forcerange="-0.2 0.5"/>', 0.7, {}),
    ('<motor joint="j" ctrlrange="0.5 1"/>', 0.0, {}),
    ('<motor joint="j" forcerange="0.5 1"/>', 0.0, {}),
    ('<motor joint="j" gear="3"/>', 0.7, {"of_joint": 'actuatorfrcrange="-1 2"'}),
    ('<motor joint="j" gear="3"/>', 0.7, {"of_joint": 'actuatorfrcrange="-1 2" actuatorfrclimited="false"'}),
    ('<position joint="j"/>', 0.7, {}),
    ('<position jointinparent="k" kp="50" kv="4" gear="-2"/>', 0.7, {}),
    ('<position joint="j" kp="50" dampratio="1.3"/>', 0.7, {}),
    ('<position joint="j" kp="50" dampratio="1.3" gear="-3"/>', 0.7, {}),
    ('<position joint="k" kp="50" dampratio="0.5" gear="0.5"/>', 0.7, {}),
    ('<position joint="j" kp="50" kv="2" forcerange="-9 9" gear="4"/>', 0.7, {"of_joint": 'actuatorfrcrange="-30 30"'}),
    ('<position joint="j" kp="50" kv="2" forcerange="-9 9" gear="4"/>', 0.7, {"of_joint": 'actuatorfrcrange="-40 40"'}),
    ('<position joint="j" kp="50" inheritrange="0.8"/>', 9.0, {}),
    ('<position joint="k" kp="50" inheritrange="1.2"/>', -9.0, {}),
    ('<position joint="j" kp="50" ctrlrange="0.2 0.3" gear="2"/>', 0.0, {}),
    ('<position joint="j" kp="0"/>', 0.7, {}),
    ('<velocity joint="j" kv="5" gear="2"/>', 0.7, {}),
    ('<velocity joint="k"/>', -0.7, {}),
    ('<damper joint="j" kv="5" ctrlrange="0 2" gear="2"/>', 0.7, {}),
    ('<damper joint="j" kv="5" ctrlrange="0 2" gear="2"/>', -0.7, {}),
    ('<general joint="j" gainprm="5"/>', 0.7, {}),
    ('<general joint="j" gainprm="5" biastype="affine" biasprm="1 -4 -2" gear="2"/>', 0.7, {}),
    ('<general joint="j" gainprm="5" biastype="none" biasprm="1 -4 -2" gear="2"/>', 0.7, {}),
    ('<general joint="j" gaintype="affine" gainprm="5 -1 -3" biastype="affine" biasprm="1 -4 -2"/>', 0.7, {}),
    ('<general joint="j" gainprm="5" biastype="affine" biasprm="0 -5 0.8" gear="2"/>', 0.7, {}),
    ('<general joint="j" gainprm="5" biastype="affine" biasprm="0 -5 -2" inheritrange="1"/>', 5.0, {}),
    ('<general joint="j"/>', 0.7, {"sections": DEFAULTS}),
    ('<motor joint="j"/>', 0.7, {"sections": DEFAULTS}),
    ('<motor joint="j" class="strong"/>', 0.7, {"sections": DEFAULTS}),
    ('<motor joint="j" group="3"/>', 0.7, {"sections": '<option actuatorgroupdisable="1 3"/>'}),
    ('<motor joint="j"/>', 0.7, {"sections": '<option><flag actuation="disable"/></option>'}),
    (
        '<position joint="j" class="p"/>',
        0.7,
        {"sections": '<default><default class="p"><position kp="7" kv="2"/></default></default>'},
    ),
    (
        '<position joint="j" class="p"/>',
        0.7,
        {"sections": '<default><default class="p"><position dampratio="2"/></default></default>'},
    ),
    ('<velocity joint="j"/>', 0.7, {"sections": '<default><velocity kv="8" ctrlrange="-0.1 0.1"/></default>'}),
    ('<position joint="j"/><motor joint="k" gear="5"/>', 0.7, {}),
]


@pytest.mark.parametrize(("actuators", "control", "parts"), ACTUATORS)
def test_a_controller_exerts_the_effort_of_the_actuator(actuators: str, control: float, parts: dict[str, str]) -> None:
    count = actuators.count("/>")
    values = [control] * count
    read = agrees(model(actuators, **parts, keyframe=f'ctrl="{" ".join(map(str, values))}"'), values)
    assert not any(feature.acts for feature in read.features)
    if not control:  # the control is zero without a keyframe too
        agrees(model(actuators, **parts), values)


#: Actuators that are no controllers, their control, and the clause on them.
OTHERS = [
    ('<motor tendon="t"/>', 0.5, "act on something else than a joint"),
    ('<motor site="s"/>', 0.5, "act on something else than a joint"),
    ('<position tendon="t"/>', 0.0, "act on something else than a joint"),
    ('<motor joint="ball"/>', 0.5, "act on a joint of several coordinates"),
    ('<position joint="follower"/>', 0.0, "act on a joint that does not move by itself"),
    ('<muscle joint="j" lengthrange="0.2 0.5" force="1"/>', 0.0, "are of a kind that no controller has"),
    ('<intvelocity joint="j"/>', 0.0, "are of a kind that no controller has"),
    ('<position joint="j" timeconst="0.1"/>', 0.0, "have a state of their own"),
    ('<general joint="j" dyntype="integrator"/>', 0.5, "have a state of their own"),
    ('<motor joint="j" damping="2"/>', 0.0, "have a damping"),
    ('<position joint="j" forcerange="-1 2"/>', 0.0, "have a range of forces that is not symmetric"),
    ('<general joint="j" biastype="affine" biasprm="0 2"/>', 0.0, "push away from their targets"),
    ('<velocity joint="j" class="p"/>', 0.0, "have default attributes of another kind of actuator"),
    ('<position joint="j"/><velocity joint="j"/>', 0.0, "share a joint with another one"),
]


@pytest.mark.parametrize(("actuators", "control", "clause"), OTHERS)
def test_other_actuators_act_and_are_no_controllers(actuators: str, control: float, clause: str) -> None:
    body = """<body><joint name="j"/><joint name="follower"/><geom size="0.1" pos="1 0 0"/><site name="s"/></body>
    <body><joint name="ball" type="ball"/><geom size="0.1" pos="1 0 0"/></body>"""
    text = f"""<mujoco>{of_class('kp="7"')}<worldbody>{body}</worldbody>
    <tendon><fixed name="t"><joint joint="j" coef="1"/></fixed></tendon>
    <equality><joint joint1="follower" joint2="j"/></equality>
    <actuator>{actuators}</actuator>
    <keyframe><key ctrl="{" ".join([str(control)] * actuators.count("/>"))}"/></keyframe></mujoco>"""
    mujoco.MjModel.from_xml_string(text)  # MuJoCo reads the file
    read = read_text(text, use=USED, keyframe=0)
    assert read.controllers == ()
    assert {feature.text for feature in read.features if feature.acts and feature.word == "actuators"} == {clause}


def test_a_damping_ratio_is_of_the_inertia_while_other_joints_are_loose() -> None:
    """Two hinges about one direction, so that the inertia of the first one is smaller while the second one is loose."""
    links = """<body><joint name="j" axis="0 0 1"/><geom size="0.1" pos="0.2 0 0"/>
    <body pos="0.3 0 0"><joint name="k" axis="0 0 1"/><geom size="0.1" pos="0.1 0 0"/></body></body>"""
    servo = '<actuator><position joint="j" kp="9" dampratio="0.7"/></actuator>'
    (table,) = agrees(f"<mujoco><worldbody>{links}</worldbody>{servo}</mujoco>").controllers
    held = mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{links}</worldbody></mujoco>").dof_M0[0]
    assert table["kd"] < 0.9 * 2 * 0.7 * math.sqrt(9 * held)


def test_controllers_of_the_case_take_the_place_of_actuators() -> None:
    read = read_text(model('<position joint="j"/><position joint="k"/>'), use=USED, driven=frozenset({"j"}))
    assert [table["joint"] for table in read.controllers] == ["k"]
    assert not any(feature.acts for feature in read.features)
    assert "give way to controllers of the case" in {feature.text for feature in read.features}


@pytest.mark.parametrize(
    ("keyframe", "choice", "text"),
    [
        ("", -1, "hold at 0, since the file has no keyframe"),
        ('qvel="0 0"', -1, "hold at 0, since the keyframe has no ctrl"),
        ('ctrl="0.5"', None, "hold at 0, since the case names no keyframe"),
        ('ctrl="0.5"', 0, "act with the controls of the keyframe"),
    ],
)
def test_a_notice_says_where_the_control_comes_from(keyframe: str, choice: int | None, text: str) -> None:
    read = read_text(model('<position joint="j"/>', keyframe=keyframe), use=USED, keyframe=choice)
    assert text in {feature.text for feature in read.features}
    assert read.controllers[0].get("target") == (0.5 if choice == 0 else None)


def test_a_law_whose_defaults_are_of_several_kinds_is_no_controller() -> None:
    """MuJoCo keeps the law of the last of them: the servo has the gain 1, and the gear 3."""
    sections = '<default><position kp="7" kv="0.3"/><motor gear="3"/></default>'
    text = model('<position joint="j"/>', sections=sections)
    assert mujoco.MjModel.from_xml_string(text).actuator_gainprm[0, 0] == 1.0
    read = read_text(text, use=USED, keyframe=-1)
    assert read.controllers == ()
    assert "have default attributes of another kind of actuator" in {feature.text for feature in read.features}


def test_a_keyframe_has_a_control_for_each_actuator() -> None:
    with pytest.raises(BadInput, match="<key ctrl>: read 2 numbers; allowed: 1, one for each actuator of the file"):
        read_text(model('<position joint="j"/>', keyframe='ctrl="0.5 1"'), use=USED, keyframe=0)
