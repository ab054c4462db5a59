"""Readings of sensors by differentiating the momenta and velocities of a truth with respect to time.

This shares nothing with the truth of sensors, which differentiates nothing: of a motion without events within a few
milliseconds, central differences of the fifth order give accelerations to ten digits.
"""

import numpy as np

from bodycheck.reference.kinematics import conjugate, cross, normalise, rotate
from bodycheck.reference.mechanisms import exact, observables
from bodycheck.reference.mechanisms.coordinates import places
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.scene import EulerAngles
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.sensors.truth import sensor_truth
from bodycheck.reference.trajectory import Array
from bodycheck.reference.truth import truth
from bodycheck.reference.truths import Truth

#: Central differences of the fifth order with steps of 1 ms: the fifth derivative and roundings of momenta leave this, relative
#: to the largest reading.
DIFFERENCES = 3e-8

#: The interval of the differences (s), and their weights.
STEP = 1e-3
WEIGHTS = np.array([1 / 12, -2 / 3, 0, 2 / 3, -1 / 12]) / STEP


def around(mechanism: Mechanism, times: Array) -> Truth:
    """The truth at five instants for each of n times (s), which are at least two intervals apart."""
    return truth(mechanism, np.ravel(times[:, None] + STEP * np.arange(-2, 3)), vouched=False)


def derivative(values: Array) -> Array:
    """The derivatives (..., n, k) of values (..., 5 n, k) at the middle of each five instants."""
    grouped = values.reshape(*values.shape[:-2], -1, 5, values.shape[-1])
    return np.asarray((WEIGHTS[:, None] * grouped).sum(axis=-2))


def accelerometer(mechanism: Mechanism, motion: Truth, sensor: Sensor) -> Array:
    """The readings (n, 3) of an accelerometer at the middle of each five instants."""
    states = motion.trajectory.body(sensor.body)
    arm = np.array(sensor.position) - exact.nearest_inertia(mechanism.bodies[sensor.body]).centre
    velocity = states.velocity + rotate(states.quaternion, np.cross(states.angular_velocity, arm))
    specific = derivative(velocity) + np.array([0, 0, mechanism.gravity])
    mounted = normalise(np.array(exact.nearest_turn(sensor.attitude)))
    along_body = rotate(conjugate(states.quaternion[2::5]), specific)
    return rotate(np.tile(conjugate(mounted), (len(along_body), 1)), along_body)


def wrench(mechanism: Mechanism, motion: Truth, joint: int) -> Array:
    """The force and moment (n, 6) on the child of a joint, from the momenta of all that hangs on it, about a fixed point."""
    child = mechanism.joints[joint].child
    beyond = {child}
    for _ in mechanism.bodies:
        beyond |= {each.child for each in mechanism.joints if each.parent in beyond}
    states, masses = motion.trajectory, observables.masses(mechanism)
    momentum, turning, load, pull = np.zeros((4, len(states), 3))
    for body in beyond:
        part = states.body(body)
        linear = masses[body] * part.velocity
        spin = rotate(part.quaternion, part.angular_velocity @ observables.tensor(mechanism.bodies[body]))
        weight = np.tile([0.0, 0.0, -masses[body] * mechanism.gravity], (len(states), 1))
        momentum, turning = momentum + linear, turning + spin + cross(part.position, linear)
        load, pull = load + weight, pull + cross(part.position, weight)
    force, about_world = derivative(momentum) - load[2::5], derivative(turning) - pull[2::5]
    here = states.body(child).part(slice(2, None, 5))
    centre = np.tile(exact.nearest_inertia(mechanism.bodies[child]).centre, (len(here), 1))
    origin = here.position - rotate(here.quaternion, centre)
    back = conjugate(here.quaternion)
    return np.hstack([rotate(back, force), rotate(back, about_world - cross(origin, force))])


def along_joint(mechanism: Mechanism, motion: Truth, joint: int, effort: Array) -> Array:
    """Return effort - spring - damping - dry friction - armature times acceleration (n,) of a joint with one coordinate.

    effort: (n,) of its controller and its elastic stops.
    """
    assert motion.joints is not None
    given, (held, moving) = mechanism.joints[joint], places(mechanism)[joint]
    q, v = motion.joints.position[2::5, held.start], motion.joints.velocity[2::5, moving.start]
    rate = derivative(motion.joints.velocity[:, moving])[:, 0]
    passive = given.stiffness * (q - given.rest) + given.damping * v + given.friction * np.sign(v)
    return np.asarray(effort + given.effort - passive - given.armature * rate)


def sensors_of(mechanism: Mechanism) -> tuple[tuple[Sensor, ...], tuple[Sensor, ...]]:
    """An accelerometer on every body, and a force_torque sensor in every joint that transmits forces."""
    turned = EulerAngles(0.3, 1.1, -0.4)
    mounted = (
        Sensor(body.name, "accelerometer", index, None, (0.1, -0.2, 0.05), turned)
        for index, body in enumerate(mechanism.bodies)
    )
    cells = (
        Sensor(each.name, "force_torque", each.child, index)
        for index, each in enumerate(mechanism.joints)
        if each.form.transmits
    )
    return tuple(mounted), tuple(cells)


def check_derivatives(mechanism: Mechanism, motion: Truth, *, of_joints: bool = True) -> None:
    mounted, cells = sensors_of(mechanism)
    readings = sensor_truth(motion, (*mounted, *(cells if of_joints else ())))
    for sensor, reading in zip((*mounted, *cells), readings, strict=False):
        assert not reading.reason
        felt = reading.values[2::5]
        seen = accelerometer(mechanism, motion, sensor) if sensor.joint is None else wrench(mechanism, motion, sensor.joint)
        np.testing.assert_allclose(felt, seen, atol=DIFFERENCES * max(1.0, np.abs(felt).max()), err_msg=sensor.name)
