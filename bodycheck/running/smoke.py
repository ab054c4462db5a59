"""Check adapters with scenes that have an obvious solution, so that a broken adapter is not reported as a wrong engine."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bodycheck.adapters import offers, registry
from bodycheck.adapters.contract import Adapter, Method, Models, kind_of
from bodycheck.adapters.engine_name import EngineName
from bodycheck.adapters.roles import ALIASES, resolved
from bodycheck.processes import pool
from bodycheck.processes.failures import crash
from bodycheck.reference.kinematics import geodesic_angle
from bodycheck.reference.scene import Body, Scene, State
from bodycheck.reference.trajectory import Array
from bodycheck.running.engines import home

#: Time step and number of steps of a check.
TIMESTEP_S = 1e-3
STEPS = 100

#: Time limit (s) of the check of one engine.
TIME_LIMIT_S = 300.0

#: Tolerance of lengths, speeds and angles of order one. It exceeds the error of any consistent scheme in 100 steps of a
#: millisecond, and is below the effect of a wrong axis, frame, sign or quaternion order.
TOLERANCE = 0.02

#: The body of all scenes.
BODY = Body(mass=2.0, moments=(0.3, 0.4, 0.5))

#: The sine and the cosine of 45 degrees.
HALF = math.sqrt(0.5)

# The principal axes lie along K, (I + J) / sqrt(2) and (J - I) / sqrt(2) of the body.
COSINE, SINE = math.sqrt((2 + math.sqrt(2)) / 8), math.sqrt((2 - math.sqrt(2)) / 8)
OBLIQUE = (COSINE, -SINE, -COSINE, -SINE)


@dataclass(frozen=True)
class Obvious:
    """A scene, and the state of its body after 0.1 s."""

    name: str
    scene: Scene
    after: State


#: The scenes of the check.
SCENES = (
    Obvious(
        "a body falls straight down",
        Scene(BODY, State((1.0, 2.0, 3.0)), gravity=100.0),
        State((1.0, 2.0, 3.0 - 0.5 * 100.0 * 0.1**2), velocity=(0.0, 0.0, -10.0)),
    ),
    Obvious(
        "a velocity is one of the world frame",
        Scene(BODY, State(quaternion=(HALF, 0.0, 0.0, HALF), velocity=(1.0, 2.0, 3.0))),
        State((0.1, 0.2, 0.3), (HALF, 0.0, 0.0, HALF), (1.0, 2.0, 3.0)),
    ),
    *(
        Obvious(
            f"a spin about {name} turns about {name}",
            Scene(BODY, State(angular_velocity=(10 * i, 10 * j, 10 * k))),
            State(
                quaternion=(math.cos(0.5), math.sin(0.5) * i, math.sin(0.5) * j, math.sin(0.5) * k),
                angular_velocity=(10 * i, 10 * j, 10 * k),
            ),
        )
        for name, (i, j, k) in {"I": (1.0, 0.0, 0.0), "J": (0.0, 1.0, 0.0), "K": (0.0, 0.0, 1.0)}.items()
    ),
    Obvious(
        "a spin about an oblique principal axis is steady",
        Scene(replace(BODY, axes=OBLIQUE), State(angular_velocity=(-10 * HALF, 10 * HALF, 0.0))),
        State(
            quaternion=(math.cos(0.5), -math.sin(0.5) * HALF, math.sin(0.5) * HALF, 0.0),
            angular_velocity=(-10 * HALF, 10 * HALF, 0.0),
        ),
    ),
    Obvious(
        # J points along -x: the body is turned by 90 degrees about z, and then by 1 rad about its own J.
        "an angular velocity is one of the body frame",
        Scene(BODY, State(quaternion=(HALF, 0.0, 0.0, HALF), angular_velocity=(0.0, 10.0, 0.0))),
        State(
            quaternion=(HALF * math.cos(0.5), -HALF * math.sin(0.5), HALF * math.sin(0.5), HALF * math.cos(0.5)),
            angular_velocity=(0.0, 10.0, 0.0),
        ),
    ),
)


def methods(adapter: Adapter, scene: Scene) -> Iterator[str]:
    """Yield the spellings of the offered methods for a scene, those of the engine's roles, and each with all models of it."""
    of_roles = resolved(adapter.engine, kind_of(scene), ALIASES)
    for integrator in dict.fromkeys((*offers.offered(adapter.engine, scene), *of_roles)):
        yield integrator
        if isinstance(adapter, Models):
            yield from (model.method for model in adapter.models(scene, integrator).values())


def check(engine: str) -> list[str]:
    """Return the faults of an engine's adapter, one sentence each; empty if there are none. Raises `EngineMissing`."""
    adapter = registry.load(engine)
    faults: list[str] = []
    raised: dict[str, list[str]] = {}
    for obvious in SCENES:
        for integrator in methods(adapter, obvious.scene):
            try:
                simulation = offers.prepare(adapter, [obvious.scene], Method.parse(integrator, TIMESTEP_S))
                # The initial state is checked too, which finds errors in the conversion of scenes.
                returned = simulation.advance(np.array([0, STEPS]))
                start, end = np.array(returned)[0, :, 0]
                simulation.advance(np.array([1]))
            except Exception as error:  # any exception is a fault of the adapter
                what = f"{crash(error).reason}{registry.frame(EngineName.parse(engine).adapter, error)}"
                raised.setdefault(what, []).append(f"{engine} {integrator}: {obvious.name}")
                continue
            comparisons = (("at the start", start, obvious.scene.initial), ("after 0.1 s", end, obvious.after))
            for when, row, state in comparisons[:1] if _own_settings(integrator) else comparisons:
                faults += [f"{engine} {integrator}: {obvious.name}, but {when} its {wrong}" for wrong in _wrong(row, state)]
            if not np.array_equal(returned[0, :, 0], [start, end]):
                faults.append(
                    f"{engine} {integrator}: {obvious.name}, but its states change when it goes on: they are no copies"
                )
    return [*(_of_exception(what, checks) for what, checks in raised.items()), *faults]


def _of_exception(what: str, checks: Sequence[str]) -> str:
    """Return the fault that some checks raise an exception, which is told once."""
    first, *others = checks
    more = f"; so {'does' if len(others) == 1 else 'do'} {len(others)} further check{'s' * (len(others) > 1)}" if others else ""
    return f"{first}, but it raises {what}{more}"


def check_all(engines: Sequence[str]) -> dict[str, list[str]]:
    """Return the faults of the adapters of engines by name, found in worker processes. Raises no exception of an engine."""
    with pool.Workers(check, jobs=1, limit=TIME_LIMIT_S, group=str, home=home) as workers:
        answers = dict(workers.map(engines))
    return {name: one if isinstance(one := answers[name], list) else [f"{name}: {one.reason}"] for name in engines}


def _own_settings(spelling: str) -> bool:
    """Return whether a method keeps its engine's settings, which may damp or limit motions: only the start is obvious."""
    return Method.parse(spelling, TIMESTEP_S).option("settings") == "engine"


def _wrong(row: Array, state: State) -> list[str]:
    parts = {
        "position": (row[:3], state.position),
        "velocity": (row[7:10], state.velocity),
        "angular velocity": (row[10:], state.angular_velocity),
    }
    wrong = [
        f"{name} is {np.round(got, 4).tolist()}, not {list(expected)}"
        for name, (got, expected) in parts.items()
        if not np.linalg.norm(got - np.array(expected)) <= TOLERANCE * max(1.0, float(np.linalg.norm(expected)))
    ]
    if not geodesic_angle(np.asarray(row[3:7]), np.array(state.quaternion)) <= TOLERANCE:
        wrong.append(f"quaternion is {np.round(row[3:7], 4).tolist()}, not {np.round(state.quaternion, 4).tolist()}")
    return wrong
