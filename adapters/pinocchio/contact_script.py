"""Write what a run with rigid contacts does as a script for Pinocchio alone, from the source of the module `contact`."""

from bodycheck.adapters import scripts
from bodycheck.adapters.contract import SceneUnsupported
from bodycheck.adapters.pinocchio import contact
from bodycheck.adapters.pinocchio.exporting import body_lines
from bodycheck.adapters.pinocchio.joints import Joints
from bodycheck.reference.scene import Brick, Plane, Scene

SCRIPT = """\
{future}
import math
from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pinocchio as pin

{sampling}
{body}

UNIVERSE = 0
HAS_POINT_CONTACTS = True
{constants}


class EngineDiverged(Exception):
    pass


{source}

# The brick and its surroundings, in SI units.
scene = SimpleNamespace(
    body=SimpleNamespace(mass={mass!r}, shape=Brick({semi_axes})),
    initial=SimpleNamespace(velocity={velocity}, angular_velocity={angular_velocity}),
    gravity={gravity!r},
)
plane = SimpleNamespace(friction={friction!r})
advance = rigid_contact(scene, plane, SimpleNamespace(model=model, joint=joint), TIMESTEP)

{loop}"""

#: The constants of the module `contact` that its functions use.
CONSTANTS = ("SOLVER_TOLERANCE", "SPEED_ROUNDING", "INITIAL_PENALTY", "STALL_RESIDUAL")


def script(scene: Scene, plane: Plane, joints: Joints, model: str, timestep: float, duration: float, samples: int) -> str:
    """Return a script that takes the steps of a run with rigid contacts, as `bodycheck.adapters.contract.Scripts` says.

    Parameters
    ----------
    scene, plane
        The scene and its plane.
    joints
        The body on its joints, with gravity.
    model
        The name of the model.
    timestep
        The time step (s).
    duration, samples
        The duration (s) and the number of samples.

    Raises
    ------
    SceneUnsupported
        For a model with more than the contacts, and for all that the contacts do not model.
    """
    if model != "contact":
        raise SceneUnsupported(f"a script of the model {model!r}; there is one of the model 'contact'")
    contact.rigid_contact(scene, plane, joints, timestep)  # what cannot be modelled is no script
    shape, initial = scene.body.shape, scene.initial
    assert isinstance(shape, Brick)  # else there would be no contacts
    functions = (contact.point_contacts, contact.residual_of, contact.set_tolerance)
    sources = (Brick, *functions, contact.Solver, contact.solver_settings, contact.rigid_contact)
    return SCRIPT.format(
        future=scripts.FUTURE,
        sampling=scripts.sampling(timestep, duration, samples),
        body=body_lines(joints),
        constants="\n".join(f"{name} = {getattr(contact, name)!r}" for name in CONSTANTS),
        source=scripts.source(*sources),
        mass=scene.body.mass,
        semi_axes=scripts.written(shape.semi_axes),
        velocity=scripts.written(initial.velocity),
        angular_velocity=scripts.written(initial.angular_velocity),
        gravity=scene.gravity,
        friction=plane.friction,
        loop=scripts.loop("for _ in range(step - done):\n    q, v = advance(q, v)", "[*q[:3], q[6], *q[3:6], *v]"),
    )
