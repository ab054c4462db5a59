"""The contact of a flat body with a plane, as MuJoCo's XML has it, and the options of a method that change it.

A method may have options, as in `Euler:cone=elliptic,solref=0.004 1`. An option that is not given is not written into the
XML, and keeps the default of the installed MuJoCo. The keys:

- cone: elliptic or pyramidal. impratio: of frictional to normal impedance. noslip: iterations of the solver of that name.
- condim: 1 (no friction), 3 (sliding), 4 (and torsion), 6 (and rolling). solref, solimp: how stiff, how soft.
- pads: n, the face as n x n small spheres at the middles of equal cells, in place of the body's own shape, for which MuJoCo
  finds at most four contacts. Of a round face only the pads within it are there.

More pads do not bring the friction of an area. Where a contact slides at speed u, MuJoCo's convex friction pushes it up with
the acceleration mu b u, b ~ 2/timeconst: by default several times gravity at 1 m/s. The body then leaves the plane and falls
back, and where it spins the outermost pads, which are the fastest, bear all of the load.

Sliding friction is the scene's. Torsion (0.005 m) and rolling (0.0001 m), where condim asks for them, are MuJoCo's defaults.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from bodycheck.adapters.contract import Kind, Option, SceneUnsupported, choice
from bodycheck.reference.errors import NotFlat
from bodycheck.reference.planar import describe_shape, planar_state, resting_height
from bodycheck.reference.scene import Brick, Cylinder, Plane, Scene

#: MuJoCo's mjMINMU: it raises smaller coefficients to this one without a word.
LEAST_FRICTION = 1e-5

#: A direction: a thousand contacts, which with noslip are already more than MuJoCo's buffer holds.
MOST_PADS = 32

#: Radius of a pad in half-heights of the body: so small that a tilt hardly moves its contact point.
PAD_SIZE = 0.01

#: MuJoCo's default coefficients (m).
TORSION_AND_ROLLING = (0.005, 0.0001)

#: The keys that are attributes of the XML's `option`.
OPTION_ATTRIBUTES = {"cone": "cone", "impratio": "impratio", "noslip": "noslip_iterations"}


@dataclass(frozen=True)
class Parts:
    """What a scene adds to the XML of a free body: attributes of `flag` and `option`, and elements."""

    flags: str = 'contact="disable" constraint="disable"'
    option: str = ""
    default: str = ""
    plane: str = ""
    geoms: str = ""
    sensors: str = ""


def unsupported(scene: Scene) -> str | None:
    """What the contact of a scene with a plane requires that is not modelled here, in words; None where nothing is."""
    if scene.drag:
        return "drag together with contact"
    try:
        planar_state(scene)
    except NotFlat as error:
        return f"this contact: {error}"
    return None


def parts(scene: Scene, plane: Plane, chosen: Mapping[str, str], shortest: float) -> Parts:
    """The contact of a body that lies flat. Raises `SceneUnsupported`.

    chosen: options by their keys; other keys are ignored. shortest: time constant (s) of solref that MuJoCo puts in place of
    a shorter one.
    """
    shape = scene.body.shape
    if not isinstance(shape, Brick | Cylinder):
        raise SceneUnsupported(f"{describe_shape(shape)} has no face to lie on")
    # A contact without friction has one dimension; MuJoCo knows no friction of zero in the others.
    condim = chosen.get("condim", "3" if plane.friction else "1")
    if condim != "1" and plane.friction < LEAST_FRICTION:
        raise SceneUnsupported(f"MuJoCo's least friction is {LEAST_FRICTION:g}, the scene's is {plane.friction:g}")
    if 0 < (timeconst := float(chosen.get("solref", "0").split()[0])) < shortest:
        raise SceneUnsupported(f"MuJoCo would raise the time constant {timeconst:g} s of solref to {shortest:g} s")
    option = {attribute: chosen[key] for key, attribute in OPTION_ATTRIBUTES.items() if key in chosen}
    geom = {"condim": condim, "friction": numbers_written(plane.friction, *TORSION_AND_ROLLING)}
    geom |= {key: value for key, value in chosen.items() if key in ("solref", "solimp")}
    return Parts(
        "",
        written(option),
        f"<default><geom {written(geom)}/></default>",
        '<geom type="plane" size="0 0 1"/>',
        "\n      ".join(body_geoms(shape, int(chosen.get("pads", "0")))),
    )


def written(attributes: dict[str, str]) -> str:
    return " ".join(f'{name}="{value}"' for name, value in attributes.items())


def body_geoms(shape: Brick | Cylinder, pads: int) -> list[str]:
    """The elements that touch the plane: the shape itself, or pads x pads spheres inside its lower face."""
    if pads:
        height = resting_height(shape)
        radius = PAD_SIZE * height
        return [
            f'<geom type="sphere" size="{numbers_written(radius)}" pos="{numbers_written(x, y, radius - height)}"/>'
            for x, y in pad_centres(shape, pads)
        ]
    match shape:
        case Brick(semi_axes):
            return [f'<geom type="box" size="{numbers_written(*semi_axes)}"/>']
        case Cylinder(radius, half_length):
            return [f'<geom type="cylinder" size="{numbers_written(radius, half_length)}"/>']


def pad_centres(shape: Brick | Cylinder, pads: int) -> list[tuple[float, float]]:
    """Middles (m, body frame) of the equal cells into which a face is cut, pads a direction; those within it."""
    fractions = [(2 * i + 1 - pads) / pads for i in range(pads)]
    cells = [(x, y) for x in fractions for y in fractions]
    match shape:
        case Brick((a, b, _)):
            return [(a * x, b * y) for x, y in cells]
        case Cylinder(radius, _):
            return [(radius * x, radius * y) for x, y in cells if x * x + y * y <= 1]


def numbers_written(*values: float) -> str:
    return " ".join(repr(float(value)) for value in values)


def whole(accepted: Callable[[int], bool]) -> Callable[[str], int]:
    """The reader of an option that is a whole number."""

    def reader(text: str) -> int:
        if not accepted(number := int(text)):
            raise ValueError(text)
        return number

    return reader


def numbers(accepted: Callable[[tuple[float, ...]], bool]) -> Callable[[str], tuple[float, ...]]:
    """The reader of an option that is one or more numbers."""

    def reader(text: str) -> tuple[float, ...]:
        values = tuple(map(float, text.split()))
        if not all(map(math.isfinite, values)) or not accepted(values):
            raise ValueError(text)
        return values

    return reader


def is_solref(values: tuple[float, ...]) -> bool:
    """Whether MuJoCo takes this pair as it is: it replaces a pair of mixed signs by its default."""
    return len(values) == 2 and (min(values) > 0 or max(values) <= 0)


def is_solimp(values: tuple[float, ...]) -> bool:
    """Whether these are impedances that MuJoCo takes as they are."""
    if len(values) not in (3, 5):
        return False
    least, most, width, midpoint, power = (*values, 0.5, 2.0)[:5]
    return 0 <= least <= 1 and 0 <= most <= 1 and width >= 0 and 0 <= midpoint <= 1 and power >= 1


ON_PLANE: frozenset[Kind] = frozenset({"plane"})

#: The options of every integrator on a plane.
OPTIONS: dict[str, Option] = {
    "cone": choice("elliptic", "pyramidal", kinds=ON_PLANE),
    "impratio": Option("a positive number", numbers(lambda values: len(values) == 1 and values[0] > 0), ON_PLANE),
    "condim": choice("1", "3", "4", "6", kinds=ON_PLANE),
    "solref": Option(
        "two numbers, both positive (time constant, damping ratio) or both not (-stiffness -damping)",
        numbers(is_solref),
        ON_PLANE,
    ),
    "solimp": Option(
        "three or five numbers: two impedances from 0 to 1, a width (m) >= 0, a midpoint from 0 to 1, a power >= 1",
        numbers(is_solimp),
        ON_PLANE,
    ),
    "noslip": Option("a whole number >= 0", whole(lambda number: number >= 0), ON_PLANE),
    "pads": Option(f"a whole number from 1 to {MOST_PADS}", whole(lambda number: 1 <= number <= MOST_PADS), ON_PLANE),
}
