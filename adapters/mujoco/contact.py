"""Write the contact of a flat body with a plane as MuJoCo's XML, and define the options of a method that change contacts.

A method may have options, as in `Euler:cone=elliptic,solref=0.004 1`. An option that is not given is not written into the
XML, and keeps the default of the installed MuJoCo. The keys are:

- cone: the friction cone, elliptic or pyramidal.
- impratio: the ratio of frictional to normal impedance.
- noslip: the number of iterations of MuJoCo's noslip solver.
- condim: the dimensions of a contact: 1 (no friction), 3 (sliding), 4 (sliding, torsion), 6 (sliding, torsion, rolling).
- solref, solimp: MuJoCo's parameters for the stiffness and the softness of a contact.
- multiccd: whether MuJoCo looks for several points of a contact that it finds by convex optimisation; not for a body that lies
  flat on a level plane.
- restitution: see `touching`; not for a body that lies flat.
- pads: n replaces the body's own shape by n x n small spheres at the centres of equal cells of its lower face; a round face
  keeps only the spheres inside it. Without pads, MuJoCo finds at most four contacts.

More pads do not approach the friction of an area. If a contact slides at speed u, MuJoCo's convex friction pushes it up with
the acceleration mu b u, b ~ 2/timeconst: by default several times gravity at 1 m/s. The body then leaves the plane and falls
back. If it also spins, the outermost pads, which are the fastest, bear the whole load.

The coefficient of sliding friction is the scene's. Torsion (0.005 m) and rolling (0.0001 m), where condim includes
them, keep MuJoCo's defaults.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from bodycheck.adapters.contract import Kind, Option, Range, SceneUnsupported, choice
from bodycheck.adapters.touching import lying_shape
from bodycheck.reference.planar import resting_height
from bodycheck.reference.scene import Brick, Cylinder, Plane, Scene

#: MuJoCo's mjMINMU: MuJoCo silently raises smaller coefficients to this one.
MUJOCO_MIN_FRICTION = 1e-5

#: The largest number of pads in each direction. A thousand contacts with noslip already exceed MuJoCo's buffer.
MAX_PADS_PER_SIDE = 32

#: Radius of a pad in half-heights of the body. It is small enough that a tilt hardly moves the contact point.
PAD_RADIUS_IN_HEIGHTS = 0.01

#: MuJoCo's default coefficients of torsional and rolling friction (m).
TORSION_AND_ROLLING_FRICTION_M = (0.005, 0.0001)

#: The keys that become attributes of the XML element `option`, with the names of the attributes.
OPTION_ATTRIBUTES = {"cone": "cone", "impratio": "impratio", "noslip": "noslip_iterations"}


@dataclass(frozen=True)
class Parts:
    """The parts that a scene adds to the XML of a free body: attributes of `flag` and `option`, and XML elements."""

    flags: str = 'contact="disable" constraint="disable"'
    option: str = ""
    default: str = ""
    plane: str = ""
    geoms: str = ""
    sensors: str = ""


def parts(scene: Scene, plane: Plane, chosen: Mapping[str, str], shortest: float) -> Parts:
    """Return the XML parts for the contact of a body that lies flat.

    Parameters
    ----------
    scene
        The scene with the body.
    plane
        The plane of the scene.
    chosen
        Options by their keys; keys that are not contact options are ignored.
    shortest
        The smallest time constant (s) of solref that MuJoCo accepts unchanged.

    Raises
    ------
    SceneUnsupported
        If the body has no flat face, or if MuJoCo would silently change the friction or the time constant.
    """
    shape = lying_shape(scene)
    check_time_constant(chosen, shortest)
    geom = {"condim": dimensions(plane.friction, chosen)}
    geom["friction"] = numbers_written(plane.friction, *TORSION_AND_ROLLING_FRICTION_M)
    geom |= {key: value for key, value in chosen.items() if key in ("solref", "solimp")}
    return Parts(
        "",
        written(solver_options(chosen)),
        f"<default><geom {written(geom)}/></default>",
        '<geom type="plane" size="0 0 1"/>',
        "\n      ".join(body_geoms(shape, int(chosen.get("pads", "0")))),
    )


def shortest_time_constant(integrator: str, timestep: float) -> float:
    """Return the smallest time constant (s) that MuJoCo accepts unchanged with a time step (s)."""
    # For stability, MuJoCo keeps the time constant of a constraint at two steps or more; `discrete` does not need this.
    return 0.0 if integrator == "discrete" else 2 * timestep


def check_time_constant(chosen: Mapping[str, str], shortest: float, key: str = "solref") -> None:
    """Raise `SceneUnsupported` if MuJoCo would raise the time constant of an option like solref to the shortest one (s)."""
    if 0 < (timeconst := float(chosen.get(key, "0").split()[0])) < shortest:
        raise SceneUnsupported(f"MuJoCo would raise the time constant {timeconst:g} s of {key} to {shortest:g} s")


def dimensions(friction: float, chosen: Mapping[str, str]) -> str:
    """Return the dimensions of a contact. Raises `SceneUnsupported` if MuJoCo would silently change its friction."""
    # MuJoCo does not accept a coefficient of zero in contacts with friction, so a frictionless contact has one dimension.
    condim = chosen.get("condim", "3" if friction else "1")
    if condim != "1" and friction < MUJOCO_MIN_FRICTION:
        raise SceneUnsupported(f"MuJoCo's least friction is {MUJOCO_MIN_FRICTION:g}, the scene's is {friction:g}")
    return condim


def solver_options(chosen: Mapping[str, str]) -> dict[str, str]:
    """Return the attributes of the XML element `option` that are chosen."""
    return {attribute: chosen[key] for key, attribute in OPTION_ATTRIBUTES.items() if key in chosen}


def written(attributes: dict[str, str]) -> str:
    """Return XML attributes as text."""
    return " ".join(f'{name}="{value}"' for name, value in attributes.items())


def body_geoms(shape: Brick | Cylinder, pads: int) -> list[str]:
    """Return the XML elements that touch the plane: the shape itself, or pads x pads spheres inside its lower face."""
    if pads:
        height = resting_height(shape)
        radius = PAD_RADIUS_IN_HEIGHTS * height
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
    """Return the centres (x, y) (m, body frame) of the cells, pads in each direction, into which a face is divided.

    Centres outside a round face are left out.
    """
    fractions = [(2 * i + 1 - pads) / pads for i in range(pads)]
    cells = [(x, y) for x in fractions for y in fractions]
    match shape:
        case Brick((a, b, _)):
            return [(a * x, b * y) for x, y in cells]
        case Cylinder(radius, _):
            return [(radius * x, radius * y) for x, y in cells if x * x + y * y <= 1]


def numbers_written(*values: float) -> str:
    """Return numbers as XML text, separated by spaces, with all digits that a float needs."""
    return " ".join(repr(float(value)) for value in values)


#: Contact options have an effect only in scenes with a plane; some only if the body lies flat, and some only if it does not.
ON_PLANE: frozenset[Kind] = frozenset({"plane", "contact"})
FLAT: frozenset[Kind] = frozenset({"plane"})
NOT_FLAT: frozenset[Kind] = frozenset({"contact"})

POSITIVE, NOT_POSITIVE, NOT_NEGATIVE = Range(0, above=True), Range(most=0), Range(0)
FRACTION, AT_LEAST_ONE = Range(0, 1), Range(1)

#: The contact options, which every integrator has on a plane. MuJoCo replaces a solref with numbers of different signs by its
#: default.
OPTIONS: dict[str, Option] = {
    "cone": choice("elliptic", "pyramidal", kinds=ON_PLANE),
    "impratio": Option("a positive number", numbers=((POSITIVE,),), kinds=ON_PLANE),
    "condim": choice("1", "3", "4", "6", kinds=ON_PLANE),
    "solref": Option(
        "two numbers, both positive (time constant, damping ratio) or both not (-stiffness -damping)",
        numbers=((POSITIVE, POSITIVE), (NOT_POSITIVE, NOT_POSITIVE)),
        kinds=ON_PLANE,
    ),
    "solimp": Option(
        "three or five numbers: two impedances from 0 to 1, a width (m) >= 0, a midpoint from 0 to 1, a power >= 1",
        numbers=((FRACTION, FRACTION, NOT_NEGATIVE), (FRACTION, FRACTION, NOT_NEGATIVE, FRACTION, AT_LEAST_ONE)),
        kinds=ON_PLANE,
    ),
    "noslip": Option("a whole number >= 0", numbers=((Range(0, whole=True),),), kinds=ON_PLANE),
    "pads": Option(
        f"a whole number from 1 to {MAX_PADS_PER_SIDE}",
        numbers=((Range(1, MAX_PADS_PER_SIDE, whole=True),),),
        kinds=FLAT,
    ),
    "multiccd": choice("enable", "disable", kinds=NOT_FLAT),
    "restitution": choice("solref", kinds=NOT_FLAT),
}
