"""The witness of a mechanism by its Lagrangian."""

import ast
from dataclasses import replace

import numpy as np
import pytest
import sympy

from bodycheck.reference.mechanisms import exact, kinematics, observables
from bodycheck.reference.mechanisms.coordinates import JointMotion
from bodycheck.reference.mechanisms.lagrangian import solution
from bodycheck.reference.mechanisms.lagrangian.border import border
from bodycheck.reference.mechanisms.lagrangian.differentiation import Tape, along, made
from bodycheck.reference.mechanisms.lagrangian.equations import derived, parts_of
from bodycheck.reference.mechanisms.lagrangian.mass_matrix import mass_matrix
from bodycheck.reference.mechanisms.lagrangian.poses import WideMotion
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, JointedBody, Mechanism
from bodycheck.reference.scene import Brick, EulerAngles, Given, Particle, Solid, Sphere
from bodycheck.reference.trajectory import Array, Trajectory
from tests.support import ROOT
from tests.support.jointed import body, cart_pole, tree

#: A random state for the comparison with SymPy.
RANDOM = np.random.default_rng(22)


def accelerations(mechanism: Mechanism, q: Array, u: Array) -> Array:
    """The derivatives of the velocities of joints with one coordinate each, by the equations of the module."""
    ready = solution.prepared(mechanism)
    found = derived(ready.structure)
    length, time = ready.units.length, ready.units.time
    sizes = np.array([length if element.kind == "slide" else 1.0 for element in ready.border.elements])
    leaves = {
        "number": lambda value: float(value),
        "parameter": lambda place: float(ready.parameters[place]),
        "variable": lambda place: float(np.concatenate([q / sizes, u * time / sizes])[place]),
    }
    rates = made(found.tape, found.rates, lambda kind, value: leaves[kind](value), np.sin, np.cos)
    return np.asarray(np.array(rates[len(q) :]) * sizes / time**2)


def euler_lagrange(
    energy: sympy.Expr, coordinates: list[sympy.Symbol], rates: list[sympy.Symbol], forces: list[sympy.Expr], q: Array, u: Array
) -> Array:
    """The solution of the Euler-Lagrange equations of L for the second derivatives, by SymPy."""
    momenta = [sympy.diff(energy, rate) for rate in rates]
    matrix = sympy.Matrix(momenta).jacobian(rates)
    moved = sympy.Matrix(momenta).jacobian(coordinates) * sympy.Matrix(rates)
    right = sympy.Matrix([sympy.diff(energy, own) + force for own, force in zip(coordinates, forces, strict=True)]) - moved
    values = dict(zip([*coordinates, *rates], [*q, *u], strict=True))
    solution = matrix.subs(values).evalf(30).LUsolve(right.subs(values).evalf(30))
    return np.array(solution, dtype=float)[:, 0]


def test_the_equations_of_the_cart_and_pole_are_those_that_sympy_derives() -> None:
    mechanism = cart_pole()
    x, theta, dx, dtheta = sympy.symbols("x theta dx dtheta")
    cart, pole = 2.3, 0.4
    # The pole's centre is 0.35 m from the pin along its z, which turns about y by theta.
    vx, vz = dx + 0.35 * dtheta * sympy.cos(theta), -0.35 * dtheta * sympy.sin(theta)
    energy = (
        cart * dx**2 / 2
        + pole * (vx**2 + vz**2) / 2
        + sympy.Float(0.017) * dtheta**2 / 2
        - pole * 9.81 * 0.35 * sympy.cos(theta)
    )
    q, u = RANDOM.normal(size=2), RANDOM.normal(size=2)
    expected = euler_lagrange(energy, [x, theta], [dx, dtheta], [sympy.Integer(0)] * 2, q, u)
    # Some tens of roundings of double precision.
    np.testing.assert_allclose(accelerations(mechanism, q, u), expected, rtol=1e-13)


def double_pendulum() -> Mechanism:
    """Two bodies with everything that a hinge can have, but dry friction."""
    return Mechanism(
        (body("upper", 1.3, (0.2, 0.3, 0.25), (0.0, 0.0, -0.4)), body("lower", 0.7, (0.1, 0.15, 0.2), (0.0, 0.0, -0.3))),
        (
            Joint(
                "a", "revolute", WORLD, 0, axis=(0.0, 2.0, 0.0), armature=0.05, damping=0.3, start=(0.5,), start_velocity=(0.1,)
            ),
            Joint(
                *("b", "revolute", 0, 1, (0.0, 0.0, -0.9)),
                axis=(0.0, 1.0, 0.0),
                stiffness=2.0,
                rest=0.25,
                effort=-0.6,
                start=(-0.8,),
                start_velocity=(0.9,),
            ),
        ),
        gravity=9.5,
    )


def test_the_equations_of_the_double_pendulum_are_those_that_sympy_derives() -> None:
    a, b, da, db = sympy.symbols("a b da db")
    total, rate = a + b, da + db
    upper = 1.3 * (0.4 * da) ** 2 / 2 + 0.3 * da**2 / 2
    vx, vz = -0.9 * da * sympy.cos(a) - 0.3 * rate * sympy.cos(total), 0.9 * da * sympy.sin(a) + 0.3 * rate * sympy.sin(total)
    lower = 0.7 * (vx**2 + vz**2) / 2 + 0.15 * rate**2 / 2
    height = 1.3 * -0.4 * sympy.cos(a) + 0.7 * (-0.9 * sympy.cos(a) - 0.3 * sympy.cos(total))
    energy = upper + lower + 0.05 * da**2 / 2 - 9.5 * height - 2.0 * (b - 0.25) ** 2 / 2 - 0.6 * b
    q, u = RANDOM.normal(size=2), RANDOM.normal(size=2)
    expected = euler_lagrange(energy, [a, b], [da, db], [-0.3 * da, sympy.Integer(0)], q, u)
    # Some tens of roundings of double precision.
    np.testing.assert_allclose(accelerations(double_pendulum(), q, u), expected, rtol=1e-13)


TIMES = np.linspace(0.0, 1.0, 11)


@pytest.fixture(scope="module")
def moved() -> WideMotion:
    """The tree with a joint of every type, in double precision, which every platform has."""
    return solution.follow_in_doubles(tree(), TIMES)


def in_doubles(motion: WideMotion) -> Trajectory:
    states = motion.position, motion.quaternion, motion.velocity, motion.angular_velocity
    return Trajectory(TIMES, *(values.astype(float) for values in states))


def test_the_motion_of_every_type_of_joint_keeps_energy_and_angular_momentum(moved: WideMotion) -> None:
    seen = observables.observe(tree(), in_doubles(moved))
    # An integration in double precision; a wrong sign of any term of the equations shows in the first digits.
    np.testing.assert_allclose(seen.total_energy, seen.total_energy[0], rtol=1e-11)
    floating = [0, 1, 2, 3, 4]  # what hangs on the free body
    mass = observables.masses(tree())[floating, None, None]
    motion = in_doubles(moved)
    centre = (mass * motion.position[floating]).sum(axis=0) / mass.sum()
    fall = centre[0] + TIMES[:, None] * (mass * motion.velocity[floating, :1]).sum(axis=0) / mass.sum()
    fall[:, 2] -= 3.7 * TIMES**2 / 2
    np.testing.assert_allclose(centre, fall, atol=1e-12)


def test_bodies_and_joints_of_a_motion_belong_together(moved: WideMotion) -> None:
    motion = in_doubles(moved)
    joints = JointMotion(moved.joint_position.astype(float), moved.joint_velocity.astype(float))
    free = Trajectory(
        TIMES, *(values[1:2] for values in (motion.position, motion.quaternion, motion.velocity, motion.angular_velocity))
    )
    other = kinematics.bodies(tree(), joints, free, TIMES)
    # Some tens of roundings of double precision.
    np.testing.assert_allclose(other.position, motion.position, atol=1e-13)
    np.testing.assert_allclose(other.velocity, motion.velocity, atol=1e-12)
    np.testing.assert_allclose(other.angular_velocity, motion.angular_velocity, atol=1e-12)
    np.testing.assert_allclose(np.abs((other.quaternion * motion.quaternion).sum(axis=-1)), 1.0, atol=1e-13)


def test_velocities_are_the_derivatives_of_positions() -> None:
    step = 1e-3
    near = solution.follow_in_doubles(tree(), np.array([0.4 - 2 * step, 0.4 - step, 0.4, 0.4 + step, 0.4 + 2 * step]))
    first, second, _, fourth, fifth = np.moveaxis(near.position, 1, 0)
    slope = (8 * (fourth - second) - (fifth - first)) / (12 * step)
    # The formula of fourth order leaves step^4 times a fifth derivative of some thousands.
    np.testing.assert_allclose(slope, near.velocity[:, 2], atol=1e-8)


def test_taylor_and_dop853_follow_the_same_motion(moved: WideMotion) -> None:
    pytest.importorskip("heyoka")
    wide = solution.follow(tree(), TIMES)
    # The errors of DOP853.
    np.testing.assert_allclose(moved.position, wide.position.astype(float), atol=1e-10)
    np.testing.assert_allclose(moved.joint_position, wide.joint_position.astype(float), atol=1e-10)


def test_dop853_follows_dry_friction_as_taylor_does() -> None:
    pytest.importorskip("heyoka")
    plain = cart_pole()
    rubbing = Mechanism(plain.bodies, (replace(plain.joints[0], friction=0.1), plain.joints[1]), gravity=9.81)
    double, wide = solution.follow_in_doubles(rubbing, TIMES), solution.follow(rubbing, TIMES)
    # The errors of DOP853.
    np.testing.assert_allclose(double.joint_position, wide.joint_position.astype(float), atol=1e-12)


def test_the_mass_matrix_is_the_derivative_of_the_momenta() -> None:
    """M is formed apart from the momenta; what is wrong in one of them makes du/dt depend on u in the wrong way."""
    ready = solution.prepared(tree())
    tape, structure = Tape(), ready.structure
    parts = parts_of(tape, structure)
    entries = mass_matrix(tape, structure.parents, structure.places, parts.solids)
    columns = {j: along(tape, {parts.velocities[j]: tape.one}, parts.momenta) for j in range(len(parts.velocities))}
    values = [*(float(value) for value in ready.start), *(float(value) for value in ready.parameters)]
    count = len(ready.start)
    leaves = {
        "number": lambda value: float(value),
        "parameter": lambda place: values[count + place],
        "variable": lambda place: values[place],
    }
    pairs = [node for (i, j), entry in entries.items() for node in (entry, columns[j][i])]
    found = made(tape, pairs, lambda kind, value: leaves[kind](value), np.sin, np.cos)
    # Some tens of roundings of entries of the order of one.
    np.testing.assert_allclose(found[::2], found[1::2], atol=1e-13)
    assert len(entries) > 100


def test_the_witness_shares_no_code_with_the_recursion() -> None:
    room = ROOT / "reference" / "mechanisms"
    allowed = ("mechanism", "control", "lagrangian.", "lagrangian")
    for path in (room / "lagrangian").glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            module = (node.module or "") if isinstance(node, ast.ImportFrom) else ""
            own = module.removeprefix("bodycheck.reference.")
            assert not own.startswith("exact"), f"{path.name} imports {module}"
            if own.startswith("mechanisms."):
                assert own.removeprefix("mechanisms.").startswith(allowed), f"{path.name} imports {module}"


@pytest.mark.parametrize(
    "made_of",
    [
        (Particle(0.3, (0.1, 0.2, -0.3)), Particle(0.7, (0.4, -0.5, 0.6))),
        (
            Solid(Brick((0.1, 0.2, 0.3)), 0.7, (0.1, 0.0, -0.1), EulerAngles(0.3, 0.4, 0.5)),
            Solid(Sphere(0.2), 0.3, (-0.2, 0.1, 0.4)),
        ),
        Solid(Brick((0.1, 0.2, 0.3)), 0.7, (0.1, 0.2, -0.1), (0.9, 0.1, -0.3, 0.2)),
    ],
    ids=["particles", "solids", "solid"],
)
def test_the_witness_reads_a_body_as_the_recursion_does(made_of: Given) -> None:
    one = JointedBody("one", made_of)
    expected = exact.inertia(one)
    hinge = Joint("hinge", "revolute", WORLD, 0, axis=(0.0, 0.0, 1.0), start=(0.0,), start_velocity=(0.0,))
    (carried,) = border(Mechanism((one,), (hinge,))).elements[0].carried
    xx, yy, zz, xy, xz, yz = expected.tensor
    rows = [xx, xy, xz, xy, yy, yz, xz, yz, zz]
    # Both have a hundred digits.
    assert max(abs(a - b) for a, b in zip([v for row in carried.tensor for v in row], rows, strict=True)) < 1e-90
    assert max(abs(a - b) for a, b in zip(carried.centre, expected.centre, strict=True)) < 1e-90
    assert abs(carried.mass - expected.mass) < 1e-90
