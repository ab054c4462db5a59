"""A body on a plane as its case file states it: along the axes of the plane, x downhill and z along its normal."""

import tomllib
from dataclasses import dataclass
from decimal import Decimal
from typing import Any

from tests.judge.numerals import (
    IDENTITY,
    ONE,
    ZERO,
    Matrix,
    Vector,
    about,
    applied,
    attitude,
    exact,
    product,
    sine_cosine,
    times,
    transposed,
)
from tests.judge.solids import Inertia, inertia_of
from tests.judge.states import State

#: Distances and speeds from a contact, relative to sizes and speeds, that a file's decimals leave of a body that touches.
TOUCHES = Decimal("1e-12")


@dataclass(frozen=True)
class OnPlane:
    """A body over or on a plane.

    Attributes
    ----------
    table
        The table of the body.
    inertia
        Its mass and tensor.
    axes
        The rotation that takes components along the plane's axes to those of the world.
    position, velocity, turn, spin
        Its state at the start: position and velocity of the centre of mass, attitude, angular velocity, along the plane's axes.
    gravity
        Acceleration along the axes of the plane.
    friction
        Coulomb's coefficient; None for a plane without slip.
    restitution
        The ratio of normal speeds.
    duration
        The length of the run (s).
    pushes
        The tables of the pushes.
    plane
        The table of the plane.
    """

    table: dict[str, Any]
    inertia: Inertia
    axes: Matrix
    position: Vector
    velocity: Vector
    turn: Matrix
    spin: Vector
    gravity: Vector
    friction: Decimal | None
    restitution: Decimal
    duration: Decimal
    pushes: list[dict[str, Any]]
    plane: dict[str, Any]

    def in_world(self, position: Vector, velocity: Vector, turn: Matrix, spin: Vector) -> State:
        """Return a state in the world, from one along the axes of the plane."""
        along_body = applied(transposed(turn), spin)
        return State(applied(self.axes, position), applied(self.axes, velocity), product(self.axes, turn), along_body)


def on_plane(text: str) -> OnPlane:
    """Return the body of a case file of format 1 with a plane."""
    document = tomllib.loads(text)
    scene, start, table = document["scene"], document.get("initial", {}), document["body"]
    plane = scene["plane"]
    incline = exact(plane.get("incline", 0))
    axes = about((ZERO, ONE, ZERO), *sine_cosine(incline))
    back = transposed(axes)
    given = "euler_zxz" in start or "quaternion" in start
    turn = product(back, attitude(start)) if given else IDENTITY
    position = applied(back, exact(start.get("position", (0, 0, 0))))
    if "position" not in start:
        position = (ZERO, ZERO, support(table, turn))
    friction = plane.get("friction", 0)
    return OnPlane(
        table,
        inertia_of(table),
        axes,
        position,
        applied(back, exact(start.get("velocity", (0, 0, 0)))),
        turn,
        applied(turn, exact(start.get("angular_velocity", (0, 0, 0)))),
        applied(back, (ZERO, ZERO, -exact(scene.get("gravity", 0)))),
        None if friction == "no-slip" else exact(friction),
        exact(plane.get("restitution", 0)),
        exact(document["run"]["duration"]),
        scene.get("push", []),
        plane,
    )


def support(table: dict[str, Any], turn: Matrix) -> Decimal:
    """Return the height of the centre of a body of a shape that touches a plane; turn: attitude along the plane's axes."""
    up = turn[2]
    radius: Decimal = exact(table.get("radius", 0))
    match table["shape"]:
        case "sphere":
            return radius
        case "cylinder":
            half_length: Decimal = exact(table["half_length"])
            across: Decimal = (up[0] * up[0] + up[1] * up[1]).sqrt()
            return radius * across + half_length * abs(Decimal(up[2]))
        case "brick":
            return sum((abs(part) * edge for part, edge in zip(up, exact(table["semi_axes"]), strict=True)), ZERO)
        case _:
            squares = (part * part * edge * edge for part, edge in zip(up, exact(table["semi_axes"]), strict=True))
            return sum(squares, ZERO).sqrt()


def lying(body: OnPlane, size: Decimal) -> bool:
    """Return whether a body touches its plane and stays on it; size: a length of it."""
    speed = max(abs(part) for part in (*body.velocity, *times(size, body.spin)))
    gap: Decimal = body.position[2] - support(body.table, body.turn)
    sinking: Decimal = body.velocity[2]
    return abs(gap) <= TOUCHES * size and abs(sinking) <= TOUCHES * max(speed, TOUCHES)
