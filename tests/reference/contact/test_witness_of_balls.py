"""The second way of spheres and cylinders: it agrees with the first, and the bounds grow to the size of any planted fault."""

import ast
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bodycheck.reference.bounds import STATES
from bodycheck.reference.certificate import certify
from bodycheck.reference.contact import witness
from bodycheck.reference.contact.round import ball as laws
from bodycheck.reference.contact.round import phases
from bodycheck.reference.contact.witness import balls
from bodycheck.reference.exact import inertia, start
from bodycheck.reference.requirements import touches
from bodycheck.reference.scene import Definition, Nearest, Plane, Scene, Solid, Sphere, State
from bodycheck.reference.truth import computed, truth
from bodycheck.reference.truths import distance
from bodycheck.reference.witness import as_way, distances, event_distances
from tests.support import ROOT
from tests.support.round_bodies import ball_on, roller_on

Patch = pytest.MonkeyPatch

TIMES = np.linspace(0.0, 1.5, 31)

#: The number of random scenes in the default suite, and in all.
FEW, MANY = 16, 300

#: A ball that bounces with spin, slips and then rolls.
THROWN = ball_on(
    Plane(0.2, restitution=0.5),
    State((0.0, 0.0, 0.6), velocity=(2.0, 1.0, -1.0), angular_velocity=(20.0, -40.0, 6.0)),
)

#: A ball that slips with backspin and sidespin on a level plane, and then rolls.
SLIDING = ball_on(Plane(0.3), State((0.0, 0.0, 0.1), velocity=(2.0, 0.5, 0.0), angular_velocity=(1.0, -30.0, 5.0)))

#: A ball that slips across the fall line of an incline and then rolls.
ACROSS = ball_on(
    Plane(0.3, incline=0.4),
    State((0.0, 0.0, 0.1), velocity=(-1.0, 2.0, 0.0), angular_velocity=(5.0, -8.0, 3.0)),
)


def random_scene(seed: int) -> Scene:
    """A sphere, or a cylinder on its side, that is thrown, dropped or set on any plane."""
    rng = np.random.default_rng(seed)
    plane = Plane(
        float(rng.choice([0.0, 0.1, 0.5, rng.uniform(0, 1.5)])),
        incline=float(rng.choice([0.0, 0.4, rng.uniform(0.1, 1.2)])),
        restitution=float(rng.choice([0.0, 0.5, 0.9, 1.0])),
    )
    radius = float(rng.choice([0.05, 0.1, 1.0]))
    velocity, spin = rng.normal(size=3) * rng.choice([0.01, 1.0, 3.0]), rng.normal(size=3) * rng.choice([0.0, 1.0, 20.0])
    height = radius + float(rng.choice([0.0, 0.5]))
    velocity[2] = 0.0 if height == radius else velocity[2]
    x, y, z = velocity.tolist()
    if seed % 3:
        attitude = rng.normal(size=4).tolist()
        begin = State((0.0, 1.0, height), tuple(attitude), (x, y, z), tuple(spin.tolist()))
        return ball_on(plane, begin, radius=radius)
    lying = np.sqrt(0.5), -np.sqrt(0.5), 0.0, 0.0
    begin = State((0.0, 1.0, height), lying, (x, 0.0, z), (0.0, 0.0, float(spin[2])))
    return roller_on(plane, begin, radius=radius)


@pytest.mark.parametrize("seed", [pytest.param(seed, marks=pytest.mark.slow) if seed >= FEW else seed for seed in range(MANY)])
def test_both_ways_agree_within_their_bounds(seed: int) -> None:
    scene = random_scene(seed)
    assert touches(scene)
    found = computed(scene, TIMES)
    (second,) = found.witnesses
    first = as_way("", found.truth.trajectory, found.own_bounds, found.own_events)
    for name, apart in distances(first, second).items():
        assert (apart <= getattr(first, name) + getattr(second, name)).all()
    assert first.events is not None
    assert second.events is not None
    assert not any(event_distances(first.events, second.events, TIMES[-1]))
    assert not any(event_distances(second.events, first.events, TIMES[-1]))
    # An error of the witness is none of the truth.
    assert all((getattr(found.truth.bounds, name) == getattr(found.own_bounds, name)).all() for name in STATES)


def bouncier(patch: Patch) -> None:
    right = phases.after_impact
    patch.setattr(
        phases,
        "after_impact",
        lambda ball, before: right(replace(ball, restitution=ball.restitution * np.longdouble(1 + 1e-6)), before),
    )


def late_impact(patch: Patch) -> None:
    right = phases._fall
    patch.setattr(phases, "_fall", lambda ball, body: (right(ball, body)[0] + 1e-9, right(ball, body)[1]))


def friction_along_the_slip(patch: Patch) -> None:
    right = laws.gripping
    patch.setattr(laws, "gripping", lambda ball, sliding, normal: -right(ball, sliding, normal))


def turned_friction(patch: Patch) -> None:
    right = laws.gripping

    def aside(ball: Any, sliding: Any, normal: Any) -> Any:
        x, y, z = right(ball, sliding, normal)
        return np.array([x - 1e-6 * y, y + 1e-6 * x, z])

    patch.setattr(laws, "gripping", aside)


def reversed_slip(patch: Patch) -> None:
    right = phases._slipping

    def backwards(ball: Any, body: Any, sliding: Any) -> Any:
        phase, lasting = right(ball, body, sliding)
        return replace(phase, spin_rate=-phase.spin_rate), lasting

    patch.setattr(phases, "_slipping", backwards)


def wrong_moment(patch: Patch) -> None:
    right = inertia.moments
    patch.setattr(inertia, "moments", lambda *given: tuple(moment * 5 / 3 for moment in right(*given)))


#: Faults in the first way, with a scene that each changes, and a state.
FAULTS: dict[Callable[[Patch], None], tuple[Scene, str]] = {
    bouncier: (THROWN, "position"),
    late_impact: (THROWN, "position"),
    friction_along_the_slip: (THROWN, "velocity"),
    turned_friction: (THROWN, "velocity"),
    reversed_slip: (SLIDING, "angular_velocity"),
    wrong_moment: (THROWN, "position"),
}


def solid(scene: Scene) -> Scene:
    """The scene with its sphere as a solid of a file, from which the moments of inertia follow."""
    shape = scene.body.shape
    assert isinstance(shape, Sphere)
    initial = scene.initial
    nearest = Nearest(scene.body.moments, scene.body.axes, initial.quaternion, initial.angular_velocity)
    given = Definition(Solid(shape, scene.body.mass), initial.quaternion, initial.angular_velocity, nearest)
    return replace(scene, definition=given)


@pytest.fixture
def starts() -> Iterator[None]:
    """Starts that are computed with a fault are not kept."""
    yield
    start.start.cache_clear()
    start.defined_inertia.cache_clear()


@pytest.mark.usefixtures("starts")
@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.__name__)
def test_a_planted_fault_shows_in_full(fault: Callable[[Patch], None], monkeypatch: Patch) -> None:
    thrown, state = FAULTS[fault]
    scene = solid(thrown)
    right = truth(scene, TIMES)
    fault(monkeypatch)
    start.start.cache_clear()
    start.defined_inertia.cache_clear()
    found = certify(scene, TIMES)
    error = distance(getattr(found.truth.trajectory, state), getattr(right.trajectory, state))
    worst = int(np.argmax(error))
    share = error[worst] / getattr(found.truth.bounds, f"{state}_error")[worst]
    assert error[worst] > 1e-9
    # The whole difference is added to the bound.
    assert 0.5 <= share <= 1
    assert not found.certified
    assert found.faults[0].startswith("truth and Newton's and Euler's equations")


def test_a_fault_in_the_course_of_events_is_named(monkeypatch: Patch) -> None:
    late_impact(monkeypatch)
    found = certify(THROWN, TIMES)
    fault = next(fault for fault in found.faults if "event" in fault)
    assert "has the event impact at t = " in fault
    assert found.truth.events[0].error == pytest.approx(1e-9, rel=1e-3)


def test_a_slip_across_the_fall_line_is_cross_checked() -> None:
    found = certify(ACROSS, TIMES)
    assert found.faults == ()
    assert found.bound[-1] < 1e-15  # half of the first way's bound is the rounding of the quaternion


def test_a_witness_that_is_wrong_is_a_contradiction(monkeypatch: Patch) -> None:
    right = balls.moment
    monkeypatch.setattr(balls, "moment", lambda body: right(body) * 5 / 3)
    found = certify(THROWN, TIMES)
    assert found.faults
    assert found.truth.bounds.position_error[-1] > 1e-3


def test_the_second_way_imports_nothing_of_the_first() -> None:
    """Of the reference, it may use the description of scenes, their second reading, collocation, and its result's type."""
    folder = Path(witness.__file__).parent
    allowed = (
        *("bodycheck.reference.bounds", "bodycheck.reference.errors", "bodycheck.reference.scene"),
        *("bodycheck.reference.trajectory", "bodycheck.reference.witness", "bodycheck.reference.independent"),
        *("bodycheck.reference.mechanisms.mechanism", "bodycheck.reference.mechanisms.control"),  # descriptions of scenes
        "bodycheck.reference.contact.witness",
        "bodycheck.reference.integration.collocation",  # which integrates any equations
    )
    modules = sorted(folder.rglob("*.py"))
    assert len(modules) > 3
    for path in modules:
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.module and node.module.startswith("bodycheck."):
                assert node.module.startswith(allowed), f"{path.relative_to(ROOT.resolve())} imports {node.module}"
