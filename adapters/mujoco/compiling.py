"""Compile XML texts to MuJoCo's models."""

from functools import lru_cache

import mujoco

from bodycheck.adapters.contract import SceneUnsupported


@lru_cache(maxsize=8)
def compiled_model(xml: str) -> mujoco.MjModel:
    """Return MuJoCo's model of an XML text. Raises `SceneUnsupported` if MuJoCo refuses it.

    The initial state is in MuJoCo's data and nothing changes a model, so runs of one scene and method share theirs: timing and
    the comparison of runs with perturbed initial states prepare the same model many times.
    """
    try:
        return mujoco.MjModel.from_xml_string(xml)
    except ValueError as error:
        raise SceneUnsupported(f"MuJoCo refuses the model: {' '.join(str(error).split())}") from error
