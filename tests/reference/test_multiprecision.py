"""The multiprecision arithmetic that bounds are checked against is itself right: by integration, invariants and derivatives."""

from collections.abc import Sequence

import pytest

from tests.support.cases import a_case
from tests.support.multiprecision.arithmetic import MP, Matrix, cross, dot, norm, vector
from tests.support.multiprecision.attitudes import from_euler_zxz, from_quaternion, quaternion, rates_in_body, skew, turned
from tests.support.multiprecision.flight import Flight, read
from tests.support.multiprecision.rotation import rotation
from tests.support.multiprecision.taylor import integrated

BRICK = ((0.13, 0.0, 0.0), (0.0, 0.05, 0.0), (0.0, 0.0, 0.1))
TURNED = ((2.0, 0.3, 0.1), (0.3, 1.5, 0.2), (0.1, 0.2, 1.0))
#: 1e-30 is what the study asks for, and far above the 1e-35 that the series leave out.
EXACT = MP.mpf("1e-30")


def distance(one: Matrix, other: Matrix) -> float:
    return float(MP.mnorm(one - other, "f"))


@pytest.mark.parametrize(
    ("inertia", "rates"),
    [
        pytest.param(TURNED, (1.0, 2.0, -3.0), id="in any frame, about the axis of the least moment"),
        pytest.param(TURNED, (3.0, 1.0, 0.5), id="in any frame, about the axis of the largest moment"),
        pytest.param(BRICK, (1e-14, 0.3, 4.0), id="next to the separatrix"),
        pytest.param(((4.0, 0.0, 0.0), (0.0, 5.0, 0.0), (0.0, 0.0, 9.0)), (3.0, -1.0, 1.0), id="on the separatrix"),
        pytest.param(((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.5)), (-3.0, 2.0, 0.2), id="a flat symmetric top"),
        pytest.param(((1.5, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.5)), (-3.0, 2.0, 0.2), id="a long symmetric top"),
        pytest.param(((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)), (-3.0, 2.0, 0.2), id="a sphere"),
        pytest.param(BRICK, (0.0, 0.0, -4.0), id="a steady spin"),
    ],
)
def test_the_closed_form_agrees_with_an_integration(inertia: Sequence[Sequence[float]], rates: Sequence[float]) -> None:
    tensor, spin, start = MP.matrix(inertia), vector(rates), from_euler_zxz((0.3, 0.8, -0.4))
    times = (0.0, 0.25, 1.5)
    closed, series = rotation(tensor, start, spin, times), integrated(tensor, start, spin, times)
    for (attitude, seen), (other_attitude, other_seen) in zip(closed, series, strict=True):
        assert distance(attitude, other_attitude) < EXACT
        assert distance(seen, other_seen) < EXACT


def test_a_million_radians_leave_energy_and_angular_momentum_as_they_are() -> None:
    flight = read(
        a_case(body={"mass": 1.0, "inertia": TURNED, "shape": "none"}, initial={"angular_velocity": [1.0, 2.0, -3.0]})
    )
    for moment in flight.motion((1e-3, 1.0, 3e5)):
        seen = flight.inertia * moment.angular_velocity
        assert distance(moment.attitude * seen, flight.angular_momentum) < EXACT
        assert abs(dot(moment.angular_velocity, seen) / 2 - flight.energy) < EXACT
        assert distance(moment.attitude * moment.attitude.T, MP.eye(3)) < EXACT


def test_attitude_and_rates_obey_the_equations_of_motion_after_a_million_radians() -> None:
    flight = read(
        a_case(body={"mass": 1.0, "inertia": TURNED, "shape": "none"}, initial={"angular_velocity": [1.0, 2.0, -3.0]})
    )
    h = MP.mpf("1e-40")  # central differences are wrong by h^2
    before, now, after = flight.motion((3e5 - h, MP.mpf(3e5), 3e5 + h))
    rates = now.angular_velocity
    assert distance((after.attitude - before.attitude) / (2 * h), now.attitude * skew(rates)) < EXACT
    torque = flight.inertia * (after.angular_velocity - before.angular_velocity) / (2 * h)
    assert distance(torque, cross(flight.inertia * rates, rates)) < EXACT


def test_particles_make_the_moments_of_exact_sums() -> None:
    heavy = [{"mass": 5.0, "position": [sign * 0.5, 1.0, sign * 0.25]} for sign in (1, -1)]
    light = [{"mass": 0.5, "position": [0.0, 1.0 + sign * 0.125, 0.0]} for sign in (1, -1)]
    flight = read(a_case(body={"particles": heavy + light}))
    square = 2 * 0.5 * 0.125**2  # of the light ones, which are on an axis of the body
    expected = (
        (10 * 0.25**2 + square, 0, -10 * 0.5 * 0.25),
        (0, 10 * (0.5**2 + 0.25**2), 0),
        (-10 * 0.5 * 0.25, 0, 10 * 0.5**2 + square),
    )
    assert flight.mass == 11
    assert distance(flight.inertia, MP.matrix(expected)) < EXACT


@pytest.mark.parametrize(
    ("shape", "parts"),
    [
        ({"shape": "brick", "semi_axes": [0.5, 1.0, 2.0]}, [{"shape": "brick", "semi_axes": [0.5, 1.0, 1.0]}] * 2),
        (
            {"shape": "cylinder", "radius": 0.5, "half_length": 2.0},
            [{"shape": "cylinder", "radius": 0.5, "half_length": 1.0}] * 2,
        ),
    ],
)
def test_two_halves_make_a_whole(shape: dict[str, object], parts: list[dict[str, object]]) -> None:
    halves = [{**part, "mass": 1.5, "position": [3.0, 2.0, sign]} for part, sign in zip(parts, (1.0, -1.0), strict=True)]
    whole, made = read(a_case(body={**shape, "mass": 3.0})), read(a_case(body={"parts": halves}))
    assert made.mass == whole.mass
    assert distance(made.inertia, whole.inertia) < EXACT


def test_solids_have_the_moments_of_their_integrals() -> None:
    """Slices across K are ellipses whose axes shrink as sqrt(1 - z^2); a z^2 of the solid has the weight of its slice."""
    semi_axes = (0.5, 0.75, 2.0)
    found = read(a_case(body={"shape": "ellipsoid", "semi_axes": semi_axes, "mass": 2.0})).inertia
    weight = MP.mpf(3) / 4  # of a slice, so that all of them make 1
    zz = MP.quad(lambda z: weight * (1 - z * z) * z * z, [-1, 1])
    across = MP.quad(lambda z: weight * (1 - z * z) ** 2 / 4, [-1, 1])  # an ellipse has the mean square a^2/4 along its axis a
    x, y, z = (2 * mean * a * a for mean, a in zip((across, across, zz), semi_axes, strict=True))
    assert distance(found, MP.diag((y + z, x + z, x + y))) < EXACT
    ball = read(a_case(body={"shape": "sphere", "radius": 0.75, "mass": 2.0})).inertia
    same = read(a_case(body={"shape": "ellipsoid", "semi_axes": [0.75] * 3, "mass": 2.0})).inertia
    assert distance(ball, same) < EXACT


def test_a_turned_part_has_a_turned_tensor() -> None:
    angles = [0.3, 0.8, -0.4]
    turn = from_euler_zxz(angles)
    solid = {"shape": "brick", "semi_axes": [0.1, 0.3, 0.2], "mass": 1.0}
    alone, part = read(a_case(body=solid)), read(a_case(body={"parts": [{**solid, "euler_zxz": angles}]}))
    assert distance(part.inertia, turn * alone.inertia * turn.T) < EXACT
    same = [float(each) * 3 for each in quaternion(turn)]
    by_quaternion = read(a_case(body={"parts": [{**solid, "quaternion": same}]}))
    assert distance(part.inertia, by_quaternion.inertia) < 1e-16  # the quaternion is one of doubles


@pytest.mark.parametrize("theta", [0.8, -0.8, 0.0, 3.0])
def test_the_rates_of_euler_angles_are_those_of_the_matrix(theta: float) -> None:
    angles, rates, h = (0.3, theta, -0.4), (1.0, -2.0, 3.0), MP.mpf("1e-40")
    late, early = (from_euler_zxz([a + sign * h * b for a, b in zip(angles, rates, strict=True)]) for sign in (1, -1))
    now = from_euler_zxz(angles)
    seen = rates_in_body(now, MP.mpf(-0.4), rates)
    assert distance((late - early) / (2 * h), now * skew(seen)) < EXACT
    if theta > 0:  # then the angles of the matrix are these angles
        assert distance(rates_in_body(now, None, rates), seen) < EXACT


@pytest.mark.parametrize("theta", [0, MP.pi])
def test_where_k_is_vertical_psi_is_the_whole_angle(theta: MP.mpf) -> None:
    attitude = from_euler_zxz((0, theta, 0.7))
    seen = rates_in_body(attitude, None, (1.0, -2.0, 3.0))
    assert distance(seen, rates_in_body(attitude, MP.mpf(0.7), (1.0, -2.0, 3.0))) < EXACT


def test_rotations_have_one_meaning() -> None:
    for parts in ((1.0, 2.0, -3.0, 0.5), (0.1, 2.0, 3.0, 0.5), (0.1, 0.0, 3.0, -5.0), (0.0, 0.0, 0.0, 2.0)):
        matrix = from_quaternion(parts)
        assert distance(from_quaternion(quaternion(matrix)), matrix) < EXACT
    assert distance(turned(vector((0, 0, 0.7))), from_euler_zxz((0.7, 0, 0))) < EXACT
    half = MP.mpf(0.35)
    assert distance(from_quaternion((MP.cos(half), MP.sin(half), 0, 0)), from_euler_zxz((0, 0.7, 0))) < EXACT


def flying(**tables: object) -> Flight:
    return read(a_case(**tables))  # type: ignore[arg-type]


def test_the_translation_is_the_parabola_and_its_energy_constant() -> None:
    flight = flying(initial={"position": [1.0, 2.0, 3.0], "velocity": [-1.0, 0.5, 4.0]}, scene={"gravity": 9.5})
    (moment,) = flight.motion((2.0,))
    assert distance(moment.position, vector((-1.0, 3.0, 3.0 + 8.0 - 19.0))) < EXACT
    assert distance(moment.velocity, vector((-1.0, 0.5, 4.0 - 19.0))) < EXACT
    kinetic = norm(moment.velocity) ** 2 / 2
    assert abs(kinetic + flight.gravity * (moment.position[2] - 3) - flight.energy) < EXACT


def test_a_plane_and_drag_are_refused() -> None:
    for scene in ({"plane": {"friction": 0.5}}, {"drag": {"quadratic": 0.01}}):
        with pytest.raises(ValueError, match="free flight"):
            flying(scene=scene)


def test_a_ratio_that_the_digits_cannot_tell_from_zero_is_refused() -> None:
    with pytest.raises(ValueError, match="too small a ratio"):
        flying(body={"mass": 1.0, "inertia": [1.0, 2.0, 2.5]}, initial={"angular_velocity": [1e-90, 1.0, 0.0]}).motion((1.0,))
