"""What a user should know of a compiled robot model that has no place in a robot model."""

from collections import Counter

import mujoco
import numpy as np


def notes(model: mujoco.MjModel, format: str) -> tuple[str, ...]:
    """Return what MuJoCo does with a model from a file of a format, besides links and joints."""
    said = []
    if format == "urdf":
        said.append(
            "MuJoCo joins links that are welded, and loses those that are welded to the world, "
            'unless <mujoco><compiler fusestatic="false"/></mujoco> in the file says otherwise'
        )
    said += [f"not compared: {text}" for text in (_equalities(model), _tendons(model), _actuators(model)) if text]
    if format == "urdf" and np.any(model.dof_frictionloss):
        said.append(
            "dry friction is a constraint of up to the number of the file, which opposes the velocity that a joint is about "
            "to have"
        )
    heavy = [name for name in ("tendon_armature", "actuator_armature") if np.any(getattr(model, name, 0.0))]
    if heavy:
        said.append(f"the mass matrix contains armature that is not one of joints ({', '.join(heavy)})")
    if np.any(model.body_gravcomp):
        said.append("the passive force contains gravity compensation (gravcomp)")
    if model.opt.density or model.opt.viscosity:
        said.append("the passive force contains that of a fluid (density, viscosity)")
    curved = [name for name in ("jnt_stiffnesspoly", "dof_dampingpoly") if np.any(getattr(model, name, 0.0))]
    if curved:
        said.append(f"springs or damping are not linear ({', '.join(curved)})")
    return tuple(said)


def _equalities(model: mujoco.MjModel) -> str:
    kinds = Counter(mujoco.mjtEq(int(kind)).name.removeprefix("mjEQ_").lower() for kind in model.eq_type)
    return "equality constraints (" + ", ".join(f"{count} {kind}" for kind, count in kinds.items()) + ")" if kinds else ""


def _tendons(model: mujoco.MjModel) -> str:
    names = (str(model.tendon(place).name) or f"tendon{place}" for place in range(model.ntendon))
    return f"tendons ({', '.join(names)})" if model.ntendon else ""


def _actuators(model: mujoco.MjModel) -> str:
    names = (str(model.actuator(place).name) or f"actuator{place}" for place in range(model.nu))
    geared = (f"{name} with gear {gear[0]:g}" for name, gear in zip(names, model.actuator_gear, strict=True))
    return f"actuators ({', '.join(geared)})" if model.nu else ""
