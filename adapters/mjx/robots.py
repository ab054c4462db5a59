"""Robot models in MJX, which takes the model that MuJoCo's compiler makes of a file.

A reading shows whether MJX refuses a model, and the numbers of bodies and joints that MJX keeps. It has no terms: JAX compiles
every function of MJX for every robot again, which takes minutes for an arm.
"""

import contextlib
import io
from collections.abc import Sequence
from dataclasses import replace

from bodycheck.adapters.contract import Engine
from bodycheck.adapters.mjx.compiled import check_precision
from bodycheck.adapters.mujoco.robot_terms import leave_out_what_is_not_asked
from bodycheck.adapters.mujoco.robots import described, loaded
from bodycheck.adapters.robot_reading import ModelRefused, RobotFile, RobotReading
from bodycheck.reference.robots.state import RobotState
from bodycheck.reference.robots.terms import Terms
from bodycheck.reference.scene import Vector

with contextlib.redirect_stdout(io.StringIO()):  # MJX prints that the package of its other backend, Warp, is not installed
    from mujoco import mjx

NO_TERMS = "nothing is computed at states: JAX would compile MJX's functions anew for this robot, for minutes"


def read_robot(engine: Engine, file: RobotFile, states: Sequence[RobotState], gravity: Vector) -> RobotReading:
    """Return how MJX reads a file, as `RobotModels.read_robot` does, with empty terms. Raises `ModelRefused`."""
    check_precision(engine)
    compiled = loaded(file.path)
    reading = described(compiled, compiled, file.format)
    leave_out_what_is_not_asked(compiled)
    try:
        kept = mjx.put_model(compiled)
    except NotImplementedError as error:
        raise ModelRefused(f"MJX refuses the model: {error}") from error
    kept_by_mjx = described(compiled, kept, file.format)
    terms = tuple(Terms() for _ in states)
    return replace(reading, bodies=kept_by_mjx.bodies, joints=kept_by_mjx.joints, terms=terms, notes=(*reading.notes, NO_TERMS))
