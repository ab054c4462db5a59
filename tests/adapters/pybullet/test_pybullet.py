"""PyBullet's two solvers: their schemes, PyBullet's own damping and limits, and the contact of a box."""

import math
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pandas as pd
import pybullet
import pytest

from bodycheck import compare, load, simulate, truth
from bodycheck.adapters import registry
from bodycheck.adapters.contract import Method
from bodycheck.adapters.links import Link, link_of
from bodycheck.reference.kinematics import rotate
from bodycheck.reference.scene import Body, Brick, Plane, Scene, State
from bodycheck.reference.sliding.motion import slide
from bodycheck.reference.trajectory import Array
from tests.support import ROOT
from tests.support.orders import observed_order

PYBULLET = registry.load("pybullet")
INTEGRATORS = ("maximal", "multibody")
TUMBLING = Scene(Body(2.0, (0.3, 0.4, 0.6)), State(angular_velocity=(3.0, 1.0, 2.0), velocity=(0.0, 2.0, 0.0)))


def rows(scene: Scene, spelling: str, timestep: float, strides: list[int]) -> Array:
    """The states (n, 13) of a scene after each of n strides."""
    return PYBULLET.prepare([scene], Method.parse(spelling, timestep)).advance(np.array(strides))[0, :, 0]


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("case", ["intermediate-axis-flip", "football-drag"])
def test_both_solvers_are_of_first_order(integrator: str, case: str) -> None:
    orders = observed_order(PYBULLET, load(case).scene, integrator, (2e-3, 1e-3, 5e-4), 1.0)
    # What remains of the next term of the error, which is of the order of the time step, is below 0.03 at these steps.
    np.testing.assert_allclose(list(orders.values()), 1, atol=0.05)


def test_the_steps_of_both_solvers_are_those_that_the_adapter_says() -> None:
    """A linearly implicit Euler step of the body rates, and an explicit one of the angular velocity in the world frame."""
    h, moments = 0.01, np.array(TUMBLING.body.moments)
    spin = np.array(TUMBLING.initial.angular_velocity)
    torque = -np.cross(spin, moments * spin)
    cross = np.cross(spin, np.eye(3)).T  # column k is spin x e_k
    jacobian = np.diag(moments) + h * (cross * moments - np.cross(moments * spin, np.eye(3)).T)
    world = {
        "maximal": spin + h * np.linalg.solve(jacobian, torque),
        "multibody": spin + h * torque / moments,
    }
    for integrator, expected in world.items():
        row = rows(TUMBLING, integrator, h, [1])[0]
        # Some roundings of numbers of the order of one. The body turns with the new angular velocity about that same axis.
        np.testing.assert_allclose(rotate(row[3:7], row[10:]), expected, rtol=1e-13)
        angle = h * np.linalg.norm(expected)
        turned = [math.cos(angle / 2), *(math.sin(angle / 2) * expected / np.linalg.norm(expected))]
        np.testing.assert_allclose(row[3:7], turned, atol=1e-14)


@pytest.mark.parametrize(("integrator", "row"), [("maximal", "bullet"), ("multibody", "ode")])
def test_the_box_benchmark_of_2015_is_reproduced(integrator: str, row: str) -> None:
    """Bullet's published row is that of its rigid bodies; its multibodies have the scheme of ODE's row."""
    case, h = load("osrf-boxes-complex"), 1e-3
    case = replace(case, samples=round(case.duration / h) + 1)  # the published errors are maxima over all steps
    measured = compare(truth(case), simulate(case, "pybullet", integrator, h)).maxima()
    anchors = pd.read_csv(ROOT / "tests" / "data" / "osrf_boxes_complex_2015.csv", comment="#")
    anchor = anchors[(anchors.engine == row) & np.isclose(anchors.timestep, h)].iloc[0]
    names = ["position_error", "angular_momentum_drift", "energy_drift"]
    # Published to six digits from C++ code with its own box inertia and rounding; two schemes differ by 5 per cent.
    np.testing.assert_allclose([measured[name] for name in names], anchor[names].astype(float), rtol=3e-4)


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_what_the_scene_does_not_have_is_switched_off(integrator: str) -> None:
    fast = Scene(Body(2.0, (0.3, 0.3, 0.3)), State(velocity=(300.0, 0.0, 0.0), angular_velocity=(0.0, 150.0, 0.0)))
    last = rows(fast, integrator, 1e-3, [1000])[0]
    # A thousand roundings; damping or a limit would take away at least some percent.
    np.testing.assert_allclose(last[7:], [300, 0, 0, 0, 150, 0], rtol=1e-12, atol=1e-9)
    np.testing.assert_allclose(last[:3], [300, 0, 0], atol=1e-9)


def test_pybullets_own_settings_damp_and_limit_a_body() -> None:
    """The damping is du/dt = -0.04 (1 + |u|) u, for u the velocity or the angular velocity; no component exceeds 100."""
    slow = Scene(Body(2.0, (0.3, 0.3, 0.3)), State(velocity=(2.0, 0.0, 0.0), angular_velocity=(0.0, 0.0, 3.0)))
    last = rows(slow, "multibody:settings=engine", 1e-3, [1000])[0]
    for speed, start in ((last[7], 2.0), (last[12], 3.0)):
        remaining = start / (1 + start) * math.exp(-0.04)
        # Euler's error is h/2 times the second derivative, some 0.04^2 (1 + 2u) (1 + u) u < 0.2.
        assert speed == pytest.approx(remaining / (1 - remaining), abs=1e-4)
    fast = replace(slow, initial=State(velocity=(300.0, 0.0, 0.0), angular_velocity=(0.0, 150.0, 0.0)))
    first = rows(fast, "multibody:settings=engine", 1e-3, [1])[0]
    # PyBullet cuts velocities before it damps them or afterwards; a step damps by 0.04 (1 + 300) h = 1.2 % at most.
    np.testing.assert_allclose(first[[7, 11]], 100, rtol=0.013)


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_a_straight_slide_ends_where_it_must(integrator: str) -> None:
    scene, h = load("sliding-brick").scene, 1e-3
    last = rows(scene, integrator, h, [600])[0]
    exact = 2.0**2 / (2 * 0.5 * 9.81)
    # Semi-implicit Euler misses v0 h / 2. The box falls onto the ground within the contact's slop of 10 micrometres in two
    # steps, in which friction is missing and then doubled, and ends a hundredth of that earlier or later.
    assert last[0] == pytest.approx(exact - 2.0 * h / 2, abs=3e-5)
    assert last[2] == pytest.approx(0.05, abs=2e-5)
    assert np.abs(last[7:]).max() < 1e-3


def test_a_pure_spin_of_a_rigid_body_has_the_friction_of_four_corners() -> None:
    scene, h = load("spinning-brick-corners").scene, 5e-4
    law = PYBULLET.contact_law(scene, Method.parse("maximal", h))
    exact = slide(replace(scene, plane=law), np.array([0.0, 1.0])).stop
    yaw = rows(scene, "maximal", h, [600])[0]
    # Half a step of the initial spin, and the two steps of the fall onto the ground.
    angle = 2 * math.atan2(yaw[6], yaw[3])
    assert angle == pytest.approx(exact.yaw, abs=1.1 * h / 2 * scene.initial.angular_velocity[2])


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_a_box_stands_on_the_ground_whatever_its_principal_axes_are_called(integrator: str) -> None:
    """The principal axes I, J, K of the inertia are J, K, I of the body, whose K is vertical."""
    sizes, axes = (0.1, 0.2, 0.05), (0.5, 0.5, 0.5, 0.5)
    a, b, c = ((sizes[i] ** 2 + sizes[j] ** 2) / 3 for i, j in ((1, 2), (0, 2), (0, 1)))
    initial = State((0.0, 0.0, 0.05), velocity=(1.0, 0.5, 0.0))
    plain = Scene(Body(1.0, (a, b, c), Brick(sizes)), initial, 9.81, Plane(0.5, "corners"))
    named = replace(plain, body=Body(1.0, (b, c, a), Brick(sizes), axes))
    # Other roundings decide which corner bears more at first: the box turns a little, by up to 0.1 mrad.
    one, other = (rows(scene, integrator, 1e-3, [100])[0] for scene in (plain, named))
    np.testing.assert_allclose(one[:3], other[:3], atol=1e-4)
    assert other[2] == pytest.approx(0.05, abs=2e-5)


def test_the_inertia_of_a_urdf_file_counts_only_with_pybullets_flag() -> None:
    """Without it a link without shapes is a cube of 2 mm, which spins steadily, but for the damping."""
    turned = link_of(replace(TUMBLING.body, axes=(0.76, 0.4, -0.3, 0.4)))
    spins = {}
    for links in ((link_of(TUMBLING.body),), (turned,)):
        for spelling in ("multibody", "multibody:settings=engine"):
            simulation = PYBULLET.prepare_links(links, TUMBLING, Method.parse(spelling, 1e-3))
            row = simulation.advance(np.array([100]))[0, 0, 0]
            spins[links[0] is turned, spelling] = rotate(row[3:7], row[10:])
    expected = rows(TUMBLING, "multibody", 1e-3, [100])[0]
    np.testing.assert_array_equal(spins[False, "multibody"], rotate(expected[3:7], expected[10:]))
    for tensor in (False, True):
        # The damping keeps the direction.
        steady = spins[tensor, "multibody:settings=engine"]
        np.testing.assert_allclose(np.cross(steady, TUMBLING.initial.angular_velocity), 0, atol=1e-12)


@pytest.mark.parametrize("turn", [(1.0, 0.0, 0.0, 0.0), (0.8, 0.6, 0.0, 0.0)])
def test_pybullet_ignores_how_the_frames_of_a_fixed_constraint_are_turned(turn: tuple[float, float, float, float]) -> None:
    """Of two equal bodies at rest in one place, each turns by half of the angle between them."""
    part = Link(1.0, (0.03, 0.04, 0.06, 0.0, 0.0, 0.0))
    scene = Scene(Body(2.0, (1.0, 1.0, 1.0)), State())
    simulation = PYBULLET.prepare_links((part, replace(part, quaternion=turn)), scene, Method.parse("maximal", 1e-3))
    row = simulation.advance(np.array([200]))[0, 0, 0]
    # After 200 steps, each of which corrects a tenth of the error or more, 1e-9 of it is left; the arc cosine takes half of the
    # digits.
    assert 2 * math.acos(min(1.0, abs(row[3]))) == pytest.approx(math.acos(turn[0]), abs=1e-7)


def test_pybullet_is_imported_without_a_word() -> None:
    """PyBullet writes to standard error in C when it is imported; what Python writes there afterwards is seen."""
    code = "import bodycheck.adapters.pybullet.engine, sys; print('seen', file=sys.stderr)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert (done.stdout, done.stderr) == ("", "seen\n")


def test_a_physics_server_ends_with_its_simulation() -> None:
    simulation = PYBULLET.prepare([TUMBLING], Method.parse("maximal", 1e-3))
    client = simulation.state.client
    assert pybullet.getConnectionInfo(client)["isConnected"]
    del simulation
    assert not pybullet.getConnectionInfo(client)["isConnected"]
