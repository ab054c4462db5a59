"""Read MJX's sensors, in a simulation of their own. The sensors in the XML are those of the adapter of MuJoCo.

`mjx.step` computes sensors with the accelerations at the start of the step, in `RK4` at its last stage, and then moves on.
`mjx.forward` computes them for the present state. If a model can have no constraint (no contact, no dry friction, no limit and
no loop), both return before they compute the sensors of accelerations and forces, which keep the value 0.

MJX refuses MuJoCo's `contact` sensor of the net force on a body.
"""

from collections.abc import Sequence
from functools import partial
from typing import Any

import jax
import numpy as np
from jax import numpy as jnp

from bodycheck.adapters.contract import Engine, Method, SensingSimulation
from bodycheck.adapters.mjx import touching
from bodycheck.adapters.mjx.compiled import Compiled, check_precision, strider
from bodycheck.adapters.mjx.simulation import drag_of, driven, handed_over, mjx, model_of, resisted, step
from bodycheck.adapters.mujoco import sensing as of_mujoco
from bodycheck.adapters.mujoco.mechanisms import seen_states
from bodycheck.adapters.mujoco.models import compiled_model
from bodycheck.adapters.touching import touching_bodies
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.requirements import touches
from bodycheck.reference.sensors.sensor import Sensor, split
from bodycheck.reference.trajectory import Array


def lacking(scene: AnyScene, sensor: Sensor, method: Method) -> str | None:
    """Return why MJX does not read a sensor, as `Sensing.lacking` does."""
    if sensor.type == "contact_force":
        return "has no sensor of the net force of contacts on a body"
    return of_mujoco.lacking(scene, sensor, method)


def forward(system: tuple[Any, Any], data: Any) -> Any:
    """Return the readings of all sensors for the state in MJX's data; see `simulation.step`."""
    model, drag = system
    return mjx.forward(model, resisted(data, drag)).sensordata


def forward_pushed(system: tuple[Any, Any], data: Any) -> Any:
    """Return the readings of all sensors for the state in MJX's data; see `touching.step`."""
    model, pushes = system
    return mjx.forward(model, touching.pushed(data, pushes)).sensordata


#: The functions that take strides of a model with sensors, and that computes its sensors, which JAX compiles once for each
#: structure of a model.
TAKE = strider(step, lambda data: jnp.concatenate([data.qpos, data.qvel]))
FORWARD, FORWARD_PUSHED = jax.jit(forward), jax.jit(forward_pushed)


def prepare_sensing(engine: Engine, scene: AnyScene, sensors: Sequence[Sensor], method: Method) -> SensingSimulation:
    """Return the simulation of a scene with sensors, as `Sensing.prepare_sensing` does."""
    check_precision(engine)
    if touches(scene):
        return pushed_sensing(engine, scene, sensors, method)
    if isinstance(scene, Mechanism):
        mechanism, xml, with_sensors = of_mujoco.description_of_mechanism(scene, sensors, method)
        compiled = compiled_model(with_sensors)
        start = of_mujoco.begun(compiled, mechanism)
        initial = {name: jnp.array(getattr(start, name)) for name in ("qpos", "qvel", "ctrl")}
        rows, drag, bodies = seen_states(mechanism, xml), None, len(mechanism.bodies)
    else:
        with_sensors, joints = of_mujoco.description_of_body(scene, sensors, method, model_of(scene))
        compiled = compiled_model(with_sensors)
        initial = {"qpos": jnp.array(joints.qpos), "qvel": jnp.array(joints.qvel)}
        rows, drag, bodies = (lambda seen: seen), drag_of(scene, method), 1
    model, data = handed_over(compiled)
    steps = Compiled(TAKE.one, (model, drag), data.replace(**initial), rows, bodies)
    read = partial(readings, steps, sensors, FORWARD if method.option("sensors") == "forward" else None)
    if not (isinstance(scene, Mechanism) and scene.driven):
        return SensingSimulation(steps, read)
    motors = [compiled.actuator(scene.joints[joint].name).id for joint in scene.driven]
    return SensingSimulation(driven(steps, compiled, scene, motors), read)


def readings(steps: Compiled, sensors: Sequence[Sensor], forward: Any) -> tuple[Array, ...]:
    """Return the present readings; `forward` computes them for the present state, or is None."""
    values = steps.state.sensordata if forward is None else forward(steps.system, steps.state)
    return split(sensors, np.array(values, dtype=np.float64))


def pushed_sensing(engine: Engine, scene: AnyScene, sensors: Sequence[Sensor], method: Method) -> SensingSimulation:
    """Return the simulation of bodies that touch, with sensors."""
    bodies = touching_bodies(scene)
    xml = of_mujoco.description_of_touching(scene, bodies, sensors, method)
    simulation = touching.started(engine, scene, bodies, xml, method)
    forward = FORWARD_PUSHED if method.option("sensors") == "forward" else None
    read = partial(readings, simulation.simulation, sensors, forward)
    return of_mujoco.reading_pushed(simulation, SensingSimulation(simulation, read))
