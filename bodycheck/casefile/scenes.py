"""Build the scene of a case from the tables of its file."""

from dataclasses import replace
from typing import Protocol

from bodycheck.casefile import grammar
from bodycheck.casefile.surroundings import (
    BODY,
    attitude_on,
    build_contacts,
    build_plane,
    build_push,
    coefficients,
    position_on,
)
from bodycheck.casefile.toml_positions import Path
from bodycheck.reference.exact.numbers import MP, Real, real
from bodycheck.reference.exact.start import defined_scene, start
from bodycheck.reference.scene import (
    Attitude,
    Body,
    Brick,
    Cylinder,
    Definition,
    Ellipsoid,
    EulerAngles,
    EulerRates,
    Given,
    Particle,
    Plane,
    Quaternion,
    Scene,
    Shape,
    Solid,
    Sphere,
    Tensor,
    Vector,
)

#: Smallest allowed ratio of the principal moments of particles or parts; a smaller ratio is rounding error.
MIN_MOMENT_RATIO = 1e-15


#: Largest value that a quantity of a motion may have in SI units, so that its square does not overflow; see `_check_size`.
MAX_SIZE = 1e150


class Inconsistent(Exception):
    """Every key is allowed, but their combination is not. `faults` contains pairs of path and message."""

    def __init__(self, *faults: tuple[Path, str]) -> None:
        super().__init__(*faults)
        self.faults = faults


def build_scene(table: grammar.CaseTable) -> Scene:
    """Return the scene of a case.

    Raises `Inconsistent` for particles or parts that lie on a line, and for a motion with a quantity above `MAX_SIZE`.

    If neither position nor attitude is given, a body lies on the plane at the origin, along the axes of the plane.
    """
    surroundings, initial = table.scene, table.initial
    plane = _plane(surroundings)
    scene = defined_scene(_definition(table, plane), solid_shape(table.body))
    body = scene.body
    if _composed(table.body):
        _check_extent(body)
    built = replace(
        scene,
        initial=replace(
            scene.initial,
            position=initial.position or position_on(plane, body.shape, attitude_of(initial, attitude_on(plane))),
            velocity=initial.velocity,
        ),
        gravity=surroundings.gravity,
        plane=plane,
        drag=surroundings.drag.quadratic if surroundings.drag else 0.0,
        pushes=tuple(build_push(push) for push in surroundings.push),
    )
    _check_size(built, table.run.duration)
    return built


def _plane(table: grammar.SceneTable) -> Plane | None:
    """Return the plane, with the coefficients and the cone of its contact with the body if the table states one."""
    plane = build_plane(table.plane)
    for pair in build_contacts(table.contacts, [BODY], plane):
        assert plane is not None  # without a plane there is no contact
        plane = replace(plane, **coefficients(pair))
    return plane


def _definition(table: grammar.CaseTable, plane: Plane | None) -> Definition:
    return Definition(inertia_of(table.body), attitude_of(table.initial, attitude_on(plane)), rotation_of(table.initial))


def rotation_of(initial: grammar.InitialTable) -> Vector | EulerRates:
    """Return the angular velocity of a state, or the rates of its Euler angles, as its table gives them."""
    return EulerRates(*initial.euler_rates) if initial.euler_rates else initial.angular_velocity or (0.0, 0.0, 0.0)


def inertia_of(table: grammar.AnyBody) -> Given:
    """Return the inertia of the body of a table, as it is given; a solid is at the origin."""
    if table.inertia is not None:
        assert table.mass is not None  # the grammar requires a mass unless the body is composed
        match table.inertia:
            case (float(a), float(b), float(c)):
                return Tensor(table.mass, ((a, 0.0, 0.0), (0.0, b, 0.0), (0.0, 0.0, c)))
            case (tuple() as first, tuple() as second, tuple() as third):
                return Tensor(table.mass, (first, second, third))
    if isinstance(table, grammar.ShapelessTable):
        if table.particles is not None:
            return tuple(Particle(particle.mass, particle.position) for particle in table.particles)
        return tuple(
            Solid(shape, part.mass, part.position, attitude_of(part))
            for part in table.parts or ()
            if (shape := solid_shape(part)) is not None
        )
    shape = solid_shape(table)
    assert shape is not None
    assert table.mass is not None
    return Solid(shape, table.mass)


def _composed(table: grammar.AnyBody) -> bool:
    return isinstance(table, grammar.ShapelessTable) and table.inertia is None


def _check_extent(body: Body) -> None:
    if not min(body.moments) > MIN_MOMENT_RATIO * max(body.moments):
        slender = (
            f"its principal moments are {body.moments}; a body on a line has no moment about that line, and cannot be simulated"
        )
        raise Inconsistent((("body",), slender))


def _check_size(scene: Scene, duration: float) -> None:
    """Raise `Inconsistent` if numbers of the motion become so large within a duration (s) that products could overflow."""
    begin, initial, gravity = start(scene), scene.initial, real(scene.gravity)
    mass, time = real(scene.body.mass), real(duration)
    speed = MP.hypot(MP.hypot(*map(real, initial.velocity[:2])), real(initial.velocity[2]))
    way = sum(abs(real(each)) for each in initial.position) + (speed + gravity * time) * time
    momentum = [moment * rate for moment, rate in zip(begin.moments, begin.rates, strict=True)]
    rotational = sum(each * rate for each, rate in zip(momentum, begin.rates, strict=True))
    least, most = min(begin.moments), max(begin.moments)
    sizes: dict[Path, dict[str, tuple[Real, str]]] = {
        ("initial",): {
            "kinetic energy": ((mass * speed**2 + rotational) / 2, "J"),
            "angular momentum": (max(map(abs, momentum)), "kg m^2/s"),
        },
        ("body",): {
            "largest moment of inertia": (most, "kg m^2"),
            "smallest moment of inertia, inverted,": (1 / least if least > 0 else MP.inf, "1/(kg m^2)"),
        },
        ("run", "duration"): {
            "distance from the origin at the end": (way, "m"),
            "energy at the end": (mass * ((speed + gravity * time) ** 2 + gravity * way), "J"),
        },
    }
    for path, quantities in sizes.items():
        for name, (value, unit) in quantities.items():
            if value > MAX_SIZE:
                raise Inconsistent((path, f"its {name} is {MP.nstr(value, 3)} {unit}; at most {MAX_SIZE:g} is allowed"))


def solid_shape(table: grammar.AnyBody | grammar.PartTable) -> Shape | None:
    """Return the shape of a body or part; None if it has none."""
    match table:
        case grammar.BrickTable(semi_axes=semi_axes) | grammar.PartTable(shape="brick", semi_axes=tuple(semi_axes)):
            return Brick(semi_axes)
        case grammar.EllipsoidTable(semi_axes=semi_axes) | grammar.PartTable(shape="ellipsoid", semi_axes=tuple(semi_axes)):
            return Ellipsoid(semi_axes)
        case (
            grammar.CylinderTable(radius=radius, half_length=half_length)
            | grammar.PartTable(shape="cylinder", radius=float(radius), half_length=float(half_length))
        ):
            return Cylinder(radius, half_length)
        case grammar.SphereTable(radius=radius) | grammar.PartTable(shape="sphere", radius=float(radius)):
            return Sphere(radius)
        case _:
            return None


class Turned(Protocol):
    """A table with an attitude."""

    @property
    def euler_zxz(self) -> Vector | None:
        """The Euler angles phi, theta, psi (rad)."""

    @property
    def quaternion(self) -> Quaternion | None:
        """The quaternion w, x, y, z."""


def attitude_of(table: Turned, default: Attitude = (1.0, 0.0, 0.0, 0.0)) -> Attitude:
    """Return the attitude that a table gives, or a default one."""
    if table.quaternion is not None:
        return table.quaternion
    return EulerAngles(*table.euler_zxz) if table.euler_zxz else default
