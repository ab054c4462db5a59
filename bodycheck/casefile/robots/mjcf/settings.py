"""The settings of an MJCF file on which the meaning of its numbers depends (<compiler>, default classes), and attitudes."""

from dataclasses import dataclass

from bodycheck.casefile.robots.numbers import number, numbers
from bodycheck.reference.exact.numbers import MP, Quaternion4, Real, vector
from bodycheck.reference.exact.rotations import IDENTITY, unit
from bodycheck.robots.elements import Element, quoted, refuse
from bodycheck.robots.orientations import about_axis, euler, from_axes, from_z

#: The words that state whether a setting holds.
TRUTHS = ("true", "false")


@dataclass(frozen=True)
class Settings:
    """The settings of all <compiler> elements together: the last value that is stated of each attribute.

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
    autolimits
        Whether a range limits a joint unless `limited` says otherwise.
    boundmass, boundinertia
        The smallest mass (kg) and the smallest principal moment (kg m^2) of a body.
    balanceinertia
        Whether principal moments that no body has are replaced by their mean.
    settotalmass
        The total mass (kg) to which all masses and inertias are scaled; not positive if they are not scaled.
    fusestatic
        Whether bodies without joints become parts of their parents.
    alignfree
        Whether the frame of a body that floats alone is moved to its principal axes of inertia.
    fitaabb
        Whether a geom is fitted to the bounding box of a mesh and not to the box of the same inertia.
    meshdir
        The folder of meshes.
    strippath
        Whether folders are removed from the names of files.
    """

    degrees: bool = True
    eulerseq: str = "xyz"
    inertiafromgeom: str = "auto"
    groups: tuple[float, ...] = (0.0, 5.0)
    autolimits: bool = True
    boundmass: float = 0.0
    boundinertia: float = 0.0
    balanceinertia: bool = False
    settotalmass: float = -1.0
    fusestatic: bool = False
    alignfree: bool = False
    fitaabb: bool = False
    meshdir: str = ""
    strippath: bool = False

    def counts(self, group: float) -> bool:
        """Return whether geoms of a group have a mass."""
        return self.groups[0] <= group <= self.groups[1]

    def angle(self, value: Real) -> Real:
        """Return an angle of the file in rad."""
        return value * MP.pi / 180 if self.degrees else value


def settings(root: Element) -> Settings:
    """Return the settings of an MJCF file. Raises `BadInput` for settings that cannot be read, or that MuJoCo refuses."""
    rules = Settings()
    for compiler in root.all("compiler"):
        if word(compiler, "coordinate", "local", ("local", "global")) == "global":
            refuse(compiler, "coordinate", "read 'global', which MuJoCo no longer reads; allowed: local")
        sequence = compiler.attributes.get("eulerseq", rules.eulerseq)
        if len(sequence) != 3 or not set(sequence.lower()) <= set("xyz"):
            refuse(compiler, "eulerseq", f"read {quoted(sequence)}; allowed: three of the letters x, y, z, X, Y, Z")
        meshdir = compiler.attributes.get("assetdir", rules.meshdir)
        switches = {
            name: word(compiler, name, str(getattr(rules, name)).lower(), TRUTHS) == "true"
            for name in ("autolimits", "balanceinertia", "fusestatic", "alignfree", "fitaabb", "strippath")
        }
        rules = Settings(
            degrees=word(compiler, "angle", "degree" if rules.degrees else "radian", ("degree", "radian")) == "degree",
            eulerseq=sequence,
            inertiafromgeom=word(compiler, "inertiafromgeom", rules.inertiafromgeom, (*TRUTHS, "auto")),
            groups=numbers(compiler, "inertiagrouprange", (2,), rules.groups),
            meshdir=compiler.attributes.get("meshdir", meshdir),
            boundmass=number(compiler, "boundmass", rules.boundmass),
            boundinertia=number(compiler, "boundinertia", rules.boundinertia),
            settotalmass=number(compiler, "settotalmass", rules.settotalmass),
            **switches,
        )
    return rules


def word(element: Element, attribute: str, default: str, allowed: tuple[str, ...]) -> str:
    """Return the word of an attribute. Raises `BadInput` unless it is one of the allowed words."""
    value = element.attributes.get(attribute, default)
    if value not in allowed:
        refuse(element, attribute, f"read {quoted(value)}; allowed: {', '.join(allowed)}")
    return value


class Defaults:
    """The default attributes of elements with some tags, by the names of default classes; None is the class of all others."""

    def __init__(self, root: Element, *tags: str) -> None:
        self.tags = tags
        self.classes: dict[str | None, dict[str, str]] = {None: {}}
        for top in root.all("default"):
            self._add(top, None, None)

    def _add(self, element: Element, name: str | None, parent: str | None) -> None:
        """Add a class and the classes inside it, which inherit its attributes."""
        attributes = self.classes.setdefault(name, dict(self.classes[parent]))
        for child in element.children:
            if child.tag in self.tags:
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
        attributes = dict(self.classes.get(name, self.classes[None]))
        if any(attitude in element.attributes for attitude in ATTITUDES):
            attributes = {key: value for key, value in attributes.items() if key not in ATTITUDES}
        attributes |= element.attributes
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
    try:
        match stated[0]:
            case "quat":
                w, x, y, z = values
                return unit((w, x, y, z))
            case "axisangle":
                return about_axis(vector(values[:3]), rules.angle(values[3]))
            case "euler":
                return euler([rules.angle(value) for value in values], rules.eulerseq)
            case "xyaxes":
                return from_axes(vector(values[:3]), vector(values[3:]))
            case _:
                return from_z(vector(values))
    except ZeroDivisionError:
        refuse(element, stated[0], f"read {quoted(element.attributes[stated[0]])}; allowed: vectors that are not 0 or parallel")
