"""The settings of an MJCF file on which the meaning of its numbers depends (<compiler>, default classes), and attitudes."""

from dataclasses import dataclass

from bodycheck.casefile.robots.numbers import number, numbers
from bodycheck.reference.exact.numbers import MP, Quaternion4, vector
from bodycheck.reference.exact.rotations import IDENTITY, unit
from bodycheck.robots.elements import Element, quoted, refuse
from bodycheck.robots.orientations import about_axis, euler, from_axes, from_z

#: Attributes of <compiler> that change masses or frames and are not followed, with the values that change nothing.
CHANGING = {
    "coordinate": ("local",),
    "fusestatic": ("false",),
    "discardvisual": ("false",),
    "alignfree": ("false",),
}

#: Attributes of <compiler> that change masses or inertias if they are positive.
BOUNDS = ("settotalmass", "boundmass", "boundinertia")


@dataclass(frozen=True)
class Settings:
    """The settings of the <compiler>.

    Attributes
    ----------
    degrees
        Whether angles are in degrees and not in rad.
    eulerseq
        The sequence of Euler angles.
    inertiafromgeom
        "true", "false" or "auto": whether the inertia of a body is computed from its geoms.
    groups
        The smallest and the largest group of geoms that have a mass.
    """

    degrees: bool = True
    eulerseq: str = "xyz"
    inertiafromgeom: str = "auto"
    groups: tuple[float, ...] = (0.0, 5.0)

    def counts(self, group: float) -> bool:
        """Return whether geoms of a group have a mass."""
        return self.groups[0] <= group <= self.groups[1]


def settings(root: Element) -> Settings:
    """Return the settings of an MJCF file. Raises `BadInput` for settings that are not followed here."""
    rules = Settings()
    for compiler in root.all("compiler"):
        for key, harmless in CHANGING.items():
            if (value := compiler.attributes.get(key, harmless[0])) not in harmless:
                refuse(
                    compiler,
                    key,
                    f"read {quoted(value)}, which changes bodies and is not followed here; allowed: {harmless[0]}",
                )
        for key in BOUNDS:
            if number(compiler, key, 0.0) > 0:
                refuse(compiler, key, f"read {quoted(compiler.attributes[key])}, which changes masses and is not followed here")
        if _word(compiler, "balanceinertia", "false", ("true", "false")) == "true":
            refuse(
                compiler, "balanceinertia", "read 'true', by which MuJoCo replaces an inertia that no body has; allowed: false"
            )
        sequence = compiler.attributes.get("eulerseq", rules.eulerseq)
        if len(sequence) != 3 or not set(sequence.lower()) <= set("xyz"):
            refuse(compiler, "eulerseq", f"read {quoted(sequence)}; allowed: three of the letters x, y, z, X, Y, Z")
        before = "degree" if rules.degrees else "radian"
        rules = Settings(
            _word(compiler, "angle", before, ("degree", "radian")) == "degree",
            sequence,
            _word(compiler, "inertiafromgeom", rules.inertiafromgeom, ("true", "false", "auto")),
            numbers(compiler, "inertiagrouprange", (2,), rules.groups),
        )
    return rules


def _word(element: Element, attribute: str, default: str, allowed: tuple[str, ...]) -> str:
    """Return the word of an attribute. Raises `BadInput` unless it is one of the allowed words."""
    value = element.attributes.get(attribute, default)
    if value not in allowed:
        refuse(element, attribute, f"read {quoted(value)}; allowed: {', '.join(allowed)}")
    return value


class Defaults:
    """The default attributes of elements with a tag, by the names of default classes; None is the class of all others."""

    def __init__(self, root: Element, tag: str) -> None:
        self.tag = tag
        self.classes: dict[str | None, dict[str, str]] = {None: {}}
        for top in root.all("default"):
            self._add(top, None, None)

    def _add(self, element: Element, name: str | None, parent: str | None) -> None:
        """Add a class and the classes inside it, which inherit its attributes."""
        attributes = self.classes.setdefault(name, dict(self.classes[parent]))
        for child in element.all(self.tag):
            attributes |= child.attributes
        if name is None and (called := element.attributes.get("class")) is not None:
            self.classes[called] = attributes
        for inner in element.all("default"):
            if "class" not in inner.attributes:
                refuse(inner, "class", "is missing; a default class in another one has a name")
            self._add(inner, inner.attributes["class"], name)

    def resolved(self, element: Element, inherited: str | None) -> Element:
        """Return an element with the default attributes of its class, or of the class that it inherits from its body.

        Raises `BadInput` for an unknown class.
        """
        name = element.attributes.get("class", inherited)
        if name not in self.classes and name != "main":
            refuse(element, "class", f"there is no default class {quoted(name or '')}")
        attributes = self.classes.get(name, self.classes[None]) | element.attributes
        return Element(element.tag, attributes, element.file, element.line)


#: The attributes of MJCF for an attitude.
ATTITUDES = ("quat", "axisangle", "euler", "xyaxes", "zaxis")


def attitude(element: Element, rules: Settings) -> Quaternion4:
    """Return the exact attitude of an element. Raises `BadInput` if it has several of `ATTITUDES`."""
    stated = [name for name in ATTITUDES if name in element.attributes]
    if len(stated) > 1:
        refuse(element, stated[1], f"{stated[0]} is given too; allowed: one of {', '.join(ATTITUDES)}")
    if not stated:
        return IDENTITY
    values = [
        MP.mpf(value) for value in numbers(element, stated[0], ({"quat": 4, "axisangle": 4, "xyaxes": 6}.get(stated[0], 3),))
    ]
    factor = MP.pi / 180 if rules.degrees else MP.mpf(1)
    try:
        match stated[0]:
            case "quat":
                w, x, y, z = values
                return unit((w, x, y, z))
            case "axisangle":
                return about_axis(vector(values[:3]), values[3] * factor)
            case "euler":
                return euler([value * factor for value in values], rules.eulerseq)
            case "xyaxes":
                return from_axes(vector(values[:3]), vector(values[3:]))
            case _:
                return from_z(vector(values))
    except ZeroDivisionError:
        refuse(element, stated[0], f"read {quoted(element.attributes[stated[0]])}; allowed: vectors that are not 0 or parallel")
