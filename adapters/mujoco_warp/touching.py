"""Step free bodies that touch a plane and each other in MuJoCo Warp, by its own contacts.

The XML and the options are those of the adapter of MuJoCo. Pushes are a kernel that is added to the passive forces, so that
every integrator evaluates them with all other forces.

MuJoCo Warp reserves memory for contacts and for rows of constraints before the first step, and drops what exceeds it. The
adapter reserves memory for `CONTACTS_OF_A_BODY` contacts of each body, and ends a run in which MuJoCo Warp reports that
something exceeded its memory.
"""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from typing import Any

import mujoco_warp as mjw
import numpy as np
import warp as wp
from mujoco import MjData

from bodycheck.adapters.contract import EngineDiverged, Method, SceneUnsupported
from bodycheck.adapters.mujoco import touching
from bodycheck.adapters.mujoco.models import compiled_model
from bodycheck.adapters.mujoco_warp import graphs
from bodycheck.adapters.stepping import Loop
from bodycheck.adapters.touching import Pushed, TouchingBody, switches, touching_bodies
from bodycheck.reference.mechanisms.mechanism import AnyScene
from bodycheck.reference.scene import Push
from bodycheck.reference.trajectory import Array

#: The requirements of touching bodies that MuJoCo Warp models, which are MuJoCo's.
MODELS = touching.MODELS

#: The number of contacts of each body for which memory is reserved: twice the contacts of two boxes.
CONTACTS_OF_A_BODY = 16

#: The most rows of constraints of a contact, which a pyramidal cone with torsion and rolling has.
ROWS_OF_A_CONTACT = 10

#: What MuJoCo Warp reports if contacts or constraints were dropped; other flags tell of iterations that reached their limit.
DROPPED = (
    mjw.OverflowType.NEFC
    | mjw.OverflowType.NJMAX_NNZ
    | mjw.OverflowType.BROADPHASE
    | mjw.OverflowType.NARROWPHASE
    | mjw.OverflowType.CCD
)


def add_pushes(
    bodies: wp.array[int],
    acting: wp.array[wp.vec3],
    points: wp.array[wp.vec3],
    coordinates: wp.array2d[float],
    forces: wp.array2d[float],
) -> None:
    """Add the forces of pushes (world) at points in the frames of bodies. Warp compiles this function as a kernel."""
    push = wp.tid()
    body, force = bodies[push], acting[push]
    first = 7 * body + 3
    turn = wp.quat(coordinates[0, first + 1], coordinates[0, first + 2], coordinates[0, first + 3], coordinates[0, first])
    torque = wp.cross(points[push], wp.quat_rotate_inv(turn, force))
    for axis in range(3):
        wp.atomic_add(forces, 0, 6 * body + axis, force[axis])
        wp.atomic_add(forces, 0, 6 * body + 3 + axis, torque[axis])


pushes_kernel = wp.kernel(add_pushes)


def prepare(scene: AnyScene, method: Method) -> Pushed[Loop[Any]]:
    """Return the simulation of bodies that touch, as `Adapter.prepare` does. Raises `SceneUnsupported`."""
    bodies = touching_bodies(scene)
    model, data = handed_over(bodies, touching.document(scene, bodies, method))
    return stepped(scene, bodies, method, model, data)


def handed_over(bodies: Sequence[TouchingBody], xml: str) -> tuple[Any, Any]:
    """Return MuJoCo Warp's model and data of bodies that touch from their XML. Raises `SceneUnsupported`."""
    compiled = compiled_model(xml)
    start = MjData(compiled)
    start.qpos[:], start.qvel[:] = touching.coordinates(bodies)
    contacts = CONTACTS_OF_A_BODY * len(bodies)
    try:
        model = mjw.put_model(compiled)
    except NotImplementedError as error:
        raise SceneUnsupported(f"MuJoCo Warp refuses the model: {error}") from error
    return model, mjw.put_data(compiled, start, nconmax=contacts, njmax=ROWS_OF_A_CONTACT * contacts)


def stepped(scene: AnyScene, bodies: Sequence[TouchingBody], method: Method, model: Any, data: Any) -> Pushed[Loop[Any]]:
    """Return the simulation of a model and data of MuJoCo Warp."""
    acting = push_in(model, scene.pushes)
    qpos, qvel, dropped = data.qpos.numpy(), data.qvel.numpy(), data.overflow.numpy()  # views of the arrays that are stepped

    def replay(graph: Any) -> Any:
        graphs.replay(graph)
        if dropped[0] & DROPPED:
            flags = mjw.OverflowType(int(dropped[0])) & DROPPED
            raise EngineDiverged(f"MuJoCo Warp reported that it dropped contacts or constraints: {flags.name}")
        return graph

    loop = Loop(
        graphs.record(lambda: mjw.step(model, data)),
        replay,
        seen=lambda graph: np.concatenate([qpos[0], qvel[0]]),
        rows=lambda seen: touching.states_of(seen, len(bodies)),
    )

    def exert(pushes: Sequence[Push]) -> None:
        if scene.pushes:
            acting[:] = [push.force if push in pushes else (0.0, 0.0, 0.0) for push in scene.pushes]

    return Pushed(loop, switches(scene.pushes, method.timestep), exert)


def push_in(model: Any, pushes: Sequence[Push]) -> Array:
    """Add pushes to the passive forces of a model, and return the array (k, 3) of their forces, which are zero at first."""
    acting = wp.zeros(len(pushes), dtype=wp.vec3)
    if pushes:
        bodies = wp.array([push.body for push in pushes], dtype=int)
        points = wp.array([push.point for push in pushes], dtype=wp.vec3)
        model.callback.passive = lambda model, data: wp.launch(
            pushes_kernel, dim=len(pushes), inputs=[bodies, acting, points, data.qpos], outputs=[data.qfrc_passive]
        )
    return np.asarray(acting.numpy())


def interface_loads(scene: AnyScene, method: Method, steps: int) -> dict[tuple[int, int], Array]:
    """Return the normal forces between pairs that touch in each of n steps, as `InterfaceLoads.interface_loads` does."""
    bodies = touching_bodies(scene)
    xml = touching.document(scene, bodies, method)
    model, data = handed_over(bodies, xml)
    simulation = stepped(scene, bodies, method, model, data)
    contacts = wp.array(np.arange(data.naconmax, dtype=np.int32))
    forces = wp.zeros(data.naconmax, dtype=wp.spatial_vector)
    graph = graphs.record(lambda: mjw.contact_force(model, data, contacts, False, forces))
    body_of, count, geoms, normal = (
        compiled_model(xml).geom_bodyid,
        data.nacon.numpy(),
        data.contact.geom.numpy(),
        forces.numpy()[:, 0],
    )

    def step() -> Mapping[tuple[int, int], float]:
        simulation.simulation.step(simulation.simulation.state)
        forces.zero_()
        graphs.replay(graph)
        by_pair = defaultdict[tuple[int, int], float](float)
        for number in range(int(count[0])):
            by_pair[touching.pair_of(body_of[geoms[number]])] += float(normal[number])
        return by_pair

    return simulation.loads(steps, step)
