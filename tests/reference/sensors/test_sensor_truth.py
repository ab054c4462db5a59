"""The truth of sensors: known readings, readings by differentiating momenta, and the force along joints."""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
import pytest
from _pytest.mark import ParameterSet

from bodycheck.casefile.case import load
from bodycheck.reference.kinematics import rotate
from bodycheck.reference.mechanisms.control import Controller, Sine, Stops
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, JointedBody, Loop, Mechanism
from bodycheck.reference.scene import Body, EulerAngles, Plane, Scene, Sphere, State, Tensor, Vector
from bodycheck.reference.sensors.expected import accelerations, expected
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.sensors.truth import sensor_truth
from bodycheck.reference.trajectory import Array
from bodycheck.reference.truth import truth
from tests.support import coupled_joints, jointed, linkages
from tests.support.differentiated import DIFFERENCES, along_joint, around, check_derivatives, sensors_of

#: The standard brick of the issue of an accelerometer in free flight, and its reading at t = 0.
BRICK = Scene(Body(1.0, (0.0134, 0.0105, 0.0043)), State(velocity=(3.0, -4.0, 5.0), angular_velocity=(1.0, 5.0, 1.0)), 9.81)
IMU = Sensor("imu", "accelerometer", position=(0.1, 0.05, 0.02))
READING = (-2.5159379844961242, 0.7909406456091635, 0.0323383084577115)


def values(scene: Scene | Mechanism, sensor: Sensor, times: Array) -> Array:
    (reading,) = sensor_truth(truth(scene, times, vouched=False), (sensor,))
    assert not reading.reason
    return reading.values


@pytest.mark.parametrize("gravity", [0.0, 9.81, 24.79])
def test_a_brick_in_free_flight(gravity: float) -> None:
    (reading,) = sensor_truth(truth(replace(BRICK, gravity=gravity), np.zeros(1), vouched=False), (IMU,))
    assert (np.abs(reading.values[0] - READING) <= reading.bounds[0]).all()
    assert (reading.bounds < 1e-13).all()


def test_nothing_is_felt_in_free_flight_at_the_centre_of_mass() -> None:
    (reading,) = sensor_truth(truth(BRICK, np.linspace(0, 2, 21), vouched=False), (Sensor("imu", "accelerometer"),))
    assert (np.abs(reading.values) <= reading.bounds).all()
    assert reading.bounds.max() < 1e-13


@pytest.mark.parametrize("type", ["accelerometer", "gyroscope", "velocimeter"])
def test_readings_are_along_the_axes_of_the_sensor(type: str) -> None:
    turned = Sensor("imu", type, position=(0.1, 0.05, 0.02), attitude=EulerAngles(np.pi / 2, 0.0, 0.0))  # type: ignore[arg-type]
    times = np.linspace(0, 1, 5)
    along = values(BRICK, replace(turned, attitude=(1.0, 0.0, 0.0, 0.0)), times)
    # Its x is the body's y, and its y the opposite of the body's x; the angle pi/2 is rounded.
    np.testing.assert_allclose(values(BRICK, turned, times), along[:, [1, 0, 2]] * [1, -1, 1], atol=1e-12)


def test_gravity_is_felt_upwards_at_rest() -> None:
    case = load("resting-brick")
    sensors = (IMU, Sensor("load", "contact_force"))
    felt, force = sensor_truth(truth(case.scene, case.instants, vouched=False), sensors)
    assert isinstance(case.scene, Scene)
    np.testing.assert_allclose(felt.values, np.tile([0.0, 0.0, case.scene.gravity], (len(case.instants), 1)), atol=1e-12)
    np.testing.assert_allclose(force.values[:, 2], case.scene.body.mass * case.scene.gravity, rtol=1e-15)


def pendulum(**more: float) -> Mechanism:
    """A point mass of 2 kg at 1 m from a hinge, released from the horizontal."""
    bob = JointedBody("bob", Tensor(2.0, ((0.0,) * 3,) * 3), (1.0, 0.0, 0.0))
    return Mechanism(
        (bob,),
        (Joint("pin", "revolute", WORLD, 0, axis=(0.0, 1.0, 0.0), start=(0.0,), start_velocity=(0.0,), **more),),
        gravity=9.81,
    )  # type: ignore[arg-type]


def test_a_pendulum_pulls_with_three_times_its_weight_at_the_bottom() -> None:
    # From theta'^2 = 2 g sin(theta), along the rod: m theta'^2 + m g sin(theta) = 3 m g sin(theta).
    mechanism, times = pendulum(), np.linspace(0, 2, 41)
    motion = truth(mechanism, times, vouched=False)
    assert motion.joints is not None
    (reading,) = sensor_truth(motion, (Sensor("pin", "force_torque", 0, 0),))
    pull = 3 * 2.0 * 9.81 * np.sin(motion.joints.position[:, 0])
    np.testing.assert_allclose(-reading.values[:, 0], pull, atol=1e-12)
    np.testing.assert_allclose(reading.values[:, 4], 0, atol=1e-13)


def test_a_centrifuge() -> None:
    rate, radius = 7.0, 0.3
    disk = Mechanism(
        (jointed.body("disk", 1.0, (1.0, 1.0, 1.0)),),
        (Joint("axle", "revolute", WORLD, 0, start=(0.2,), start_velocity=(rate,)),),
    )
    place: Vector = (radius, 0.0, 0.0)
    times = np.linspace(0, 1, 11)
    felt = values(disk, Sensor("imu", "accelerometer", 0, position=place), times)
    np.testing.assert_allclose(felt, np.tile([-(rate**2) * radius, 0, 0], (11, 1)), atol=1e-13)
    np.testing.assert_allclose(values(disk, Sensor("v", "velocimeter", 0, position=place), times)[:, 1], rate * radius)


#: Mechanisms, and the end of a time (s) in which nothing happens suddenly.
TREES = {
    "ball and hinge": (jointed.ball_and_hinge(), 0.5),
    "a joint that follows another": (coupled_joints.gripper(), 0.3),
    "armature, damping and spring": (pendulum(armature=0.7, damping=0.4, stiffness=3.0, rest=0.2, effort=0.5), 1.0),
}

SLOW_TREES = {
    "every type of joint": (jointed.tree(), 0.3),
    "free chain": (jointed.free_chain(), 0.5),
    "several joints of a body": (coupled_joints.hip(), 0.3),
}


def slow(names: Iterable[str]) -> list[ParameterSet]:
    """Parameters of tests that take long, since equations are compiled."""
    return [pytest.param(name, marks=pytest.mark.slow) for name in names]


@pytest.mark.parametrize("name", [*TREES, *slow(SLOW_TREES)])
def test_readings_are_derivatives_of_momenta(name: str) -> None:
    mechanism, end = (TREES | SLOW_TREES)[name]
    check_derivatives(mechanism, around(mechanism, np.linspace(0.05, end, 3)))


SINE = Sine(amplitude=2.0, angular_frequency=5.0)
DRIVES = {
    "continuous law": (Controller(0, kp=30.0, kd=2.0, target=0.4), None),
    "integral": (Controller(0, kp=20.0, kd=1.0, ki=15.0, target=SINE), None),
    "saturated": (Controller(0, kp=90.0, kd=2.0, target=1.0, effort_limit=4.0, no_load_speed=6.0), None),
    "sampled with delay": (Controller(0, kp=30.0, kd=1.0, ki=2.0, target=0.4, rate=20.0, delay=2, effort_limit=5.0), None),
    "elastic stop": (None, Stops(-3.0, 0.1, restitution=None, stiffness=200.0, damping=1.0)),
}


@pytest.mark.parametrize("name", ["sampled with delay", *slow(set(DRIVES) - {"sampled with delay"})])
def test_driven_joints(name: str) -> None:
    pytest.importorskip("heyoka")
    controller, stops = DRIVES[name]
    free = pendulum(armature=0.2, damping=0.3, friction=0.1)
    mechanism = replace(
        free,
        joints=(replace(free.joints[0], stops=stops),),
        controllers=() if controller is None else (controller,),
    )
    motion = around(mechanism, np.array([0.02, 0.17, 0.33, 0.475]))  # between the instants of a sampled law
    check_derivatives(mechanism, motion)
    cell, motor = sensor_truth(motion, (Sensor("cell", "force_torque", 0, 0), Sensor("motor", "joint_effort", 0, 0)))
    exerted = motor.values[2::5, 0]
    if stops is not None:
        assert motion.joints is not None
        assert stops.upper is not None
        q, v = (part[2::5, 0] for part in (motion.joints.position, motion.joints.velocity))
        exerted = exerted - np.where(q > stops.upper, np.maximum(0, stops.stiffness * (q - stops.upper) + stops.damping * v), 0)
    along = along_joint(mechanism, motion, 0, exerted)
    np.testing.assert_allclose(cell.values[2::5, 4], along, atol=DIFFERENCES * max(1.0, np.abs(along).max()))


def test_a_joint_that_sticks_is_held_by_its_friction() -> None:
    pytest.importorskip("heyoka")
    stuck = replace(pendulum(friction=100.0), gravity=9.81)
    cell, imu = sensor_truth(
        truth(stuck, np.linspace(0, 1, 3), vouched=False), (Sensor("c", "force_torque", 0, 0), Sensor("i", "accelerometer", 0))
    )
    np.testing.assert_allclose(cell.values, np.tile([0, 0, 19.62, 0, -19.62, 0], (3, 1)), atol=1e-13)
    np.testing.assert_allclose(imu.values, np.tile([0, 0, 9.81], (3, 1)), atol=1e-13)


def test_a_joint_rests_at_its_rigid_stop() -> None:
    pytest.importorskip("heyoka")
    free = pendulum()
    mechanism = replace(free, joints=(replace(free.joints[0], stops=Stops(None, 0.5, restitution=0.0)),))
    (cell,) = sensor_truth(truth(mechanism, np.array([0.0, 2.0]), vouched=False), (Sensor("cell", "force_torque", 0, 0),))
    force = 2.0 * 9.81 * np.array([-np.sin(0.5), 0, np.cos(0.5)])
    np.testing.assert_allclose(cell.values[-1, :3], force, atol=1e-12)
    np.testing.assert_allclose(cell.values[-1, 4], -2.0 * 9.81 * np.cos(0.5), atol=1e-12)


def test_instants_of_impacts_are_left_out() -> None:
    """A slider that moves at 1 m/s meets its stop after 0.5 s, and a ball that falls by 1 m at 8 m/s^2 the plane."""
    pytest.importorskip("heyoka")
    slider = jointed.on_one_joint("prismatic", 0.0, 1.0)
    slider = replace(slider, joints=(replace(slider.joints[0], stops=Stops(None, 0.5, restitution=0.5)),))
    ball = Scene(Body(1.0, (0.004,) * 3, Sphere(0.1)), State(position=(0.0, 0.0, 1.1)), 8.0, Plane(restitution=0.5))
    for scene, type in ((slider, "accelerometer"), (ball, "contact_force")):
        (reading,) = sensor_truth(truth(scene, np.array([0.0, 0.25, 0.5, 0.75]), vouched=False), (Sensor("s", type),))  # type: ignore[arg-type]
        assert reading.left_out == 1
        np.testing.assert_array_equal(np.isnan(reading.values).all(axis=1), [False, False, True, False])
        np.testing.assert_array_equal(np.isnan(reading.bounds), np.isnan(reading.values))
        np.testing.assert_allclose(reading.values[[0, 1, 3]], 0, atol=1e-12)


@pytest.mark.slow
def test_a_tree_with_a_stop_and_dry_friction() -> None:
    """It moves, slips, meets its stop and comes to rest."""
    pytest.importorskip("heyoka")
    links = (
        jointed.body("upper", 1.0, (0.02, 0.03, 0.04), (0.1, 0.2, 0.3)),
        jointed.body("lower", 0.5, (0.01, 0.02, 0.02), (0.2, -0.1, 0.1)),
    )
    first = Joint(
        "first",
        "revolute",
        WORLD,
        0,
        axis=(0.0, 1.0, 0.0),
        armature=0.1,
        start=(0.3,),
        start_velocity=(1.0,),
        stops=Stops(None, 0.5, restitution=0.0),
    )
    second = Joint(
        "second", "revolute", 0, 1, (0.3, 0.0, 0.2), axis=(1.0, 0.0, 0.0), friction=3.0, start=(0.4,), start_velocity=(-2.0,)
    )
    mechanism = Mechanism(links, (first, second), gravity=9.81)
    motion = around(mechanism, np.array([0.05, 0.1, 0.15, 0.4]))
    assert motion.joints is not None
    np.testing.assert_array_equal(motion.joints.velocity[-1], 0)
    check_derivatives(mechanism, motion)


@pytest.mark.slow
@pytest.mark.parametrize("mechanism", [linkages.slider_crank(), linkages.closed_spatially()], ids=["plane", "space"])
def test_accelerations_in_loops(mechanism: Mechanism) -> None:
    check_derivatives(mechanism, around(mechanism, np.array([0.02, 0.1])), of_joints=False)


def test_a_wrench_in_a_plane_loop_is_not_unique() -> None:
    mechanism = linkages.slider_crank()
    motion = truth(mechanism, np.linspace(0, 0.1, 2), vouched=False)
    for reading in sensor_truth(motion, sensors_of(mechanism)[1]):
        assert reading.reason == "a wrench in a loop"


@pytest.mark.parametrize("name", ["rolling-ball", "ball-on-ramp", "ball-slips-on-ramp", "block-up-a-ramp", "curling-brick"])
def test_bodies_that_touch(name: str) -> None:
    """Accelerations between events are differences of velocities; steps of 1 ms leave 1e-6 where friction turns quickly."""
    case, step = load(name), 1e-3
    scene = case.scene
    assert isinstance(scene, Scene)
    middle = np.array([0.05, 0.11]) * case.duration
    motion = truth(scene, np.ravel(middle[:, None] + step * np.arange(-2, 3)), vouched=False)
    force, gyro, imu = sensor_truth(
        motion, (Sensor("f", "contact_force"), Sensor("g", "gyroscope"), replace(IMU, position=(0.0,) * 3))
    )
    weights = np.array([1 / 12, -2 / 3, 0, 2 / 3, -1 / 12]) / step
    seen = (weights[:, None] * motion.trajectory.velocity.reshape(2, 5, 3)).sum(axis=1) + np.array([0, 0, scene.gravity])
    np.testing.assert_allclose(force.values[2::5], scene.body.mass * seen, atol=1e-6 * scene.body.mass)
    np.testing.assert_allclose(np.linalg.norm(imu.values[2::5], axis=1), np.linalg.norm(seen, axis=1), atol=1e-6)
    np.testing.assert_allclose(gyro.values, motion.trajectory.angular_velocity, atol=1e-14)


def test_a_rolling_ball_is_held_on_its_ramp() -> None:
    case = load("ball-on-ramp")
    assert isinstance(case.scene, Scene)
    (force,) = sensor_truth(truth(case.scene, case.instants, vouched=False), (Sensor("f", "contact_force"),))
    assert case.scene.plane is not None
    incline, weight = case.scene.plane.incline, case.scene.body.mass * case.scene.gravity
    pull, press = weight * np.sin(incline) * 2 / 7, weight * np.cos(incline)
    along, normal = np.array([np.cos(incline), 0, -np.sin(incline)]), np.array([np.sin(incline), 0, np.cos(incline)])
    np.testing.assert_allclose(force.values, np.tile(press * normal - pull * along, (len(force.values), 1)), atol=1e-13)


def test_the_readings_at_the_states_of_a_truth_are_the_truth() -> None:
    mechanism = jointed.ball_and_hinge()
    motion = truth(mechanism, np.linspace(0, 0.3, 4), vouched=False)
    sensors = tuple(each for group in sensors_of(mechanism) for each in group)
    for reading, one in zip(sensor_truth(motion, sensors), expected(mechanism, sensors, motion.trajectory), strict=True):
        # The states of the bodies are rounded by themselves, so that they agree with the coordinates of joints to rounding.
        np.testing.assert_allclose(reading.values, one, atol=1e-12 * max(1.0, np.abs(one).max()))
    linear, angular = accelerations(mechanism, motion.trajectory)
    assert linear.shape == angular.shape == motion.trajectory.position.shape


def test_bounds_contain_the_readings_at_all_states_within_the_bounds_of_the_states() -> None:
    mechanism = jointed.ball_and_hinge()
    motion = truth(mechanism, np.linspace(0, 1, 5), vouched=False)
    assert motion.joints is not None
    wide = replace(motion, bounds=replace(motion.bounds, **{name: np.full(5, 1e-6) for name in motion.bounds.of_states()}))
    sensors = tuple(each for group in sensors_of(mechanism) for each in group)
    readings = sensor_truth(wide, sensors)
    random = np.random.default_rng(1)
    for _ in range(5):
        parts = (motion.joints.position, motion.joints.velocity)
        # The quaternion of a ball changes by half of the angle, and keeps its length within the square of that.
        moved = [part + random.uniform(-0.4e-6, 0.4e-6, part.shape) for part in parts]
        other = replace(motion, joints=replace(motion.joints, position=moved[0], velocity=moved[1]))
        for one, reading in zip(sensor_truth(other, sensors), readings, strict=True):
            assert (np.abs(one.values - reading.values) <= reading.bounds).all()
            assert reading.bounds.max() < 1e-3


def hung_rods(near_first: bool) -> Mechanism:
    """Two rods on ball joints between two places of the world, of which one is a joint and the other closes a loop.

    near_first: whether the joint is at the end of the first rod, and the loop at the end of the second rod.
    """
    rods = (
        jointed.body("first", 1.0, (0.01, 0.05, 0.06), (0.4, 0.0, 0.0)),
        jointed.body("second", 2.0, (0.02, 0.07, 0.05), (0.0, 0.5, 0.0)),
    )
    still, turn = (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0)
    ends: tuple[Vector, Vector] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    if near_first:  # from the origin along x, then along y
        joints = (
            Joint("one", "spherical", WORLD, 0, start=turn, start_velocity=still),
            Joint("two", "spherical", 0, 1, ends[0], start=turn, start_velocity=still),
        )
        return Mechanism(rods, joints, (Loop((1, WORLD), (ends[1], (1.0, 1.0, 0.0))),), 9.81)
    backwards = tuple(
        replace(rod, center_of_mass=centre) for rod, centre in zip(rods, ((-0.6, 0.0, 0.0), (0.0, -0.5, 0.0)), strict=True)
    )
    joints = (
        Joint("one", "spherical", 1, 0, (0.0, -1.0, 0.0), start=turn, start_velocity=still),
        Joint("two", "spherical", WORLD, 1, (1.0, 1.0, 0.0), start=turn, start_velocity=still),
    )
    return Mechanism(backwards, joints, (Loop((0, WORLD), ((-1.0, 0.0, 0.0), still)),), 9.81)


@pytest.mark.slow
def test_wrenches_in_a_loop_with_unique_forces() -> None:
    """The force between two rods is the same from both sides, whichever end of the pair is a joint and which a loop."""
    forces = []
    for near_first in (True, False):
        mechanism, times = hung_rods(near_first), np.linspace(0, 0.3, 4)
        motion = truth(mechanism, times, vouched=False)
        child = 1 if near_first else 0
        cells = tuple(Sensor(str(index), "force_torque", joint.child, index) for index, joint in enumerate(mechanism.joints))
        readings = sensor_truth(motion, cells)
        (felt,) = (reading for reading, cell in zip(readings, cells, strict=True) if cell.body == child)
        assert not felt.reason
        for reading in readings:  # a ball bears no moment
            np.testing.assert_allclose(reading.values[:, 3:], 0, atol=1e-12)
        forces.append(rotate(motion.trajectory.quaternion[child], felt.values[:, :3]))
    np.testing.assert_allclose(forces[0], -forces[1], atol=1e-11)
    assert np.abs(forces[0]).max() > 1
