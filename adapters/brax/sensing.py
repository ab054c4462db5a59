"""Read what Brax has in the state after a step, in a simulation of its own.

The angular velocity of a link is `xd.ang`, and the velocity of a point on it is `xd` transformed by Brax's `Transform.do`; both
are along the axes of the world. The effort in a joint is that of `actuator.to_tau`. The force of contacts on a free body of the
pipeline `generalized` is `qf_constraint`, which belongs to the start of the step.

Brax has no accelerations of links and no wrenches of joints, and its other pipelines have no forces of contacts.
"""

from collections.abc import Sequence

import numpy as np
from brax import actuator, math
from brax.base import Transform
from jax import numpy as jnp

from bodycheck.adapters.contract import Method
from bodycheck.adapters.mjx.compiled import Compiled
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.trajectory import Array

LACKING = {"accelerometer": "has no accelerations of links", "force_torque": "has no wrenches of joints"}


def lacking(scene: AnyScene, sensor: Sensor, method: Method) -> str | None:
    """Return why Brax does not read a sensor, as `Sensing.lacking` does."""
    if sensor.type in LACKING:
        return LACKING[sensor.type]
    if sensor.type == "contact_force" and (isinstance(scene, Mechanism) or method.integrator != "generalized"):
        return f"has no forces of contacts on a body of this scene in its pipeline {method.integrator}"
    if not isinstance(scene, Mechanism):
        return None
    if sensor.type == "velocimeter" and any(joint.type in ("prismatic", "planar") for joint in scene.joints):
        return "has other frames of bodies on slides"  # see `mechanisms.align_slides`
    if sensor.joint is not None and scene.joints[sensor.joint].stiffness and scene.joints[sensor.joint].rest:
        return "has no rest position of springs, so that an actuator exerts a part of the spring's force"
    return None


def read(scene: AnyScene, sensors: Sequence[Sensor], steps: Compiled) -> tuple[Array, ...]:
    """Return the readings of sensors from the present state of a simulation."""
    return tuple(np.array(reading(scene, sensor, steps), dtype=np.float64) for sensor in sensors)


def reading(scene: AnyScene, sensor: Sensor, steps: Compiled) -> Array:
    """Return the reading (k,) of one sensor."""
    state, system = steps.state, steps.system[0]
    if sensor.type == "contact_force":
        return np.array(state.qf_constraint[:3])
    if isinstance(scene, Mechanism) and sensor.joint is not None:
        effort = actuator.to_tau(system, steps.system[1], state.q, state.qd)
        return np.array([effort[degree_of_freedom(scene, system.link_names, sensor)]])
    link = system.link_names.index(scene.bodies[sensor.body].name) if isinstance(scene, Mechanism) else 0
    pose, motion = state.x.take(link), state.xd.take(link)
    if sensor.type == "gyroscope":
        return np.array(motion.ang)
    return np.array(Transform.create(pos=math.rotate(jnp.array(sensor.position), pose.rot)).do(motion).vel)


def degree_of_freedom(mechanism: Mechanism, links: Sequence[str], sensor: Sensor) -> int:
    """Return the number of the degree of freedom of a sensor's joint in Brax's velocities."""
    numbers = {"revolute": 1, "prismatic": 1, "universal": 2, "planar": 3}
    children = {mechanism.bodies[joint.child].name: numbers[joint.type] for joint in mechanism.joints}
    position = links.index(mechanism.bodies[sensor.body].name)
    return sum(children[name] for name in links[:position])
