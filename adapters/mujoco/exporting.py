"""Write a run as a script that needs MuJoCo alone."""

import numpy as np

from bodycheck.adapters import scripts
from bodycheck.adapters.contract import Method, SceneUnsupported
from bodycheck.adapters.mujoco import models as scene_models
from bodycheck.adapters.mujoco import touching
from bodycheck.adapters.mujoco.models import Joints
from bodycheck.adapters.touching import switches, touching_bodies
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.scene import Scene

#: The lines of a script that take the steps to the next sample.
ADVANCE = "if step > done:\n    mujoco.mj_step(model, data, step - done)"

SCRIPT = '''\
{future}
import mujoco
import numpy as np

{sampling}
XML = """
{xml}
"""

model = mujoco.MjModel.from_xml_string(XML)
data = mujoco.MjData(model)
data.qpos[:] = {qpos}
data.qvel[:] = {qvel}
{force}
{loop}'''

#: The lines of a script that define the force of drag, which MuJoCo evaluates together with its own passive forces.
DRAG = """
import math


{source}

mujoco.set_mjcb_passive(drag_force({drag!r}, data))
"""


def script(scene: Scene, method: Method, xml: str, joints: Joints, model: str, duration: float, samples: int) -> str:
    """Return a script that takes the steps of a run, as `bodycheck.adapters.contract.Scripts` says.

    Parameters
    ----------
    scene, method
        The scene and the method.
    xml
        MuJoCo's model of the scene as XML.
    joints
        The joints of that model.
    model
        The name of the model.
    duration, samples
        The duration (s) and the number of samples.

    Raises
    ------
    SceneUnsupported
        If friction is an external force in the model.
    """
    if scene.plane is not None and model not in scene_models.MODELS_WITH_CONTACT:
        raise SceneUnsupported(f"a script of the model {model!r}: its friction is a force of bodycheck, not of MuJoCo")
    fluid, initial = method.option("drag") == "fluid", scene.initial
    dragged = scene.drag and not fluid and model != "rotation"
    state = {
        "translation": f"[*data.qpos, *{scripts.written(initial.quaternion)}, *data.qvel, 0.0, 0.0, 0.0]",
        "rotation": f"[*{scripts.written(initial.position)}, *data.qpos, 0.0, 0.0, 0.0, *data.qvel]",
    }.get(model, "[*data.qpos, *data.qvel]")
    force = DRAG.format(source=scripts.source(scene_models.drag_force), drag=scene.drag) if dragged else ""
    end = "\nmujoco.set_mjcb_passive(None)\n" if dragged else ""
    return SCRIPT.format(
        future=scripts.FUTURE,
        sampling=scripts.sampling(method.timestep, duration, samples),
        xml="\n".join(line for line in xml.splitlines() if line.strip()),
        qpos=scripts.written(joints.qpos),
        qvel=scripts.written(joints.qvel),
        force=force,
        loop=scripts.loop(ADVANCE, state) + end,
    )


def touching_script(scene: AnyScene, method: Method, duration: float, samples: int) -> str:
    """Return a script of bodies that touch, as `Scripts.script` does.

    Raises `SceneUnsupported` for pushes that begin later, end, or act beside the centre of mass: bodycheck switches and rotates
    them.
    """
    pushes = switches(scene.pushes, method.timestep)
    if len(pushes) > 1 or any(any(push.point) for push in scene.pushes):
        raise SceneUnsupported("a script of pushes that begin later, end, or act beside the centre of mass")
    bodies = touching_bodies(scene)
    xml = touching.document(scene, bodies, method)
    simulation = touching.prepare(scene, method)
    simulation.advance(np.zeros(1, dtype=np.int64))
    data = simulation.simulation.data
    applied = f"data.qfrc_applied[:] = {scripts.written(data.qfrc_applied)}\n" if scene.pushes else ""
    if isinstance(scene, Mechanism):
        names = f"BODIES = {[body.name for body in bodies]}\n\n\n{scripts.source(touching.states_of)}\n"
        states = "states_of(np.concatenate([data.qpos, data.qvel])[None], len(BODIES))[0]"
        applied, loop = applied + names, scripts.mechanism_loop(ADVANCE, states)
    else:
        loop = scripts.loop(ADVANCE, "[*data.qpos, *data.qvel]")
    return SCRIPT.format(
        future=scripts.FUTURE,
        sampling=scripts.sampling(method.timestep, duration, samples),
        xml=scripts.embedded(xml),
        qpos=scripts.written(data.qpos),
        qvel=scripts.written(data.qvel),
        force=applied,
        loop=loop,
    )
