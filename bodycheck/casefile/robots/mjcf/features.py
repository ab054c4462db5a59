"""The parts of an MJCF file that are no mechanics of a case, or not yet: each kind of part once, with its lines."""

from typing import Any

from bodycheck.casefile.robots.mjcf.options import Options
from bodycheck.casefile.robots.mjcf.settings import word
from bodycheck.casefile.robots.numbers import number
from bodycheck.casefile.robots.reading import Feature, Ignored
from bodycheck.robots.elements import Element, quoted

#: The word that leaves a kind of part out, whether it acts from the beginning, a clause, and a noun.
Kind = tuple[Ignored | None, bool, str, tuple[str, str]]


class Features:
    """Collects features.

    Attributes
    ----------
    ignore
        The words that a case ignores.
    off
        What flags of the file switch off: values of `options.FLAGS`.
    """

    def __init__(self, ignore: frozenset[Ignored], off: frozenset[str]) -> None:
        self.ignore, self.off = ignore, off
        self.places: dict[Kind, list[tuple[str, int]]] = {}

    def add(self, kind: Kind, element: Element) -> None:
        """Add an element of a kind."""
        self.places.setdefault(kind, []).append((element.file, element.line))

    def keys(self, word: Ignored, element: Element, keys: dict[str, Any]) -> dict[str, Any]:
        """Return keys of the table of a joint; if the case ignores the word, add that they are left out, and return none."""
        if word not in self.ignore:
            return keys
        self.add((word, True, "", property_of(word, "joint")), element)
        return {}

    def all(self) -> tuple[Feature, ...]:
        """Return the features in the order of the file."""
        ordered = sorted(self.places.items(), key=lambda entry: min(entry[1]))
        return tuple(Feature(*kind, tuple(sorted(places))) for kind, places in ordered)


def property_of(name: str, part: str, several: str | None = None) -> tuple[str, str]:
    """Return the nouns of a property, such as "damping of {} joints". several: the plural of the part, if irregular."""
    return f"{name} of {{}} {part}", f"{name} of {{}} {several or part + 's'}"


def idle(noun: str, plural: str, text: str = "exert nothing") -> Kind:
    return None, False, text, (noun, plural)


#: Elements that do not act in a free motion, by the element that contains them and their own tag; an empty tag stands for all.
IDLE: dict[tuple[str, str], Kind] = {
    ("sensor", ""): idle("sensor", "sensors"),
    ("custom", ""): idle("custom datum", "custom data"),
    ("keyframe", "key"): idle("keyframe", "keyframes", "state where motions may begin"),
    ("asset", "texture"): idle("texture", "textures"),
    ("asset", "material"): idle("material", "materials"),
    ("asset", "skin"): idle("skin", "skins"),
    ("deformable", "skin"): idle("skin", "skins"),
    ("contact", "pair"): idle("pair of geoms", "pairs of geoms", "are for contacts"),
    ("contact", "exclude"): idle("excluded pair of bodies", "excluded pairs of bodies", "are for contacts"),
    ("mujoco", "visual"): idle("element <visual>", "elements <visual>", "are for pictures"),
    ("mujoco", "statistic"): idle("element <statistic>", "elements <statistic>", "are for pictures"),
    ("mujoco", "size"): idle("element <size>", "elements <size>", "are for memory"),
}

#: Elements of bodies that do not act in a free motion.
IDLE_OF_BODIES = {
    "site": idle("site", "sites"),
    "camera": idle("camera", "cameras"),
    "light": idle("light", "lights"),
}

#: Elements that act, and that no word leaves out, by their tags.
COMPOSITE: Kind = (None, True, "are many bodies", ("composite", "composites"))
FLEX: Kind = (None, True, "are deformable bodies", ("flex", "flexes"))
PLUGIN: Kind = (None, True, "may move bodies", ("plugin", "plugins"))
ATTACHED: Kind = (None, True, "are another model", ("element <attach>", "elements <attach>"))
ACTING = {"composite": COMPOSITE, "flexcomp": FLEX, "flex": FLEX, "plugin": PLUGIN, "attach": ATTACHED}

GRAVCOMP: Kind = ("gravity_compensation", True, "act", property_of("gravity compensation", "body", "bodies"))
MOCAP: Kind = (None, False, "are at rest, as nothing moves them", ("mocap body", "mocap bodies"))
MEDIUM: Kind = ("medium", True, "act on all bodies", ("medium", "media"))


def features_of(root: Element, options: Options, ignore: frozenset[Ignored]) -> Features:
    """Return the features of a file without those of its joints, equalities and actuators."""
    features = Features(ignore, options.off)
    if options.medium is not None:
        features.add(MEDIUM, options.medium)
    for section in root.children:
        if (kind := IDLE.get(("mujoco", section.tag))) is not None:
            features.add(kind, section)
        for element in section.children:
            kind = IDLE.get((section.tag, element.tag), IDLE.get((section.tag, ""), ACTING.get(element.tag)))
            if kind is not None and section.tag not in ("actuator", "default", "extension"):
                features.add(kind, element)
        if section.tag == "worldbody":
            for element in section.everything():
                _of_body(element, features)
    return features


def _of_body(element: Element, features: Features) -> None:
    """Add an element of a body that is no mechanics."""
    kind = IDLE_OF_BODIES.get(element.tag) or ACTING.get(element.tag)
    if kind is not None:
        features.add(kind, element)
    if element.tag == "body":
        if number(element, "gravcomp", 0.0) and "gravity" not in features.off:
            features.add(GRAVCOMP, element)
        if word(element, "mocap", "false", ("true", "false")) == "true":
            features.add(MOCAP, element)


def unknown_equality(element: Element) -> Kind:
    """Return the kind of an equality that a case does not have."""
    name = quoted(element.tag)[1:-1]
    return "equalities", True, "hold bodies", (f"equality <{name}>", f"equalities <{name}>")
