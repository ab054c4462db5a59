"""Settings of PyBullet's bodies."""

import math

from bodycheck.adapters.contract import Method


def switched_off(method: Method) -> dict[str, float]:
    """Return the arguments of `changeDynamics` that end damping and limits, unless a method keeps them."""
    if method.option("settings") == "engine":
        return {}
    return {"linearDamping": 0.0, "angularDamping": 0.0, "maxJointVelocity": math.inf}
