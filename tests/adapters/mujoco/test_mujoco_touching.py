"""MuJoCo's contacts of bodies that roll, rest, slide down, bounce, are pushed and bear each other."""

import io
import math
import runpy
from contextlib import redirect_stdout
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bodycheck.adapters import offers
from bodycheck.adapters.contract import EngineDiverged, Method, SceneUnsupported
from bodycheck.adapters.mujoco import engine as adapter
from bodycheck.adapters.mujoco.touching import damping_ratio
from bodycheck.reference.mechanisms.mechanism import WORLD, Mechanism, PairContact
from bodycheck.reference.scene import Brick, Cylinder, Ellipsoid, Plane, Push, Scene, Shape, Sphere, State
from bodycheck.reference.trajectory import Array
from tests.support.touching import (
    BALL,
    CUBE,
    DOWNHILL,
    GRAVITY,
    INCLINE,
    MASS,
    OF_BALL,
    OF_CUBE,
    RADIUS,
    downhill,
    lying,
    on,
    several,
)

#: A plane on which round bodies roll.
SLOPE = Plane(1.0, incline=INCLINE)

METHODS = offers.offered(adapter.engine, Scene(OF_BALL, State((0.0, 0.0, 1.0)), GRAVITY, Plane(0.5)))


def states(scene: Scene | Mechanism, spelling: str, duration: float, timestep: float = 0.002) -> Array:
    """States (n, bodies, 13) after every step."""
    strides = np.ones(round(duration / timestep), dtype=np.int64)
    return np.asarray(adapter.prepare([scene], Method.parse(spelling, timestep)).advance(strides)[0])


@pytest.mark.parametrize("spelling", METHODS)
def test_a_block_without_friction_slides_down_as_it_must(spelling: str) -> None:
    seen = states(on(Plane(0.0, incline=INCLINE), OF_CUBE), spelling, 1.0)[-1, 0]
    # Every integrator has constant accelerations without an error; a thousand additions round.
    assert downhill(seen) == pytest.approx(DOWNHILL, rel=1e-12)


@pytest.mark.parametrize("spelling", METHODS)
@pytest.mark.parametrize(
    ("scene", "part"),
    [(several([(BALL, (0.0, 0.0, RADIUS))], SLOPE), 5 / 7), (lying(SLOPE), 2 / 3)],
    ids=["ball", "cylinder"],
)
def test_round_bodies_roll_down(spelling: str, scene: Mechanism, part: float) -> None:
    # The soft friction lets the point of contact creep, by 0.08 % of the speed for a ball.
    assert downhill(states(scene, spelling, 1.0)[-1, 0]) == pytest.approx(part * DOWNHILL, rel=3e-3)


@pytest.mark.parametrize("spelling", METHODS)
def test_a_block_stays_where_friction_holds_it_and_slides_where_it_does_not(spelling: str) -> None:
    held = states(on(Plane(2 * math.tan(INCLINE), incline=INCLINE), OF_CUBE), spelling, 1.0)[-1, 0]
    assert abs(downhill(held)) < 1e-2  # creep is what a figure tells; here it must not slide
    slips = states(on(Plane(0.5 * math.tan(INCLINE), incline=INCLINE), OF_CUBE), spelling, 1.0)[-1, 0]
    # Convex friction lifts a block that slides, which then falls back: 2 % within this second.
    assert downhill(slips) == pytest.approx(DOWNHILL / 2, rel=0.05)


@pytest.mark.parametrize("spelling", METHODS)
def test_a_fall_is_that_of_the_integrator_until_the_impact(spelling: str) -> None:
    timestep, steps, above = 0.002, 200, 1.0
    fallen = states(on(Plane(0.5, restitution=0.5), OF_BALL, RADIUS + above), spelling, steps * timestep)[-1, 0]
    duration = steps * timestep
    late = 0.0 if spelling.startswith("RK4") else GRAVITY * duration * timestep / 2
    assert fallen[9] == pytest.approx(-GRAVITY * duration, rel=1e-13)
    assert fallen[2] == pytest.approx(RADIUS + above - GRAVITY * duration**2 / 2 - late, rel=1e-13)


def test_pushes_accelerate_and_turn_between_their_instants() -> None:
    force, arm, begin, until = (3.0, -2.0, 0.0), (0.0, 0.05, 0.0), 0.2, 0.5
    floating = Scene(OF_BALL, State((0.0, 0.0, 5.0)), 0.0, Plane(0.5))
    push = Push(force, start=begin, end=until)
    for spelling in METHODS:
        central = states(replace(floating, pushes=(push,)), spelling, 0.8)
        # The steps that begin at 0.2 s and after, and before 0.5 s, are pushed.
        assert central[99, 0, 7:10] == pytest.approx(0, abs=0)
        assert central[249, 0, 7:10] == pytest.approx(np.array(force) * (until - begin) / MASS, rel=1e-12)
        assert central[-1, 0, 7:10] == pytest.approx(central[249, 0, 7:10], rel=1e-14)
        beside = states(replace(floating, pushes=(replace(push, force=(3.0, 0.0, 0.0), point=arm),)), spelling, 0.8)
        assert beside[-1, 0, 7:10] == pytest.approx(np.array([3.0, 0.0, 0.0]) * 0.3 / MASS, rel=1e-12, abs=1e-15)
        # The first step turns a ball at rest by the whole torque, point x force, about -z.
        assert beside[100, 0, 12] == pytest.approx(-arm[1] * 3.0 * 0.002 / OF_BALL.moments[2], rel=1e-5)


def test_two_pushes_at_once_add_and_samples_do_not_depend_on_how_far_apart_they_are() -> None:
    pushes = (Push((1.0, 0.0, 0.0), end=0.301), Push((0.0, 2.0, 0.0), (0.1, 0.0, 0.0), 0.1, 0.2))
    scene = Scene(OF_BALL, State((0.0, 0.0, 5.0)), 0.0, Plane(0.5), pushes=pushes)
    dense = states(scene, "RK4", 0.4)
    coarse = adapter.prepare([scene], Method.parse("RK4", 0.002)).advance(np.array([0, 50, 50, 100, 0]))[0]
    assert coarse[1:] == pytest.approx(dense[[49, 99, 199, 199]], abs=0)
    assert coarse[0, 0, 7:] == pytest.approx(0, abs=0)
    assert dense[-1, 0, 7:9] == pytest.approx([0.3 / MASS, 0.2 / MASS], rel=1e-12)  # 0.301 s is nearest to the step at 0.3 s


def test_pairs_have_their_own_friction_and_bodies_their_order() -> None:
    blocks = [(CUBE, (0.0, y, RADIUS)) for y in (-1.0, 0.0, 1.0)]
    own = (PairContact((WORLD, 0), 0.0, 0.0), PairContact((WORLD, 2), 2.0, 0.0))
    for spelling in METHODS:
        seen = states(several(blocks, Plane(0.5 * math.tan(INCLINE), incline=INCLINE), contacts=own), spelling, 0.5)[-1]
        assert seen[:, 1] == pytest.approx([-1.0, 0.0, 1.0], abs=1e-6)
        # The middle one slides with the friction of the plane, within what convex friction does to it.
        assert downhill(seen) == pytest.approx(np.array([1.0, 0.5, 0.0]) * DOWNHILL * 0.5, rel=0.05, abs=1e-2)


def test_a_block_on_a_block_has_the_friction_of_this_pair() -> None:
    """The lower one is held on the ramp, and the upper one slides down it without friction."""
    stack = several([(Brick((1.0, 1.0, 0.1)), (0.0, 0.0, 0.1)), (CUBE, (0.0, 0.0, 0.3))], Plane(1.0, incline=INCLINE))
    seen = states(replace(stack, contacts=(PairContact((0, 1), 0.0, 0.0),)), "Euler", 0.4)[-1]
    assert downhill(seen) == pytest.approx([0.0, 0.4 * DOWNHILL], rel=0.02, abs=1e-2)


@pytest.mark.parametrize("spelling", METHODS)
def test_the_loads_of_a_stack_are_the_weights_above(spelling: str) -> None:
    stack = several([(CUBE, (0.0, 0.0, RADIUS * (2 * place + 1))) for place in range(3)], Plane(0.5))
    loads = adapter.interface_loads(stack, Method.parse(spelling, 0.002), 500)
    assert set(loads) == {(WORLD, 0), (0, 1), (1, 2)}
    mean = {pair: float(load[400:].mean()) for pair, load in loads.items()}
    weight = MASS * GRAVITY
    # MuJoCo's solver stops at a tolerance of 1e-8 of its own scale; loads swing by less than a thousandth after 0.8 s.
    assert mean == pytest.approx({(WORLD, 0): 3 * weight, (0, 1): 2 * weight, (1, 2): weight}, rel=1e-3)


def test_loads_are_those_under_the_pushes() -> None:
    """A cube that is pushed down for some time, with half its weight."""
    pushed = on(Plane(0.5), OF_CUBE, pushes=(Push((0.0, 0.0, -MASS * GRAVITY / 2), start=0.5, end=1.0),))
    (load,) = adapter.interface_loads(pushed, Method.parse("Euler", 0.002), 750).values()
    for window, part in ((slice(200, 250), 1.0), (slice(450, 500), 1.5), (slice(700, 750), 1.0)):
        assert load[window].mean() == pytest.approx(part * MASS * GRAVITY, rel=1e-3)


def test_the_damping_of_a_bounce_gives_back_what_is_asked_for() -> None:
    """A spring with a damper that only pushes, integrated until it would pull."""
    for wanted in (1.0, 0.9, 0.5, math.exp(-2), 0.05):
        zeta = damping_ratio(wanted)
        t = np.linspace(0, 12, 400_001)
        rate = np.sqrt(complex(zeta * zeta - 1 + 1e-12))
        velocity = (np.exp(-zeta * t) * (np.cosh(rate * t) - zeta / rate * np.sinh(rate * t))).real
        # x'' < 0 while it pushes; the first instant at which the velocity back is largest.
        assert -velocity.min() == pytest.approx(wanted, abs=1e-8)


@pytest.mark.parametrize("spelling", METHODS)
def test_bounces_are_those_of_the_coefficient_where_it_is_asked_for(spelling: str) -> None:
    mark = "," if ":" in spelling else ":"
    for coefficient in (0.5, 0.9, 1.0):
        for pair in (False, True):
            plane = Plane(0.5, restitution=0.0 if pair else coefficient)
            scene = several([(BALL, (0.0, 0.0, 0.5 + RADIUS))], plane)
            if pair:
                scene = replace(scene, contacts=(PairContact((WORLD, 0), 0.5, coefficient),))
            velocity = states(scene, f"{spelling}{mark}restitution=solref", 0.45)[:, 0, 9]
            part = -velocity.max() / velocity.min()
            if spelling == "discrete":  # it takes the spring and the damper from the state after the step, and loses a fifth
                assert 0.75 * coefficient < part < coefficient
            else:  # the contact lasts 20 steps, and its damping is taken from the velocity before the step
                assert part == pytest.approx(coefficient, abs=0.02)


def test_scripts_make_the_steps_of_runs_to_the_last_bit(tmp_path: Path) -> None:
    method, steps = Method.parse("Euler:cone=elliptic", 0.002), [0, 50, 50, 50]
    push = Push((1.0, 0.5, 0.0), body=0)
    alone = on(Plane(0.5, incline=INCLINE), OF_CUBE, pushes=(push,))
    stack = several([(CUBE, (0.0, 0.0, RADIUS)), (BALL, (0.0, 0.0, 3 * RADIUS))], Plane(0.5), pushes=(push,))
    programs = {
        "alone": (alone, adapter.script(alone, method, 0.3, 4)),
        "stack": (stack, adapter.script(stack, method, 0.3, 4)),
    }
    for name, (scene, program) in programs.items():
        (tmp_path / f"{name}.py").write_text(program)
        with redirect_stdout(io.StringIO()) as printed:
            runpy.run_path(str(tmp_path / f"{name}.py"))
        expected = adapter.prepare([scene], method).advance(np.array(steps))[0]
        rows = [line.split(",")[-13:] for line in printed.getvalue().splitlines()[1:]]
        np.testing.assert_array_equal(np.array(rows, dtype=float).reshape(expected.shape), expected, err_msg=name)
    with pytest.raises(SceneUnsupported, match="begin later"):
        adapter.script(replace(alone, pushes=(replace(push, end=0.1),)), method, 0.3, 4)


def test_there_is_no_choice_of_models() -> None:
    scene = several([(CUBE, (0.0, 0.0, RADIUS))], Plane(0.5))
    assert adapter.models(on(Plane(0.5), OF_BALL, 1.0), "Euler") == {}
    assert adapter.models(scene, "Euler") == {}


def test_what_is_refused() -> None:
    bouncing = on(Plane(0.5, restitution=0.5), OF_BALL, 1.0)
    refused = {
        "Euler:model=contact": bouncing,
        "Euler:solref=0.003 1": bouncing,
        "Euler:restitution=solref,solref=0.02 1": bouncing,
        "Euler:restitution=solref": on(Plane(0.5), OF_BALL, 1.0),
        "RK4:restitution=solref": on(Plane(0.5, restitution=0.001), OF_BALL, 1.0),
        "Euler": on(Plane(1e-7), OF_BALL, 1.0),
        "RK4": on(Plane(0.5), replace(OF_BALL, shape=None), 1.0),
    }
    for spelling, scene in refused.items():
        with pytest.raises(SceneUnsupported):
            adapter.prepare([scene], Method.parse(spelling, 0.002))


def test_options_change_contacts() -> None:
    """Each of these changes how a cube that is dropped on an edge comes to rest."""
    edge = (math.cos(0.4), math.sin(0.4), 0.0, 0.0)
    dropped = Scene(OF_CUBE, State((0.0, 0.0, 0.3), edge, (0.5, 0.0, 0.0)), GRAVITY, Plane(0.5))
    plain = states(dropped, "Euler", 0.6)[-1]
    options = ("cone=elliptic", "impratio=5", "condim=4", "condim=1", "solref=0.01 1", "solref=-5000 -100", "noslip=3")
    for option in (*options, "solimp=0.95 0.99 0.001"):
        assert (states(dropped, f"Euler:{option}", 0.6)[-1] != plain).any(), option
    assert (states(dropped, "Euler:multiccd=enable", 0.6)[-1] == plain).all()  # plane and box are not found by optimisation
    assert "has no option" in (offers.not_offered(adapter.engine, dropped, Method.parse("Euler:pads=3", 1e-3)) or "")


def test_what_diverges_is_reported_with_the_states_before() -> None:
    """A force that overflows from a step in the middle of a stretch on."""
    scene = on(Plane(0.5), OF_BALL, 1.0, pushes=(Push((0.0, 0.0, 1e305), start=0.1),))
    simulation = adapter.prepare([scene], Method.parse("Euler", 0.002))
    with pytest.raises(EngineDiverged) as caught:
        simulation.advance(np.array([0, 20, 20, 20, 20]))
    assert caught.value.states.shape == (1, 4, 1, 13)
    assert np.isfinite(caught.value.states[0, :3]).all()


@pytest.mark.parametrize("shape", [BALL, CUBE, Cylinder(0.1, 0.2), Ellipsoid((0.1, 0.2, 0.15))])
def test_every_shape_comes_to_rest_on_the_plane(shape: Shape) -> None:
    scene = several([(shape, (0.0, 0.0, 0.3)), (shape, (0.0, 1.0, 0.3))], Plane(0.5))
    seen = states(scene, "Euler", 1.0)
    lowest = {Sphere: 0.1, Brick: 0.1, Cylinder: 0.2, Ellipsoid: 0.15}[type(shape)]
    # Bodies sink in by about g timeconst^2 / 20 = 0.2 mm.
    assert seen[-1, :, 2] == pytest.approx(lowest, abs=1e-3)
    assert seen[-1, 0, [0, 2]] == pytest.approx(seen[-1, 1, [0, 2]], abs=1e-9)
