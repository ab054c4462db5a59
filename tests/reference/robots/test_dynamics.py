"""The terms of robot models: against equations of textbooks, the recursion of mechanisms, and what must hold for any model."""

from dataclasses import replace
from random import Random

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from bodycheck.reference.exact.numbers import wide
from bodycheck.reference.kinematics import conjugate, multiply, rotate
from bodycheck.reference.mechanisms import exact
from bodycheck.reference.mechanisms.articulation import articulated
from bodycheck.reference.mechanisms.mechanism import Joint, Mechanism
from bodycheck.reference.mechanisms.tree import forest
from bodycheck.reference.robots.dynamics import terms, terms_at, velocity_labels
from bodycheck.reference.robots.model import RobotJoint, RobotLink, RobotModel, Wide, with_joint, with_link
from bodycheck.reference.robots.rotations import matrices, plane_axes, quaternion, rotation_vector
from bodycheck.reference.robots.state import RobotState
from bodycheck.reference.robots.states import seeded_states
from bodycheck.robots.from_mechanism import robot_model
from tests.support.jointed import ball_and_hinge, ball_chain, cart_pole, tree
from tests.support.robot_steps import array, by_name, later
from tests.support.robot_trees import random_link, random_rotation, random_tree

GRAVITY = (0.3, -0.2, -9.81)
ALL = ("revolute", "prismatic", "fixed", "floating", "planar", "spherical")

#: Some roundings of sums of up to a hundred terms, in the 80-bit type or in double precision.
ROUNDINGS = 1e3 * float(np.finfo(np.longdouble).eps)

#: A time (s) for central differences, and the relative error that they have with it: a rounding divided by it, and its square.
TIME = 1e-6
DIFFERENCE = 1e-9 if np.finfo(np.longdouble).nmant > 52 else 1e-7

models = st.builds(
    lambda seed, joints, floating: random_tree(Random(seed), joints, floating, ALL),
    *(st.integers(0, 2**32), st.integers(1, 12), st.booleans()),
)


def loaded(model: RobotModel) -> RobotModel:
    """The model with all that joints can have."""
    acting = {"armature": 0.3, "damping": 0.7, "friction": 0.2, "stiffness": 1.3}
    return replace(model, joints=tuple(replace(joint, **acting) for joint in model.joints))


def close(one: Wide, other: Wide, tolerance: float, size: float = 0.0) -> None:
    """Fail unless two arrays agree, relative to the largest number in them or to a size."""
    largest = max(size, np.abs(one).max(initial=0), np.abs(other).max(initial=0))
    assert np.abs(one - other).max(initial=0) <= tolerance * largest


@settings(max_examples=20, deadline=None)
@given(models)
def test_the_terms_belong_to_one_equation_of_motion(model: RobotModel) -> None:
    model = loaded(model)
    for state, found in zip(states := seeded_states(model, 2, 5), terms_at(model, states, GRAVITY), strict=True):
        mass, rest = found.mass_matrix, found.coriolis_force + found.gravity_force
        assert np.array_equal(mass, mass.T)
        assert np.linalg.eigvalsh(mass.astype(float)).min() > 0
        acceleration, effort = array(model, state.accelerations), array(model, state.efforts)
        size = np.abs(mass).max() + np.abs(rest).max()
        close(found.inverse_dynamics, mass @ acceleration + rest, ROUNDINGS, size)
        # What is left of the equation is some roundings of its largest terms, however the matrix is conditioned.
        moved = mass @ found.forward_dynamics
        close(moved + rest, effort + found.passive_force, ROUNDINGS, (np.abs(mass) @ np.abs(found.forward_dynamics)).max())
        back = terms(model, replace(state, accelerations=by_name(model, found.forward_dynamics)), GRAVITY)
        close(
            back.inverse_dynamics,
            effort + found.passive_force,
            ROUNDINGS,
            (np.abs(mass) @ np.abs(found.forward_dynamics)).max(),
        )


@settings(max_examples=20, deadline=None)
@given(models)
def test_velocities_of_links_are_the_derivatives_of_their_poses(model: RobotModel) -> None:
    (state,) = seeded_states(model, 1, 3)
    rates = array(model, state.velocities)
    before, here, after = (terms(model, later(model, state, time, rates, 0 * rates), GRAVITY) for time in (-TIME, 0, TIME))
    for name, pose in here.poses.items():
        velocity = here.jacobians[name] @ rates
        close(velocity[:3], (after.poses[name] - before.poses[name])[:3] / (2 * TIME), DIFFERENCE, 1)
        turned = multiply(after.poses[name][None, 3:], conjugate(before.poses[name][None, 3:]))
        close(velocity[3:], rotation_vector(turned)[0] / (2 * TIME), DIFFERENCE, 1)
        assert pose[3:] @ pose[3:] == pytest.approx(1, abs=ROUNDINGS)


@settings(max_examples=20, deadline=None)
@given(models)
def test_the_power_of_all_forces_is_the_change_of_the_energy(model: RobotModel) -> None:
    (state,) = seeded_states(model, 1, 8)
    rates, changes = array(model, state.velocities), array(model, state.accelerations)
    before, after = (energy(model, later(model, state, time, rates, changes)) for time in (-TIME, TIME))
    power = terms(model, state, GRAVITY).inverse_dynamics @ rates
    close((after - before)[None] / (2 * TIME), power[None], DIFFERENCE, 1 + abs(after))


def energy(model: RobotModel, state: RobotState) -> np.longdouble:
    """Kinetic and potential energy (J) from the motion of the links, without the mass matrix."""
    found = terms(model, state, GRAVITY)
    total, rates = np.longdouble(0), array(model, state.velocities)
    for link in model.links:
        pose, twist = found.poses[link.name], found.jacobians[link.name] @ rates
        axes = matrices(pose[None, 3:])[0]
        arm, spin = axes @ link.center_of_mass, twist[3:]
        velocity = twist[:3] + np.cross(spin, arm)
        total += link.mass * (velocity @ velocity / 2 - np.array(GRAVITY) @ (pose[:3] + arm))
        total += spin @ axes @ link.inertia @ axes.T @ spin / 2
    return total


def test_coriolis_forces_follow_from_the_derivatives_of_the_mass_matrix() -> None:
    model = random_tree(Random(7), 5, types=("revolute", "prismatic"))
    (state,) = seeded_states(model, 1, 2)
    rates, count = array(model, state.velocities), len(model.joints)

    def mass(place: int, time: float) -> Wide:
        along = np.eye(count, dtype=np.longdouble)[place]
        return terms(model, later(model, state, time, along, 0 * along), GRAVITY).mass_matrix

    change = np.stack([(mass(k, TIME) - mass(k, -TIME)) / (2 * TIME) for k in range(count)])
    # c_i = sum (dM_ij/dq_k - dM_jk/dq_i / 2) v_j v_k
    christoffel = np.einsum("kij,j,k->i", change, rates, rates) - np.einsum("ijk,j,k->i", change, rates, rates) / 2
    close(terms(model, state, GRAVITY).coriolis_force, christoffel, DIFFERENCE)


def test_a_double_pendulum_obeys_the_equations_of_the_textbook() -> None:
    q, v, a = (sp.symbols(f"{letter}1 {letter}2") for letter in "qva")
    half, m, g = sp.Rational(1, 2), (2, 3), 10
    r, i, length = (half, half / 2), (half / 4, half / 8), sp.Rational(4, 5)
    # In the plane of x and z, hanging at q = 0; a positive turn about y takes -z to -x.
    first, both = q[0], q[0] + q[1]
    place = [(-r[0] * sp.sin(first), -r[0] * sp.cos(first))]
    place += [(-length * sp.sin(first) - r[1] * sp.sin(both), -length * sp.cos(first) - r[1] * sp.cos(both))]
    kinetic = potential = 0
    for body, turning in enumerate((v[0], v[0] + v[1])):
        velocity = [sum(sp.diff(part, q[k]) * v[k] for k in range(2)) for part in place[body]]
        kinetic += m[body] * sum(part**2 for part in velocity) / 2 + i[body] * turning**2 / 2
        potential += m[body] * g * place[body][1]
    mass = sp.hessian(kinetic, v)
    whole = [
        sum(sp.diff(kinetic, v[j], q[k]) * v[k] + sp.diff(kinetic, v[j], v[k]) * a[k] for k in range(2))
        - sp.diff(kinetic, q[j])
        for j in range(2)
    ]
    values = dict(zip((*q, *v, *a), map(sp.Rational, ("3/8", "-5/4", "7/4", "-1/2", "1/4", "3/2")), strict=True))

    def exactly(entries: object) -> Wide:
        return np.array([np.longdouble(str(sp.N(entry.subs(values), 25))) for entry in entries], np.longdouble)

    model = pendulum(m, length, r, i)
    names = ("shoulder", "elbow")
    parts = ({name: (float(values[of[k]]),) for k, name in enumerate(names)} for of in (q, v, a))
    state = RobotState(*parts, {"shoulder": (0.5,), "elbow": (-2.0,)})
    found = terms(model, state, (0.0, 0.0, -10.0))
    gravity, inertial = exactly([sp.diff(potential, angle) for angle in q]), exactly(whole)
    close(found.mass_matrix, exactly(mass).reshape(2, 2), ROUNDINGS)
    close(found.gravity_force, gravity, ROUNDINGS)
    close(found.coriolis_force, inertial - exactly(mass * sp.Matrix(a)), ROUNDINGS)
    close(found.inverse_dynamics, inertial + gravity, ROUNDINGS)
    passive = [-0.5 * 7 / 4 - 0.25 - 2 * (3 / 8 - 0.25), 0.0]
    close(found.passive_force, np.array(passive, np.longdouble), ROUNDINGS)


def pendulum(mass: tuple, length: sp.Rational, centre: tuple, inertia: tuple) -> RobotModel:
    """Two links on joints about y that hang along -z; the first has a spring, damping and friction."""
    origin, turn, y, down = np.zeros(3, np.longdouble), np.eye(3, dtype=np.longdouble), np.eye(3)[1], -np.eye(3)[2]
    links = [RobotLink("ground", 0.0, origin, 0 * turn)]
    for name, m, r, i in zip(("upper", "lower"), mass, centre, inertia, strict=True):
        links.append(RobotLink(name, m, wide_number(r) * down, np.diag(np.array([0, wide_number(i), 0], np.longdouble))))
    acting = {"damping": 0.5, "friction": 0.25, "stiffness": 2.0, "rest": 0.25}
    joints = (
        RobotJoint("shoulder", "revolute", 0, 1, origin, turn, y.astype(np.longdouble), **acting),
        RobotJoint("elbow", "revolute", 1, 2, wide_number(length) * down, turn, y.astype(np.longdouble)),
    )
    return RobotModel("pendulum", tuple(links), joints)


def wide_number(value: sp.Rational) -> np.longdouble:
    """A rational number in the 80-bit type."""
    return np.longdouble(value.p) / np.longdouble(value.q)


@pytest.mark.parametrize(
    "mechanism", [cart_pole(), tree(), ball_chain(), ball_and_hinge()], ids=["cart", "tree", "balls", "hinge"]
)
def test_accelerations_are_those_of_the_recursion_of_mechanisms(mechanism: Mechanism) -> None:
    model = robot_model(mechanism, "mechanism")
    found = terms(model, beginning(mechanism, model), model.gravity)
    known = dict(zip(velocity_labels(model), found.forward_dynamics, strict=True))
    compared = 0
    for name, accelerations in recursion(mechanism).items():
        own = np.array([known[name, k] for k in range(len(accelerations))])
        close(own, accelerations, ROUNDINGS, 10)
        compared += len(own)
    assert compared >= 2


def beginning(mechanism: Mechanism, model: RobotModel) -> RobotState:
    """The initial state of a mechanism, with the constant forces of its joints."""
    (rest,) = seeded_states(model, 1, 0)
    positions, velocities = dict(rest.positions), {name: tuple(0.0 for _ in part) for name, part in rest.velocities.items()}
    efforts = dict(velocities)
    for joint in mechanism.joints:
        for name, own in names_of(joint).items():
            positions[name], velocities[name] = joint.start[own], joint.start_velocity[own]
        if joint.effort:
            efforts[joint.name] = (joint.effort,)
    for body in mechanism.bodies:
        if (start := body.start) is not None:
            turn, spin = (
                np.array(numbers(part)) for part in (exact.turn(start.attitude), exact.rates(start.attitude, start.rotation))
            )
            arm = rotate(turn[None], np.array([numbers(exact.inertia(body).centre)]))
            velocity = np.array(start.velocity) - np.cross(rotate(turn[None], spin[None]), arm)[0]
            positions[body.name], velocities[body.name] = (*start.position, *turn), (*velocity, *spin)
    return RobotState(positions, velocities, rest.accelerations, efforts)


def names_of(joint: Joint) -> dict[str, slice]:
    """The names of the robot model's joints that a joint is, and which coordinates each has."""
    if joint.type == "fixed":
        return {}
    if joint.type == "universal":
        return {f"{joint.name}:{k + 1}": slice(k, k + 1) for k in range(2)}
    return {joint.name: slice(None)}


def recursion(mechanism: Mechanism) -> dict[str, Wide]:
    """The accelerations of the jointed bodies of a mechanism at its start, by the articulated-body recursion."""
    found: dict[str, Wide] = {}
    trees = forest(mechanism)
    for own in trees.trees:
        links = [rounded(link) for link in own.links]
        for link, rates in zip(own.links, articulated.accelerations(links, numbers(own.gravity), np).rates, strict=True):
            joint = mechanism.joints[link.joint]
            if link.joint < 0 or joint.type == "free":
                continue
            if link.kind == "ball":
                turn = np.array([numbers(trees.anchors[joint.child].pose.turn)])
                found[joint.name] = rotate(conjugate(turn), np.array([rates]))[0]
            elif joint.type == "universal":
                found[f"{joint.name}:{link.coordinate + 1}"] = np.array(rates[:1])
            else:
                found[joint.name] = np.append(found.get(joint.name, ()), rates[:1])
    return found


def rounded(link: object) -> articulated.Link:
    """A link of a tree in the 80-bit type."""
    constants = {
        key: numbers(value) if isinstance(value, tuple) else value if isinstance(value, int) else wide(value)
        for key, value in vars(link.constants).items()
    }
    return articulated.Link(
        link.kind, link.parent, articulated.Constants(**constants), numbers(link.coordinates), numbers(link.rates)
    )


def numbers(values: tuple) -> list[np.longdouble]:
    """Exact numbers in the 80-bit type."""
    return [wide(value) for value in values]


def test_the_order_of_the_file_does_not_matter() -> None:
    model = loaded(random_tree(Random(3), 9, True, ALL))
    other = replace(model, joints=model.joints[::-1])
    (state,) = seeded_states(model, 1, 4)
    one, two = terms(model, state, GRAVITY), terms(other, state, GRAVITY)
    order = [velocity_labels(other).index(label) for label in velocity_labels(model)]
    close(one.mass_matrix, two.mass_matrix[np.ix_(order, order)], ROUNDINGS)
    for name in ("gravity_force", "coriolis_force", "passive_force", "forward_dynamics", "inverse_dynamics"):
        close(getattr(one, name), getattr(two, name)[order], ROUNDINGS)
    for link in model.links:
        close(one.jacobians[link.name], two.jacobians[link.name][:, order], ROUNDINGS)


def test_a_state_has_the_same_terms_alone_and_among_others() -> None:
    model = random_tree(Random(5), 6, True, ALL)
    states = seeded_states(model, 3, 6)
    among, alone = terms_at(model, states, GRAVITY)[1], terms(model, states[1], GRAVITY)
    close(among.mass_matrix, alone.mass_matrix, ROUNDINGS)
    close(among.forward_dynamics, alone.forward_dynamics, ROUNDINGS)


def test_what_no_body_can_have_is_computed_up_to_the_accelerations() -> None:
    model = random_tree(Random(1), 4, types=("revolute",))
    (state,) = seeded_states(model, 1, 1)
    negative = with_link(model, "link_3", mass=-20.0)
    found = terms(negative, state, GRAVITY)
    assert found.forward_dynamics is None
    assert np.isfinite(found.mass_matrix).all()
    assert np.isfinite(found.inverse_dynamics).all()
    massless = replace(model, links=tuple(replace(link, mass=0.0, inertia=0 * link.inertia) for link in model.links))
    assert terms(massless, state, GRAVITY).forward_dynamics is None
    assert terms(with_link(model, "link_3", mass=float("nan")), state, GRAVITY).forward_dynamics is None


def test_joints_that_are_no_tree_are_refused() -> None:
    model = random_tree(Random(2), 3)
    twice = replace(model, joints=(*model.joints, replace(model.joints[0], name="again")))
    with pytest.raises(ValueError, match="two joints"):
        terms_at(twice, seeded_states(twice, 1, 0), GRAVITY)


def test_armature_is_added_to_the_mass_matrix_alone() -> None:
    model = random_tree(Random(4), 5, types=("revolute",))
    states = seeded_states(model, 1, 0)
    (bare,), (geared,) = (terms_at(other, states, GRAVITY) for other in (model, with_joint(model, "joint_2", armature=0.5)))
    place = velocity_labels(model).index(("joint_2", 0))
    expected = np.zeros_like(bare.mass_matrix)
    expected[place, place] = 0.5
    close(geared.mass_matrix - bare.mass_matrix, expected, ROUNDINGS, np.abs(bare.mass_matrix).max())
    assert np.array_equal(geared.coriolis_force, bare.coriolis_force)
    inertial = geared.inverse_dynamics - bare.inverse_dynamics
    close(inertial, expected @ array(model, states[0].accelerations), ROUNDINGS, np.abs(bare.inverse_dynamics).max())


def test_a_spring_of_a_ball_turns_back_by_the_shorter_way() -> None:
    origin, turn = np.zeros(3, np.longdouble), np.eye(3, dtype=np.longdouble)
    joint = RobotJoint("ball", "spherical", 0, 1, origin, turn, origin, stiffness=2.0)
    model = RobotModel("ball", (RobotLink("ground", 0.0, origin, 0 * turn), random_link(Random(0), "body")), (joint,))
    # Three quarters of a turn about z are a quarter turn back.
    three = (np.cos(3 * np.pi / 4), 0.0, 0.0, np.sin(3 * np.pi / 4))
    still = {"ball": (0.0, 0.0, 0.0)}
    found = terms(model, RobotState({"ball": three}, still, still, still), GRAVITY).passive_force
    # The angle is that of doubles.
    close(found, np.array([0, 0, np.pi], np.longdouble), 1e-15)


def test_rotations_have_their_quaternions_and_planes_their_axes() -> None:
    random = Random(9)
    for _ in range(20):
        rotation = random_rotation(random)
        close(matrices(quaternion(rotation)[None])[0], rotation, ROUNDINGS)
        normal = rotation[2]
        axes = plane_axes(normal)
        close(axes[:, 2], normal, ROUNDINGS)
        close(axes.T @ axes, np.eye(3, dtype=np.longdouble), ROUNDINGS)
        assert np.cross(axes[:, 0], axes[:, 1]) @ normal > 0.9
    assert np.array_equal(plane_axes(np.array([0, 0, 1], np.longdouble)), np.eye(3))
    assert np.array_equal(plane_axes(np.array([0, 0, -1], np.longdouble)), np.diag([1, -1, -1]))
