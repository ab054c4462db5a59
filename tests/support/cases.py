"""Cases that tests are made of."""

import json
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

from bodycheck import Case, load
from bodycheck.casefile.case import shipped
from bodycheck.reference.requirements import touches
from bodycheck.reference.scene import Scene

SPHERE = {"shape": "sphere", "radius": 0.1, "mass": 1.0}
SPINNING = {"angular_velocity": [0.0, 0.0, 5.0]}
HALF_A_SECOND = {"duration": 0.5, "samples": 6}

Table = Mapping[str, Any]

_SHIPPED = {name: load(name).scene for name in shipped()}

#: The names of the shipped cases of one body.
OF_ONE_BODY = tuple(name for name, scene in _SHIPPED.items() if isinstance(scene, Scene))

#: The names of the shipped cases whose bodies touch otherwise than one that lies flat on a level plane.
TOUCHING = tuple(name for name, scene in _SHIPPED.items() if touches(scene))


def a_case(
    name: str = "spin",
    *,
    title: str = "A sphere that spins",
    tags: Iterable[str] = (),
    body: Table = SPHERE,
    initial: Table = SPINNING,
    scene: Table | None = None,
    run: Table = HALF_A_SECOND,
    extremes: Table | None = None,
    expect: Iterable[Table] = (),
) -> str:
    """The text of a case file: a sphere that spins for half a second where nothing acts on it, unless something is given.

    The text ends with the tables of what is expected, so that others can be added to it.
    """
    head = {"format": 1, "name": name, "title": title} | ({"tags": list(tags)} if tags else {})
    tables = {"body": body, "initial": initial, "scene": scene, "run": run, "extremes": extremes}
    lines = list(_lines(head))
    for heading, table in tables.items():
        if table is not None:
            lines += [f"[{heading}]", *_lines(table)]
    for table in expect:
        lines += ["[[expect]]", *_lines(table)]
    return "\n".join(lines) + "\n"


def expecting(engine: str, integrator: str, timestep: float, **limits: Any) -> dict[str, Any]:
    """What is expected of a method with a time step (s), as `a_case` takes it: limits by name."""
    return {"engine": engine, "integrator": integrator, "timestep": timestep, **limits}


def shortened(case: Case, duration: float, samples: int) -> Case:
    """The same case with another duration (s) and number of samples, and without its expectations, which do not apply."""
    return replace(case, duration=duration, samples=samples, expectations=())


def _lines(table: Table) -> Iterable[str]:
    return (f"{key} = {_value(value)}" for key, value in table.items())


def _value(value: Any) -> str:
    """A value as TOML writes it: tables within a line, also those of an array, all else as JSON does."""
    if isinstance(value, Mapping):
        return "{" + ", ".join(_lines(value)) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(_value, value)) + "]"
    return json.dumps(value, ensure_ascii=False)


#: A spin about a principal axis, which the miniature engines know exactly.
STEADY_SPIN = shortened(load("osrf-boxes-simple"), 1.0, 11)
