"""Which scheme an engine is: real engines are named, what is no textbook scheme is not, and what rounding may do is a bound."""

from dataclasses import replace
from functools import cache

import mujoco
import numpy as np
import pytest

from bodycheck import Case, compare, load, simulate, truth
from bodycheck.adapters.contract import Method
from bodycheck.judging.schemes.identification import SAME_ROUNDINGS, Identification, identify
from bodycheck.judging.schemes.scheme_rounding import ROUNDOFF, STEP_ROUNDINGS, allowance
from bodycheck.reference.kinematics import geodesic_angle
from bodycheck.reference.scene import State
from bodycheck.reference.schemes.catalogue import CATALOGUE
from bodycheck.reference.schemes.formulations import Equations, Formulation, body_twist, world_velocity
from bodycheck.reference.schemes.increments import Increment, Pair, Pose, add_scaled, add_scaled_pair, cross, scale_pair, turn
from bodycheck.reference.schemes.one_step import Scheme, semi_implicit_euler, step_through
from bodycheck.reference.trajectory import Trajectory
from bodycheck.reference.truth import at
from bodycheck.reference.truths import Truth
from bodycheck.results.outcome import Completed, Diverged, Run
from bodycheck.running.instants import sampling_steps
from tests.support.cases import shortened

DOUBLE = ROUNDOFF["float64"]
SAME_RAD = SAME_ROUNDINGS * DOUBLE

SEMI_IMPLICIT, LINEARLY_IMPLICIT = "semi-implicit Euler", "linearly implicit Euler"
AVERAGED, MUNTHE_KAAS = "averaged Runge-Kutta 4", "Runge-Kutta-Munthe-Kaas 4"

SORTS = ["explicit Euler", SEMI_IMPLICIT, LINEARLY_IMPLICIT, "implicit midpoint", AVERAGED, MUNTHE_KAAS]

ENGINES = {
    ("mujoco", "Euler"): SEMI_IMPLICIT,
    ("mujoco", "implicit"): LINEARLY_IMPLICIT,
    ("mujoco", "implicitfast"): LINEARLY_IMPLICIT,
    ("mujoco", "discrete"): LINEARLY_IMPLICIT,
    ("mujoco", "RK4"): MUNTHE_KAAS,
    ("pinocchio", "semi-implicit-euler"): SEMI_IMPLICIT,
    ("pinocchio", "body-twist-euler"): SEMI_IMPLICIT + " on the body twist",
    ("pinocchio", "rk4"): MUNTHE_KAAS + " on the body twist",
    ("pinocchio", "rk4-naive"): AVERAGED + " on the body twist",
}

FLIP, COMPLEX = load("intermediate-axis-flip"), load("osrf-boxes-complex")
#: In its place, unturned.
SPUN = State(angular_velocity=COMPLEX.scene.initial.angular_velocity)

BRIEF = {case.name: shortened(case, 1.0, 51) for case in (FLIP, COMPLEX)}


@cache
def truth_of(case: Case) -> Truth:
    return truth(case)


def found(case: Case, run: Run) -> Identification:
    identification = identify(case, run, at(truth_of(case), run.outcome.trajectory.t), DOUBLE)
    assert identification is not None
    return identification


def simulated(case: Case, engine: str, integrator: str, *timesteps: float) -> Run:
    """The run with the first of some time steps with which it completes."""
    runs = (simulate(case, engine, integrator, timestep) for timestep in timesteps)
    return next(run for run in runs if isinstance(run.outcome, Completed))


def miniature(case: Case, scheme: Scheme, timestep: float, formulation: Equations = world_velocity) -> Run:
    """A run of an engine that steps the exact equations by a scheme of its own."""
    steps = sampling_steps(case.instants, timestep)
    states = step_through(scheme, formulation, case.scene, timestep, np.diff(steps, prepend=0))
    return of_states(case, states, steps, timestep)


def of_states(case: Case, states: np.ndarray, steps: np.ndarray, timestep: float) -> Run:
    trajectory = Trajectory(steps * timestep, *np.split(states, [3, 7, 10], axis=1))
    return Run(case.name, "miniature", "1.0", Method.parse("own", timestep), Completed(trajectory, int(steps[-1]), 1.0))


@pytest.mark.parametrize(
    "timesteps",
    [
        pytest.param((0.02, 0.01, 0.005), id="coarsest"),
        pytest.param((0.01, 0.005), id="10ms", marks=pytest.mark.slow),
        pytest.param((0.002,), id="2ms"),
    ],
)
@pytest.mark.parametrize("case", [FLIP, COMPLEX], ids=lambda case: case.name)
@pytest.mark.parametrize(("engine", "integrator"), ENGINES)
def test_engines_are_the_schemes_that_they_are(timesteps: tuple[float, ...], case: Case, engine: str, integrator: str) -> None:
    if len(timesteps) < 3:
        case = BRIEF[case.name]
    run = simulated(case, engine, integrator, *timesteps)
    identification = found(case, run)
    assert identification.scheme == ENGINES[engine, integrator]
    assert identification.early <= SAME_RAD / 100  # some 1e-14 rad: a thousand times less than is asked for
    assert identification.residual <= identification.allowed
    nearest, *others = identification.candidates
    assert nearest.fits
    assert not any(other.fits for other in others)
    # What the scheme explains: nearly all of the discrepancy in the position too, where there is any.
    errors = compare(truth_of(case), run).maxima()
    assert identification.position_residual <= max(1e-3 * errors["position_error"], 1e-12)


@pytest.mark.parametrize(("engine", "integrator"), ENGINES)
def test_drag_is_part_of_the_scheme(engine: str, integrator: str) -> None:
    identification = found(load("football-drag"), simulate(load("football-drag"), engine, integrator, 0.01))
    assert identification.scheme == ENGINES[engine, integrator]
    # It flies at 20 m/s: 2 s of rounding.
    assert identification.position_residual < 1e-11


@pytest.mark.parametrize(("engine", "integrator"), ENGINES)
def test_a_body_in_a_frame_of_its_own(engine: str, integrator: str) -> None:
    body = replace(COMPLEX.scene.body, axes=(0.5, 0.1, -0.7, 0.5))
    case = replace(BRIEF[COMPLEX.name], scene=replace(COMPLEX.scene, body=body))
    assert found(case, simulate(case, engine, integrator, 0.01)).scheme == ENGINES[engine, integrator]


def test_a_body_that_stays_in_its_place_tells_no_formulation() -> None:
    case = replace(BRIEF[COMPLEX.name], scene=replace(COMPLEX.scene, initial=SPUN, gravity=0.0))
    identification = found(case, simulate(case, "pinocchio", "body-twist-euler", 0.01))
    assert identification.scheme == SEMI_IMPLICIT
    assert identification.position_residual == 0


def test_on_a_ball_joint_mujocos_fast_implicit_integrator_is_another_scheme() -> None:
    """It knows the derivative of the gyroscopic torque for a free joint only."""
    case = replace(BRIEF[COMPLEX.name], scene=replace(COMPLEX.scene, initial=SPUN, gravity=0.0))
    steps = sampling_steps(case.instants, 0.01)
    moments = " ".join(map(repr, case.scene.body.moments))
    for integrator, scheme in {"implicitfast": SEMI_IMPLICIT, "implicit": LINEARLY_IMPLICIT}.items():
        model = mujoco.MjModel.from_xml_string(
            f"""<mujoco><option timestep="0.01" gravity="0 0 0" integrator="{integrator}"/><worldbody><body>
            <joint type="ball"/><inertial pos="0 0 0" mass="10" diaginertia="{moments}"/></body></worldbody></mujoco>"""
        )
        data = mujoco.MjData(model)
        data.qvel[:] = SPUN.angular_velocity
        states = np.zeros((len(steps), 13))
        for row, stride in zip(states, np.diff(steps, prepend=0).tolist(), strict=True):
            mujoco.mj_step(model, data, nstep=stride)
            row[3:7], row[10:] = data.qpos, data.qvel
        assert found(case, of_states(case, states, steps, 0.01)).scheme == scheme


def heun(motion: Formulation, pose: Pose, v: Pair, h: float) -> tuple[Pose, Pair]:
    a = motion.acceleration(pose, v)
    after = add_scaled_pair(v, h, a)
    b = motion.acceleration(motion.displace(pose, scale_pair(h, v)), after)
    end = add_scaled_pair(v, h / 2, add_scaled_pair(a, 1.0, b))
    return motion.displace(pose, scale_pair(h / 2, add_scaled_pair(v, 1.0, after))), end


def explicit_midpoint(motion: Formulation, pose: Pose, v: Pair, h: float) -> tuple[Pose, Pair]:
    middle = add_scaled_pair(v, h / 2, motion.acceleration(pose, v))
    a = motion.acceleration(motion.displace(pose, scale_pair(h / 2, v)), middle)
    return motion.displace(pose, scale_pair(h, middle)), add_scaled_pair(v, h, a)


def kutta_3(motion: Formulation, pose: Pose, v: Pair, h: float) -> tuple[Pose, Pair]:
    """Kutta's scheme of the third order, brought to the group as Munthe-Kaas does."""
    u1, a1 = v, motion.acceleration(pose, v)
    half, v2 = scale_pair(h / 2, u1), add_scaled_pair(v, h / 2, a1)
    u2, a2 = motion.rate(pose, half, v2), motion.acceleration(motion.displace(pose, half), v2)
    whole, v3 = add_scaled_pair(scale_pair(-h, u1), 2 * h, u2), add_scaled_pair(add_scaled_pair(v, -h, a1), 2 * h, a2)
    u3, a3 = motion.rate(pose, whole, v3), motion.acceleration(motion.displace(pose, whole), v3)
    u, a = (add_scaled_pair(add_scaled_pair(one, 4.0, two), 1.0, three) for one, two, three in ((u1, u2, u3), (a1, a2, a3)))
    return motion.displace(pose, scale_pair(h / 6, u)), add_scaled_pair(v, h / 6, a)


def three_eighths(motion: Formulation, pose: Pose, v: Pair, h: float) -> tuple[Pose, Pair]:
    """Kutta's other scheme of the fourth order, the 3/8 rule, brought to the group likewise."""

    def slope(u: Pair, velocity: Pair) -> tuple[Pair, Pair]:
        return motion.rate(pose, u, velocity), motion.acceleration(motion.displace(pose, u), velocity)

    def third(one: Pair, two: Pair) -> Pair:
        return add_scaled_pair(scale_pair(-h / 3, one), h, two)

    def fourth(one: Pair, two: Pair, three: Pair) -> Pair:
        return scale_pair(h, add_scaled_pair(add_scaled_pair(one, -1.0, two), 1.0, three))

    def mean(one: Pair, two: Pair, three: Pair, four: Pair) -> Pair:
        return scale_pair(h / 8, add_scaled_pair(add_scaled_pair(one, 3.0, add_scaled_pair(two, 1.0, three)), 1.0, four))

    u1, a1 = slope(((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)), v)
    u2, a2 = slope(scale_pair(h / 3, u1), add_scaled_pair(v, h / 3, a1))
    u3, a3 = slope(third(u1, u2), add_scaled_pair(v, 1.0, third(a1, a2)))
    u4, a4 = slope(fourth(u1, u2, u3), add_scaled_pair(v, 1.0, fourth(a1, a2, a3)))
    return motion.displace(pose, mean(u1, u2, u3, u4)), add_scaled_pair(v, 1.0, mean(a1, a2, a3, a4))


def truncated(motion: Formulation, pose: Pose, v: Pair, h: float) -> tuple[Pose, Pair]:
    """Munthe-Kaas with the series of dexp^-1 cut off as far as order 4 allows: after the second bracket."""

    def rate(_pose: Pose, u: Increment, velocity: Pair) -> Increment:
        x, y, z = u[1]
        once = cross((x, y, z), velocity[1])
        return velocity[0], add_scaled(add_scaled(velocity[1], 1 / 2, once), 1 / 12, cross((x, y, z), once))

    return CATALOGUE[MUNTHE_KAAS].scheme(replace(motion, rate=rate), pose, v, h)


def wrong_torque(motion: Formulation, pose: Pose, v: Pair, h: float) -> tuple[Pose, Pair]:
    """Semi-implicit Euler with the gyroscopic torque turned round."""
    linear, angular = motion.acceleration(pose, v)
    v = add_scaled_pair(v, h, (linear, scale_pair(-1.0, (angular, angular))[0]))
    return motion.displace(pose, scale_pair(h, v)), v


def torque_left_out(motion: Formulation, pose: Pose, v: Pair, h: float) -> tuple[Pose, Pair]:
    v = add_scaled_pair(v, h, (motion.acceleration(pose, v)[0], (0.0, 0.0, 0.0)))
    return motion.displace(pose, scale_pair(h, v)), v


@pytest.mark.parametrize("scheme", [three_eighths, truncated, wrong_torque])
@pytest.mark.parametrize("case", BRIEF.values(), ids=BRIEF)
@pytest.mark.parametrize("timestep", [0.02, 0.01])
def test_what_is_not_in_the_list_gets_no_name(timestep: float, case: Case, scheme: Scheme) -> None:
    identification = found(case, miniature(case, scheme, timestep))
    assert identification.scheme == ""
    assert identification.early > SAME_RAD
    assert not identification.cannot_tell


@pytest.mark.parametrize(
    ("scheme", "name"),
    [
        (heun, "averaged Heun 2"),
        (explicit_midpoint, "averaged explicit midpoint"),
        (kutta_3, "Munthe-Kaas with Kutta 3"),
        (torque_left_out, "no gyroscopic torque"),
    ],
)
@pytest.mark.parametrize("timestep", [0.02, 0.001])
def test_schemes_that_are_written_out_are_named(timestep: float, scheme: Scheme, name: str) -> None:
    case = shortened(FLIP, 1.0, 51)
    identification = found(case, miniature(case, scheme, timestep))
    assert identification.scheme == identification.nearest == name
    assert [candidate.fits for candidate in identification.candidates].count(True) == 1


def test_nor_does_what_only_rounding_could_excuse() -> None:
    """At 200 m/s, spatial algebra might round the spin by as much as a scheme's own difference: then no name is given."""
    fast = replace(COMPLEX.scene, initial=replace(SPUN, velocity=(200.0, 0.0, 0.0)), gravity=0.0)
    case = replace(BRIEF[COMPLEX.name], scene=fast)
    identification = found(case, miniature(case, truncated, 0.01))
    assert identification.cannot_tell
    assert identification.early > SAME_RAD


def test_nor_does_a_scheme_that_leaves_a_tenth_of_the_discrepancy() -> None:
    """Of two schemes of the fourth order at a small step, seen but three times: less apart than rounding may be."""
    spin = load("short-axis-spin")
    case = shortened(replace(spin, scene=replace(spin.scene, gravity=0.0)), 2.0, 4)
    run = miniature(case, three_eighths, 0.002)
    identification = found(case, run)
    assert identification.cannot_tell
    assert identification.early < SAME_RAD
    error = compare(truth_of(case), run).series["attitude_error"]
    allowed = allowance(CATALOGUE[MUNTHE_KAAS].scheme, case.scene, 0.002, run.outcome.trajectory, DOUBLE)
    assert (error > allowed).any()


def test_with_a_small_step_a_good_scheme_is_the_truth() -> None:
    case = shortened(COMPLEX, 0.15, 4)
    identification = found(case, simulate(case, "mujoco", "RK4", 0.0005))
    assert identification.cannot_tell
    assert identification.nearest == ""
    assert {candidate.scheme for candidate in identification.candidates if candidate.fits} > {MUNTHE_KAAS}


def test_fluid_that_meets_the_rotation_is_in_no_scheme() -> None:
    identification = found(load("football-drag"), simulate(load("football-drag"), "mujoco", "Euler:drag=fluid", 0.01))
    assert identification.scheme == ""
    assert identification.nearest == ""
    assert identification.early > 1e-3


@pytest.mark.parametrize("timestep", [0.01, 0.002])
def test_the_truth_is_no_scheme(timestep: float) -> None:
    """However small the step: where a scheme is as good as exact, the case cannot tell the one from the other."""
    case = shortened(COMPLEX, 0.25, 26)
    steps = sampling_steps(case.instants, timestep)
    motion = truth_of(case).at(steps * timestep).trajectory
    states = np.hstack([motion.position, motion.quaternion, motion.velocity, motion.angular_velocity])
    identification = found(case, of_states(case, states, steps, timestep))
    assert identification.scheme == identification.nearest == ""
    # Schemes of the fifth and the sixth order are as good as exact.
    assert identification.cannot_tell


@pytest.mark.parametrize(
    ("name", "integrator"), [("projectile", "Euler"), ("osrf-boxes-simple", "implicit"), ("football-spiral", "RK4")]
)
def test_a_steady_spin_tells_no_schemes_apart(name: str, integrator: str) -> None:
    case = shortened(load(name), 1.0, 11)
    identification = found(case, simulate(case, "mujoco", integrator, 0.01))
    assert identification.cannot_tell
    fitting = {candidate.scheme for candidate in identification.candidates if candidate.fits}
    assert fitting >= {SEMI_IMPLICIT, LINEARLY_IMPLICIT, AVERAGED, MUNTHE_KAAS, "Munthe-Kaas with Heun 2"}
    # A linear update of the quaternion turns the body by 2 atan(h w / 2), and not by h w.
    assert ("semi-implicit Euler with linear quaternions" in fitting) == (name == "projectile")
    assert identification.position_residual < 1e-12  # of the nearest: one of them is what it is


@pytest.mark.parametrize("name", ["osrf-boxes-simple", "football-spiral"])
@pytest.mark.parametrize("integrator", ["body-twist-euler", "rk4", "rk4-naive"])
def test_unless_the_position_does(name: str, integrator: str) -> None:
    """On the body twist a spin bends the path, and every scheme bends it in its own way."""
    case = shortened(load(name), 1.0, 11)
    identification = found(case, simulate(case, "pinocchio", integrator, 0.01))
    assert identification.scheme == ENGINES["pinocchio", integrator]
    assert [candidate.fits for candidate in identification.candidates].count(True) > 10


def test_nor_does_a_position_that_is_nearly_that_of_a_scheme() -> None:
    case = shortened(load("football-spiral"), 1.0, 11)
    steps = sampling_steps(case.instants, 0.01)
    states = step_through(semi_implicit_euler, body_twist, case.scene, 0.01, np.diff(steps, prepend=0))
    assert found(case, of_states(case, states, steps, 0.01)).scheme == SEMI_IMPLICIT + " on the body twist"
    states[:, 0] += 1e-6 * steps
    assert found(case, of_states(case, states, steps, 0.01)).cannot_tell


def test_a_translation_of_its_own_is_said_of_the_name() -> None:
    def ballistic(motion: Formulation, pose: Pose, v: Pair, h: float) -> tuple[Pose, Pair]:
        (_, attitude), after = semi_implicit_euler(motion, pose, v, h)
        return (add_scaled(pose[0], h / 2, add_scaled(v[0], 1.0, after[0])), attitude), after

    identification = found(COMPLEX, miniature(COMPLEX, ballistic, 0.01))
    assert identification.scheme == "semi-implicit Euler in rotation"
    assert identification.position_residual == pytest.approx(COMPLEX.scene.gravity * 0.01 / 2 * 10)


def test_two_samples_are_enough() -> None:
    case = shortened(COMPLEX, 1.0, 2)
    assert found(case, simulate(case, "pinocchio", "rk4-naive", 0.01)).scheme == AVERAGED + " on the body twist"
    assert found(case, miniature(case, three_eighths, 0.01)).scheme == ""


def test_schemes_that_fail_do_not_matter() -> None:
    """At 13 rad/s and 200 ms both Euler's leave the numbers, and the midpoint's equations are not solved."""
    spun = replace(FLIP, scene=replace(FLIP.scene, initial=State(angular_velocity=(0.0, 0.1, 13.0))))
    case = shortened(spun, 8.0, 41)
    run = simulate(case, "mujoco", "implicit", 0.2)
    identification = found(case, run)
    assert identification.scheme == LINEARLY_IMPLICIT
    failed = {candidate.scheme for candidate in identification.candidates if candidate.residual == np.inf}
    assert failed >= {"explicit Euler", SEMI_IMPLICIT, "implicit midpoint"}
    # Where a scheme fails, rounding may be anything; no angle is more than half a turn.
    assert allowance(semi_implicit_euler, case.scene, 0.2, run.outcome.trajectory, DOUBLE)[-1] == np.pi


def test_no_scheme_is_tried_on_a_plane() -> None:
    case = load("sliding-brick")
    assert identify(case, simulate(case, "pinocchio", "law-force", 0.01), truth(case), DOUBLE) is None


def test_a_run_without_a_trajectory_is_refused() -> None:
    run = Run(FLIP.name, "miniature", "1.0", Method.parse("own", 0.01), Diverged("not a number"))
    with pytest.raises(ValueError, match="its status is diverged: not a number"):
        identify(FLIP, run, truth_of(FLIP), DOUBLE)


@pytest.mark.parametrize("name", SORTS)
def test_rounding_stays_within_its_allowance(name: str) -> None:
    """Errors of the size that is allowed in each step, a thousand times over so that they stand out of the real ones."""
    amplified = 1e3
    case = replace(COMPLEX, scene=replace(COMPLEX.scene, initial=State(angular_velocity=(0.1, 5.0, 0.1)), gravity=0.0))
    random = np.random.default_rng(5)

    def noisy(motion: Formulation, pose: Pose, v: Pair, h: float) -> tuple[Pose, Pair]:
        (position, attitude), (linear, angular) = CATALOGUE[name].scheme(motion, pose, v, h)
        (a, b, c), (p, q, r) = directions = random.normal(size=(2, 3))
        size = amplified * STEP_ROUNDINGS * DOUBLE / np.linalg.norm(directions, axis=1)
        spin = float(np.linalg.norm(angular))
        attitude = turn(attitude, (size[0] * a, size[0] * b, size[0] * c))
        return (position, attitude), (linear, add_scaled(angular, spin * float(size[1]), (p, q, r)))

    plain, rounded = (
        miniature(case, scheme, 0.01, CATALOGUE[name].rotation).outcome for scheme in (CATALOGUE[name].scheme, noisy)
    )
    assert isinstance(plain, Completed)
    assert isinstance(rounded, Completed)
    apart = geodesic_angle(plain.trajectory.quaternion, rounded.trajectory.quaternion)
    allowed = amplified * allowance(
        CATALOGUE[name].scheme, case.scene, 0.01, plain.trajectory, DOUBLE, CATALOGUE[name].rotation
    )
    assert (apart <= allowed).all()
    # Nor is the bound an idle one: of the sum of 1000 errors, all in one direction and the worst, those in random directions
    # make about one part in the root of 1000, and the directions take about as much again.
    assert apart[-1] > 1e-3 * allowed[-1]
