"""The parts of a URDF that are no mechanics of a case: what does not act in a free motion, and what a case ignores."""

from collections.abc import Collection, Iterator
from dataclasses import dataclass

from bodycheck.casefile.robots.reading import Feature, Ignored
from bodycheck.casefile.robots.urdf.rigid import Rigid, sentence
from bodycheck.robots.elements import Element, quoted
from bodycheck.robots.urdf import Parts
from bodycheck.robots.urdf_parts import JointPart

#: The elements that are read, by the elements that contain them.
READ = {
    "robot": ("link", "joint"),
    "link": ("inertial", "collision"),
    "joint": ("origin", "parent", "child", "axis", "limit", "dynamics", "mimic"),
}


@dataclass(frozen=True)
class _Kind:
    """A kind of part: the word that leaves it out, a noun in the singular and in the plural, and a clause."""

    word: Ignored | None
    noun: tuple[str, str]
    text: str


_VISUAL = _Kind(None, ("visual element", "visual elements"), "have no mass")
_DRIVEN = "are without control and exert nothing"
_SENSOR = _Kind(None, ("sensor", "sensors"), "exert nothing")

#: Elements that do not act in a free motion, by their tags.
IDLE = {
    "transmission": _Kind("actuators", ("transmission", "transmissions"), _DRIVEN),
    "safety_controller": _Kind("actuators", ("safety controller", "safety controllers"), _DRIVEN),
    "calibration": _Kind(None, ("calibration", "calibrations"), "exert nothing"),
    "visual": _VISUAL,
    "material": _VISUAL,
    "sensor": _SENSOR,
    "gazebo": _Kind(None, ("element <gazebo>", "elements <gazebo>"), "are for another program and are not read"),
}

#: The damping and friction of joints: of joints with several coordinates, a case cannot state them.
SEVERAL = "act on several coordinates"
DYNAMICS: dict[str, _Kind] = {
    "damping": _Kind("damping", ("damping of {} joint", "damping of {} joints"), SEVERAL),
    "friction": _Kind("friction", ("dry friction of {} joint", "dry friction of {} joints"), SEVERAL),
}
MIMIC = _Kind("mimic", ("element <mimic>", "elements <mimic>"), "")
ONE_BODY = "have an inertia that no body has, and are read as one body with the links that they are fixed to, which is possible"
AT_REST = "have an inertia that no body has, and are fixed to the world, where inertia does not act"
WEIGHTLESS = _Kind(None, ("link", "links"), "have inertia without mass, which is added to what carries them")


#: The most links of impossible inertia that a sentence names.
MOST_NAMED = 3


def features(
    root: Element,
    read: Parts,
    ignore: Collection[Ignored],
    mimics: Collection[Element],
    weightless: Collection[Element],
    rigid: Rigid,
) -> tuple[Feature, ...]:
    """Return the parts of a file that are no mechanics of a case, each kind once, in the order of the file.

    Parameters
    ----------
    root
        The root of the file.
    read
        Its links and joints.
    ignore
        What the case leaves out on purpose.
    mimics
        The elements <mimic> that it leaves out.
    weightless
        The links with inertia, but without mass, that are fixed to other links.
    rigid
        The links that are read as parts of what carries them.
    """
    parts = [*_idle(root), *_of_joints(read.joints, ignore), *_impossible(read, rigid)]
    parts += [(MIMIC, True, element) for element in mimics] + [(WEIGHTLESS, False, element) for element in weightless]
    lines: dict[tuple[_Kind, bool], list[tuple[str, int]]] = {}
    for kind, acts, element in parts:
        lines.setdefault((kind, acts), []).append((element.file, element.line))
    ordered = sorted(lines.items(), key=lambda entry: min(entry[1]))
    return tuple(Feature(kind.word, acts, kind.text, kind.noun, tuple(places)) for (kind, acts), places in ordered)


def _impossible(read: Parts, rigid: Rigid) -> Iterator[tuple[_Kind, bool, Element]]:
    """Yield the links whose inertia no body has, but which are fixed to the world or to links that make it possible."""
    noun = ("link", "links")
    for grounded, text in ((False, ONE_BODY), (True, AT_REST)):
        faults = {name: fault for name, fault in rigid.faults.items() if (name in rigid.grounded) == grounded}
        listed = sentence(list(faults.items()), MOST_NAMED)
        kind = _Kind(None, noun, f"{text}: {listed}")
        yield from ((kind, False, link.element) for link in read.links if link.name in faults)


def _idle(root: Element) -> Iterator[tuple[_Kind, bool, Element]]:
    """Yield the elements that are not read, each with its kind."""
    for around in (root, *(child for child in root.children if child.tag in ("link", "joint"))):
        for element in around.children:
            if element.tag not in READ.get(around.tag, ()):
                yield IDLE.get(element.tag) or _unknown(element.tag), False, element


def _unknown(tag: str) -> _Kind:
    name = quoted(tag)[1:-1]
    return _Kind(None, (f"element <{name}>", f"elements <{name}>"), "are no part of URDF and are not read")


def _of_joints(joints: Collection[JointPart], ignore: Collection[Ignored]) -> Iterator[tuple[_Kind, bool, Element]]:
    """Yield the damping and friction of joints that are ignored, or that a case cannot state."""
    for joint in joints:
        dynamics = joint.element.first("dynamics")
        for key, kind in DYNAMICS.items():
            is_stated = joint.type in ("revolute", "prismatic") and key not in ignore
            if dynamics is not None and getattr(joint, key) and joint.type != "fixed" and not is_stated:
                yield kind, True, dynamics
