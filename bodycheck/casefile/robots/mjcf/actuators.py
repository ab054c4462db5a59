"""The actuators of an MJCF file: controllers of a case, where it uses them; else what they exert without control.

MuJoCo's actuation model (https://mujoco.readthedocs.io/en/stable/computation/index.html#actuation-model) of an actuator without
a state of its own, on a hinge or slide with the coordinate q and the velocity v: its length is gear q, its velocity gear v, and

    force = (gain_0 + gain_1 length + gain_2 velocity) control + bias_0 + bias_1 length + bias_2 velocity.

The control is cut to `ctrlrange` before, and the force to `forcerange` after. The effort along the joint is gear force, cut to
`actuatorfrcrange` of the joint. At a constant control this is the continuous law of a controller, with the gains

    kp = -gear^2 (gain_1 control + bias_1),  kd = -gear^2 (gain_2 control + bias_2).
"""

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from math import sqrt
from typing import Any

from bodycheck.casefile.robots.mjcf.carriers import Tree
from bodycheck.casefile.robots.mjcf.features import Kind, idle
from bodycheck.casefile.robots.mjcf.joints import JointOfFile, acting_range, limits
from bodycheck.casefile.robots.mjcf.keyframes import controls
from bodycheck.casefile.robots.mjcf.options import Options
from bodycheck.casefile.robots.mjcf.settings import Defaults, Settings, word
from bodycheck.casefile.robots.mjcf.springs import held_inertia
from bodycheck.casefile.robots.numbers import number, numbers
from bodycheck.casefile.robots.reading import Choice
from bodycheck.robots.elements import Element

#: The actuators whose defaults are those of each other.
ACTUATORS = (
    *("general", "motor", "position", "velocity", "intvelocity", "orientation", "pid", "damper", "cylinder", "muscle"),
    *("adhesion", "dcmotor", "plugin"),
)

#: The nouns of actuators; those with other tags are "actuators".
NOUNS = {"motor": ("motor", "motors"), "position": ("position servo", "position servos")}

#: Actuators that exert a force without control: always, or unless all of the attributes are zero, given with their defaults.
SERVOS: dict[str, dict[str, float]] = {
    "position": {"kp": 1.0, "kv": 0.0, "dampratio": 0.0},
    "velocity": {"kv": 1.0},
    "intvelocity": {"kp": 1.0, "kv": 0.0, "dampratio": 0.0},
    "pid": {},
    "orientation": {},
    "muscle": {},
    "dcmotor": {},
    "plugin": {},
}

#: Attributes of other actuators that give a force without control to a <general> that has them as defaults.
GAINS = ("kp", "kv", "bias", "force", "motorconst")

#: The kinds that can become controllers.
CONTROLLING = ("motor", "position", "velocity", "damper", "general")

#: The attributes of all kinds that state the law: defaults of one kind give another kind a law by MuJoCo's own parameters.
OF_LAWS = (
    *("kp", "kv", "dampratio", "timeconst", "gaintype", "gainprm", "biastype", "biasprm", "dyntype", "dynprm"),
    *("bias", "force", "motorconst"),
)

#: Attributes that state what no controller has, and the clause on it.
FURTHER = {
    "damping": "have a damping",
    "armature": "have an armature",
    "timeconst": "have a state of their own",
    "delay": "have a delay",
    "nsample": "have a delay",
}

IDLE_TEXT = "are without control and exert nothing"

#: The force of an actuator, or the effort of a joint: the constant, and the factors of the length and the velocity.
Law = tuple[Fraction, Fraction, Fraction]


class _NoController(Exception):
    """Raised with a clause for an actuator that is no controller of a case."""


@dataclass(frozen=True)
class _File:
    """The file, as far as laws of actuators depend on it: its joints by their names, its settings, and what it switches off."""

    tree: Tree
    options: Options
    joints: dict[str, JointOfFile]
    defaults: Defaults
    of_tags: dict[str, Defaults]


def controllers_of(root: Element, options: Options, tree: Tree, choice: Choice) -> tuple[dict[str, Any], ...]:
    """Return the tables of the controllers that actuators become if the case uses them, and add all others as features.

    Raises `BadInput` for ranges, and controls of the keyframe, that MuJoCo refuses.
    """
    elements = [element for section in root.all("actuator") for element in section.children]
    if "actuation" in options.off or not elements:
        return ()
    file = _File(
        tree,
        options,
        {joint.element.attributes.get("name", ""): joint for joint in tree.joints if joint.kind != "fixed"},
        Defaults(root, *ACTUATORS),
        {tag: Defaults(root, tag) for tag in CONTROLLING},
    )
    used = "actuators" in choice.use
    given, why = controls(root, choice.keyframe, len(elements)) if used else ([0.0] * len(elements), "")
    controllers: list[tuple[Element, Kind, dict[str, Any]]] = []
    for element, control in zip(elements, given, strict=True):
        actuator, noun = file.defaults.resolved(element, None), NOUNS.get(element.tag, ("actuator", "actuators"))
        if _joint_name(actuator) in choice.driven:
            tree.features.add(idle(*noun, "give way to controllers of the case"), element)
        elif number(actuator, "group", 0.0) in options.idle_groups:
            tree.features.add(idle(*noun, "are switched off by their group and exert nothing"), element)
        elif not control and not acts_alone(actuator):
            tree.features.add(idle(*noun, IDLE_TEXT), element)
        elif not used:
            tree.features.add(("actuators", True, "exert forces without control", noun), element)
        else:
            try:
                table = _controller(element, actuator, control, file)
            except _NoController as clause:
                tree.features.add(("actuators", True, str(clause), noun), element)
                continue
            if table["law"] == "effort" and not table["effort"]:
                tree.features.add(idle(*noun, "exert nothing"), element)
            else:
                controllers.append((element, idle(*noun, _text(table, actuator, why)), table))
    count = Counter(table["joint"] for _, _, table in controllers)
    for element, kind, table in controllers:
        shared: Kind = ("actuators", True, "share a joint with another one", kind[3])
        tree.features.add(kind if count[table["joint"]] == 1 else shared, element)
    return tuple(table for _, _, table in controllers if count[table["joint"]] == 1)


def _text(table: dict[str, Any], actuator: Element, why: str) -> str:
    """Return a clause on an actuator that is a controller. why: why its control is zero; empty if the keyframe states it."""
    if not why:
        return "act with the controls of the keyframe"
    if _clamped(actuator):
        return f"have the control nearest to 0 in their range, {why}"
    held = table["law"] == "pd" and "kp" in table and "target" not in table
    return f"hold at 0, {why}" if held else f"have the control 0, {why}"


def _joint_name(actuator: Element) -> str | None:
    """Return the name of the joint that an actuator moves; None if it moves something else."""
    return actuator.attributes.get("joint", actuator.attributes.get("jointinparent"))


def _controller(element: Element, actuator: Element, control: float, file: _File) -> dict[str, Any]:
    """Return the table of the controller that an actuator is. actuator: the element with its default attributes.

    Raises `_NoController` if it is none.
    """
    joint, rules = _joint(actuator, file), file.tree.rules
    _check(element, actuator, file)
    gear = numbers(actuator, "gear", (1, 2, 3, 4, 5, 6), (1.0,))[0]
    control = _cut(control, None if "clampctrl" in file.options.off else _range_of_control(actuator, joint, rules))

    def inertia() -> float:
        # The inertia that the actuator moves: that of the joint while all others are held, divided by the square of the gear.
        return held_inertia(file.tree, joint.name) / gear**2 if gear else 0.0

    force = _force(actuator, Fraction(control), inertia)
    scale = Fraction(gear)
    constant, of_position, of_velocity = scale * force[0], scale**2 * force[1], scale**2 * force[2]
    ends = acting_range(actuator, "forcelimited", "forcerange", rules)
    lower, upper = (None, None) if ends is None else sorted(scale * Fraction(end) for end in ends)
    of_joint = acting_range(joint.element, "actuatorfrclimited", "actuatorfrcrange", rules)
    if of_joint is not None:
        least, most = map(Fraction, of_joint)
        lower = least if lower is None else min(max(lower, least), most)
        upper = most if upper is None else min(max(upper, least), most)
    if not of_position and not of_velocity:
        effort = constant if lower is None or upper is None else min(max(constant, lower), upper)
        return {"joint": joint.name, "law": "effort", "effort": float(effort)}
    if of_position > 0 or of_velocity > 0:
        raise _NoController("push away from their targets")
    if lower is not None and upper is not None and lower != -upper:
        raise _NoController("have a range of forces that is not symmetric")
    table: dict[str, Any] = {"joint": joint.name, "law": "pd"}
    table |= {key: float(-value) for key, value in (("kp", of_position), ("kd", of_velocity)) if value}
    if constant:
        key, factor = ("target", of_position) if of_position else ("target_velocity", of_velocity)
        table[key] = float(-constant / factor)
    return table if upper is None else table | {"effort_limit": float(upper)}


def _joint(actuator: Element, file: _File) -> JointOfFile:
    """Return the joint of one coordinate that an actuator moves. Raises `_NoController` if there is none."""
    if (name := _joint_name(actuator)) is None:
        raise _NoController("act on something else than a joint")
    if (joint := file.joints.get(name)) is None:
        raise _NoController("act on a joint that the file does not have")
    if joint.kind not in ("hinge", "slide"):
        raise _NoController("act on a joint of several coordinates")
    if joint.table["type"] == "fixed" or "mimic" in joint.table:
        raise _NoController("act on a joint that does not move by itself")
    return joint


def _check(element: Element, actuator: Element, file: _File) -> None:
    """Raise `_NoController` if an actuator has a law, or a part, that no controller has."""
    if actuator.tag not in CONTROLLING:
        raise _NoController("are of a kind that no controller has")
    for attribute, clause in FURTHER.items():
        if any(numbers(actuator, attribute, (1, 2, 3), (0.0,))) and not (attribute == "timeconst" and actuator.tag == "motor"):
            raise _NoController(clause)
    if actuator.tag == "motor":  # its law has no attribute
        return
    alone = file.of_tags[actuator.tag].resolved(element, None).attributes
    stated = {name: actuator.attributes.get(name) for name in OF_LAWS}
    if any(alone.get(name) != value for name, value in stated.items()) or (stated["kv"] and stated["dampratio"]):
        raise _NoController("have default attributes of another kind of actuator")
    if stated["dyntype"] not in (None, "none"):
        raise _NoController("have a state of their own")
    if stated["gaintype"] not in (None, "fixed", "affine") or stated["biastype"] not in (None, "none", "affine"):
        raise _NoController("are of a kind that no controller has")


def _range_of_control(actuator: Element, joint: JointOfFile, rules: Settings) -> tuple[float, float] | None:
    """Return the range to which the control is cut: that of the joint about its middle, scaled by `inheritrange`, if stated."""
    if (stated := acting_range(actuator, "ctrllimited", "ctrlrange", rules)) is not None:
        return stated
    part = number(actuator, "inheritrange", 0.0) if actuator.tag in ("position", "general") else 0.0
    if not part or (inherited := limits(joint, rules)) is None:
        return None
    middle, half = (inherited[0] + inherited[1]) / 2, (inherited[1] - inherited[0]) / 2 * part
    return middle - half, middle + half


def _cut(value: float, ends: tuple[float, float] | None) -> float:
    return value if ends is None else min(max(value, ends[0]), ends[1])


def _force(actuator: Element, control: Fraction, inertia: Callable[[], float]) -> Law:
    """Return the force of an actuator at a constant control. inertia: returns the inertia that it moves.

    The laws are those of https://mujoco.readthedocs.io/en/stable/XMLreference.html#actuator.
    """
    zero = Fraction(0)
    match actuator.tag:
        case "motor":
            return control, zero, zero
        case "damper":
            return zero, zero, -Fraction(number(actuator, "kv", 0.0)) * control
        case "velocity":
            gain = Fraction(number(actuator, "kv", 1.0))
            return gain * control, zero, -gain
        case "position":
            kp, damping = number(actuator, "kp", 1.0), number(actuator, "kv", 0.0)
            if ratio := number(actuator, "dampratio", 0.0):
                damping = _damping(ratio, kp, inertia())
            return Fraction(kp) * control, -Fraction(kp), -Fraction(damping)
    gains, biases = (
        [*numbers(actuator, name, tuple(range(1, 11)), (first,)), 0.0, 0.0, 0.0][:3]
        for name, first in (("gainprm", 1.0), ("biasprm", 0.0))
    )
    if gains[0] == -biases[1] and biases[2] > 0:  # a damping ratio in the place of a factor
        biases[2] = -_damping(biases[2], gains[0], inertia())
    if actuator.attributes.get("gaintype", "fixed") == "fixed":
        gains[1:] = 0.0, 0.0
    if actuator.attributes.get("biastype", "none") == "none":
        biases = [0.0, 0.0, 0.0]
    constant, of_length, of_velocity = (
        Fraction(gain) * control + Fraction(bias) for gain, bias in zip(gains, biases, strict=True)
    )
    return constant, of_length, of_velocity


def _damping(ratio: float, kp: float, inertia: float) -> float:
    """Return the damping of a position servo with a damping ratio, as MuJoCo's compiler computes it."""
    return 2 * ratio * sqrt(max(kp * inertia, 0.0))


def acts_alone(actuator: Element) -> bool:
    """Return whether an actuator, given with its default attributes, exerts a force while its control is zero."""
    if any(any(numbers(actuator, name, (1, 2, 3), (0.0,))) for name in ("damping", "armature")):
        return True
    if _clamped(actuator) or _excludes_zero(actuator, "forcelimited", "forcerange"):
        return True
    if actuator.tag in SERVOS:
        gains = SERVOS[actuator.tag]
        return not gains or any(number(actuator, name, default) for name, default in gains.items())
    if actuator.tag == "cylinder":
        return any(numbers(actuator, "bias", (1, 2, 3), (0.0,)))
    if actuator.tag == "general":
        bias = word(actuator, "biastype", "none", ("none", "affine", "muscle", "dcmotor", "so3", "user"))
        stated = numbers(actuator, "biasprm", tuple(range(1, 11)), (0.0,))
        user = "user" in (actuator.attributes.get(name) for name in ("dyntype", "gaintype"))
        servo = any(name in actuator.attributes for name in GAINS)
        return user or servo or (any(stated) if bias == "affine" else bias != "none")
    return False


def _clamped(actuator: Element) -> bool:
    """Return whether a control of zero is outside the range of the control, so that it becomes another one."""
    return _excludes_zero(actuator, "ctrllimited", "ctrlrange")


def _excludes_zero(actuator: Element, switch: str, attribute: str) -> bool:
    """Return whether zero is outside a range. switch: the attribute that states whether the range limits something."""
    lower, upper = numbers(actuator, attribute, (2,), (0.0, 0.0))
    return actuator.attributes.get(switch) != "false" and (lower, upper) != (0.0, 0.0) and not lower <= 0 <= upper
