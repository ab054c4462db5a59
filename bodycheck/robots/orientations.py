"""Exact attitudes from the forms of robot models, as unit quaternions (w, x, y, z) from a frame to its parent's axes."""

from collections.abc import Sequence

from bodycheck.reference.exact.inertia import Components
from bodycheck.reference.exact.numbers import MP, Quaternion4, Real, Vector3, vector
from bodycheck.reference.exact.rotations import IDENTITY, matrix, multiply

#: The half turn about x, which is a shortest rotation from z to -z.
HALF_TURN: Quaternion4 = (MP.mpf(0), MP.mpf(1), MP.mpf(0), MP.mpf(0))


def about_axis(axis: Vector3, angle: Real) -> Quaternion4:
    """Return the rotation by an angle (rad) about an axis of any length."""
    x, y, z = axis
    cosine, sine = MP.cos_sin(angle / 2)
    length = MP.sqrt(x * x + y * y + z * z)
    return cosine, sine * x / length, sine * y / length, sine * z / length


def euler(angles: Sequence[Real], sequence: str) -> Quaternion4:
    """Return the product of rotations (rad) about a sequence of axes: of the body if lower case, else fixed in space."""
    turn = IDENTITY
    for angle, letter in zip(angles, sequence, strict=True):
        axis = vector([float(letter.lower() == name) for name in "xyz"])
        step = about_axis(axis, angle)
        turn = multiply(turn, step) if letter.islower() else multiply(step, turn)
    return turn


def from_z(z: Vector3) -> Quaternion4:
    """Return the shortest rotation that turns the axis z into the direction of a vector."""
    x, y, z_part = normed(z)
    if not (x or y):
        return IDENTITY if z_part > 0 else HALF_TURN
    return about_axis((-y, x, MP.mpf(0)), MP.atan2(MP.hypot(x, y), z_part))


def from_axes(x: Vector3, y: Vector3) -> Quaternion4:
    """Return the attitude whose x axis has the direction of `x`, and whose y axis that of `y` less its part along `x`."""
    x = normed(x)
    along = sum(a * b for a, b in zip(x, y, strict=True))
    a, b, c = (component - along * part for component, part in zip(y, x, strict=True))
    y = normed((a, b, c))
    first = from_z((x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]))
    # The remaining rotation is about the third axis; after it, the first axis is x.
    w, i, j, k = first
    back = multiply(multiply((w, -i, -j, -k), (MP.mpf(0), *x)), first)
    return multiply(first, about_axis(vector((0, 0, 1)), MP.atan2(back[2], back[1])))


def normed(v: Vector3) -> Vector3:
    """Return a vector divided by its length."""
    length = MP.sqrt(sum(part * part for part in v))
    x, y, z = (part / length for part in v)
    return x, y, z


def turned_inertia(components: Sequence[Real], attitude: Quaternion4) -> Components:
    """Return the components in the parent frame of an inertia tensor given along axes with an attitude in that frame.

    The components are XX, YY, ZZ, XY, XZ, YZ (kg m^2).
    """
    xx, yy, zz, xy, xz, yz = map(MP.mpf, components)
    if attitude == IDENTITY:
        return xx, yy, zz, xy, xz, yz
    tensor, rows = ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz)), matrix(attitude)

    def component(i: int, j: int) -> Real:
        return sum(rows[i][k] * tensor[k][n] * rows[j][n] for k in range(3) for n in range(3))

    return component(0, 0), component(1, 1), component(2, 2), component(0, 1), component(0, 2), component(1, 2)


def principal_axes(components: Components) -> tuple[Vector3, Quaternion4]:
    """Return the principal moments (kg m^2) of an inertia tensor, the largest first, and the attitude of their axes.

    The components are XX, YY, ZZ, XY, XZ, YZ (kg m^2). Axes of equal moments are some of the possible ones.
    """
    xx, yy, zz, xy, xz, yz = components
    moments, axes = MP.eigsy(MP.matrix([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]))
    largest, middle, least = sorted(range(3), key=lambda index: moments[index], reverse=True)
    x, y = ((axes[0, index], axes[1, index], axes[2, index]) for index in (largest, middle))
    return (moments[largest], moments[middle], moments[least]), from_axes(x, y)
