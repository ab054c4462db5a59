"""Texts of case files with an ensemble, and of the tables of what varies in it."""

import json
from collections.abc import Mapping
from typing import Any

from bodycheck.reference.trajectory import Array
from tests.support.cases import a_case

#: A brick that tumbles freely, which many members can be made of at once.
BRICK = a_case(
    "brick",
    title="A brick that tumbles",
    body={"shape": "brick", "semi_axes": [0.1, 0.3, 0.2], "mass": 1.0},
    initial={"angular_velocity": [0.5, 5.0, 1.0]},
)

#: Cases whose members are made one by one.
CYLINDER_ON_PLANE = a_case(
    body={"shape": "cylinder", "radius": 0.1, "half_length": 0.2, "mass": 1.0},
    initial={"euler_zxz": [0.0, 0.0, 0.5], "euler_rates": [0.0, 0.0, 5.0]},
    scene={"gravity": 9.81, "plane": {}},
)
DRAGGED = a_case(initial={"velocity": [1.0, 0.0, 0.0]}, scene={"drag": {"quadratic": 0.1}})
MOMENTS = a_case(body={"shape": "none", "mass": 1.0, "inertia": [1.0, 2.0, 2.5]})
TENSOR = a_case(body={"shape": "none", "mass": 1.0, "inertia": [[1.0, 0.1, 0.0], [0.1, 2.0, 0.0], [0.0, 0.0, 2.5]]})
PARTS = a_case(
    body={
        "parts": [
            {"shape": "sphere", "radius": 0.1, "mass": 1.0, "position": [0.0, 0.0, 1.0]},
            {"shape": "brick", "semi_axes": [0.1, 0.2, 0.3], "mass": 1.0},
        ]
    }
)
PARTICLES = a_case(body={"particles": [{"mass": 1.0, "position": [float(k == i) for k in range(3)]} for i in range(3)]})


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


def columns_of(values: Mapping[str, Array]) -> dict[str, Array]:
    """Drawn numbers and vectors as columns of single numbers."""
    parts = {key: array[:, None] if array.ndim == 1 else array for key, array in values.items()}
    names = {key: [key] if array.ndim == 1 else [f"{key}.{k}" for k in range(array.shape[1])] for key, array in values.items()}
    return {name: column for key, array in parts.items() for name, column in zip(names[key], array.T, strict=True)}
