"""Step free bodies that touch a plane and each other in MJX, by MJX's own contacts.

The XML and the options are those of the adapter of MuJoCo. A push is an applied force (`xfrc_applied`). The torque of a push
beside the centre of mass turns with the body, and is computed at the start of each step.
"""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
from jax import numpy as jnp

from bodycheck.adapters.contract import Engine, Method
from bodycheck.adapters.mjx.compiled import Compiled, check_precision, strider
from bodycheck.adapters.mjx.simulation import handed_over, mjx
from bodycheck.adapters.mujoco import touching
from bodycheck.adapters.mujoco.models import compiled_model
from bodycheck.adapters.touching import Pushed, TouchingBody, switches, touching_bodies
from bodycheck.reference.mechanisms.mechanism import AnyScene
from bodycheck.reference.scene import Push
from bodycheck.reference.trajectory import Array

#: The requirements of touching bodies that MJX models, which are MuJoCo's.
MODELS = touching.MODELS

#: The pushes of a system: the numbers of their bodies (k,), their forces (k, 3) and their points (k, 3).
Pushes = tuple[Any, Any, Any]


def prepare(engine: Engine, scene: AnyScene, method: Method) -> Pushed[Compiled]:
    """Return the simulation of bodies that touch, as `simulation.prepare` does."""
    bodies = touching_bodies(scene)
    return started(engine, scene, bodies, touching.document(scene, bodies, method), method)


def started(engine: Engine, scene: AnyScene, bodies: Sequence[TouchingBody], xml: str, method: Method) -> Pushed[Compiled]:
    """Return the simulation of bodies that touch from their XML."""
    check_precision(engine)
    model, data = handed_over(compiled_model(xml))
    qpos, qvel = map(jnp.array, touching.coordinates(bodies))
    system = model, arrays(scene.pushes, ()) if scene.pushes else None
    count = len(bodies)

    def rows(seen: Array) -> Array:
        return touching.states_of(seen[:, : 13 * count], count)

    steps = Compiled(TAKE.one, system, data.replace(qpos=qpos, qvel=qvel), rows, count)
    return Pushed(steps, switches(scene.pushes, method.timestep), partial(exert, steps, scene.pushes))


def exert(steps: Compiled, pushes: Sequence[Push], acting: Sequence[Push]) -> None:
    """Make some of the pushes of a scene act from now on."""
    if pushes:
        model, _ = steps.system
        steps.system = model, arrays(pushes, acting)


def arrays(pushes: Sequence[Push], acting: Sequence[Push]) -> Pushes:
    """Return the pushes of a scene as arrays, in which the forces of those that do not act are zero."""
    forces = [push.force if push in acting else (0.0, 0.0, 0.0) for push in pushes]
    return jnp.array([push.body for push in pushes]), jnp.array(forces), jnp.array([push.point for push in pushes])


def step(system: tuple[Any, Pushes | None], data: Any) -> Any:
    """Return MJX's data after one step of a system: a model and its pushes, or None without pushes."""
    model, pushes = system
    return mjx.step(model, pushed(data, pushes))


def pushed(data: Any, pushes: Pushes | None) -> Any:
    """Return MJX's data with the forces of pushes at its attitudes."""
    if pushes is None:
        return data
    bodies, forces, points = pushes
    attitudes = data.qpos.reshape(-1, 7)[bodies, 3:]
    real, axes = attitudes[:, :1], attitudes[:, 1:]
    beside = 2 * jnp.cross(axes, points)
    arms = points + real * beside + jnp.cross(axes, beside)
    applied = jnp.zeros_like(data.xfrc_applied).at[bodies + 1].add(jnp.hstack([forces, jnp.cross(arms, forces)]))
    return data.replace(xfrc_applied=applied)


def seen(data: Any) -> Any:
    """Return the coordinates, the velocities, and the forces of all rows of constraints in the last step.

    For RK4 the forces are those of the last stage.
    """
    return jnp.concatenate([data.qpos, data.qvel, data._impl.efc_force])


#: The functions that take strides of bodies that touch, which JAX compiles once for each structure of a model.
TAKE = strider(step, seen)


def interface_loads(engine: Engine, scene: AnyScene, method: Method, steps: int) -> dict[tuple[int, int], Array]:
    """Return the normal forces between pairs that touch in each of n steps, as `InterfaceLoads.interface_loads` does."""
    simulation = prepare(engine, scene, method)
    body_of = compiled_model(touching.document(scene, touching_bodies(scene), method)).geom_bodyid
    compiled, one = simulation.simulation, np.ones(1, dtype=np.int64)

    def step() -> Mapping[tuple[int, int], float]:
        model, _ = compiled.system
        forces = compiled.seen(one)[0, 13 * compiled.bodies :]
        contacts, by_pair = compiled.state._impl.contact, defaultdict[tuple[int, int], float](float)
        for geoms, dimension, first in zip(np.array(contacts.geom), contacts.dim, contacts.efc_address, strict=True):
            rows = 2 * (dimension - 1) if dimension > 1 and model.opt.cone == mjx.ConeType.PYRAMIDAL else 1
            by_pair[touching.pair_of(body_of[geoms])] += float(forces[first : first + rows].sum())
        return by_pair

    return simulation.loads(steps, step)
