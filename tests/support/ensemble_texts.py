"""Texts of case files with an ensemble, and of the tables of what varies in it."""

import json
from typing import Any

from tests.support.cases import a_case

#: A brick that tumbles freely, which many members can be made of at once.
BRICK = a_case(
    "brick",
    title="A brick that tumbles",
    body={"shape": "brick", "semi_axes": [0.1, 0.3, 0.2], "mass": 1.0},
    initial={"angular_velocity": [0.5, 5.0, 1.0]},
)


def ensemble_of(text: str, *vary: str) -> str:
    """The text of a case file with 1000 members in which these tables vary."""
    return text + "\n[ensemble]\nmembers = 1000\nseed = 1\n" + "".join(f"[[ensemble.vary]]\n{table}\n" for table in vary)


def uniform(key: str, low: Any, high: Any) -> str:
    return _table(key=key, distribution="uniform", low=low, high=high)


def log_uniform(key: str, low: Any, high: Any) -> str:
    return _table(key=key, distribution="log-uniform", low=low, high=high)


def normal(key: str, mean: Any, standard_deviation: Any) -> str:
    return _table(key=key, distribution="normal", mean=mean, standard_deviation=standard_deviation)


def sphere(key: str, radius: Any) -> str:
    return _table(key=key, distribution="sphere", radius=radius)


def choice(key: str, values: Any) -> str:
    return _table(key=key, distribution="choice", values=values)


def attitude() -> str:
    return _table(distribution="attitude")


def _table(**keys: Any) -> str:
    return "\n".join(f"{name} = {json.dumps(value)}" for name, value in keys.items())
