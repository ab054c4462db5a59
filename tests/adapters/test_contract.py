"""What the contract asks of an adapter, tried on every adapter whose engine is installed in this environment.

A new adapter is tested here as soon as it is found by its name; nothing is listed. With `--adapter NAME` only that one is
tried, as `make engines` does in the engine's own environment.
"""

import subprocess
import sys
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
import pytest

from bodycheck import load
from bodycheck.adapters import offers, registry
from bodycheck.adapters.contract import (
    KINDS,
    Adapter,
    ContactLaw,
    ContactLoad,
    EngineDiverged,
    Method,
    Models,
    SceneUnsupported,
    Signals,
    Simulation,
    kind_of,
)
from bodycheck.adapters.links import Link, Links, link_of
from bodycheck.errors import BadInput
from bodycheck.reference.kinematics import geodesic_angle
from bodycheck.reference.mechanisms.joint_types import JOINT_TYPES
from bodycheck.reference.requirements import Requirements
from bodycheck.reference.scene import Body, Scene, State
from bodycheck.running.smoke import check
from bodycheck.studies.audit.representations import Representation, along_principal_axes, started
from tests.support.asked import adapter_asked_for

ONLY = adapter_asked_for()
NAMES = [ONLY] if ONLY else [name for name in registry.names() if registry.installed(name)]

#: The modules by which the engines of folders are imported.
ENGINE_MODULES = {module for name in registry.names() for module in getattr(registry.known_installation(name), "imported", ())}

#: A scene of each kind that every engine with that kind of scene can model.
SCENES = {"flight": "osrf-boxes-complex", "drag": "football-drag", "plane": "curling-brick"}

#: What a mechanism may require of an engine.
MECHANISM_EFFECTS = {
    *("controllers", "rigid stops", "elastic stops", "stops that cease to act"),
    *("mechanisms", "loops", "point masses", "armature", "joint damping", "joint springs", "joint friction", "joint efforts"),
    *("contacts", "contacts without a plane", "contacts of bodies on joints", "rolling friction", "torsional friction"),
    *("pushes", "mimic joints", "massless bodies"),
    *(form.effect for form in JOINT_TYPES.values()),
}

#: A turn by 74 degrees about an oblique axis, and a centre of mass in the frame of a link (m).
OBLIQUE, ASIDE = (0.8, 0.2, -0.4, 0.4), (0.4, -0.2, 0.1)


def methods() -> Iterator[tuple[str, str, str]]:
    """Engine, kind of scene and spelling of every method that is run where none is asked for."""
    for name in NAMES:
        for kind, case in SCENES.items():
            yield from ((name, kind, method) for method in offers.offered(registry.load(name).engine, load(case).scene))


METHODS = list(methods())

#: Two parts of a body, neither of which has its centre of mass at its origin or its principal axes along its frame.
LINKS = (
    Link(1.5, (0.03, 0.04, 0.05, 0.002, -0.003, 0.001), (0.1, -0.05, 0.02)),
    Link(0.5, (0.02, 0.01, 0.015, -0.001, 0.002, 0.003), (-0.03, 0.04, 0.1), (0.2, 0.1, -0.3), (0.7, 0.1, 0.5, -0.5)),
)

#: Engine and method of the flights of adapters that take links, without an engine's own settings, which may damp a motion.
LINKED = [
    (name, method)
    for name, kind, method in METHODS
    if kind == "flight" and isinstance(registry.load(name), Links) and not Method.parse(method, 0.0).option("settings")
]


def scene_of(kind: str) -> Scene:
    return load(SCENES[kind]).scene


@pytest.mark.parametrize("name", NAMES)
def test_the_record_of_an_engine_says_what_it_must(name: str) -> None:
    engine = registry.load(name).engine
    assert engine.name == name
    assert engine.distribution == registry.installation(name).distribution
    assert engine.version
    assert engine.integrators
    assert engine.batch >= 1
    assert set(engine.defaults) <= {"integrator", "timestep", "tolerance"}
    assert all(type(value) is str and value for value in engine.defaults.values())
    assert engine.models <= {*Requirements.__dataclass_fields__, *MECHANISM_EFFECTS}
    names = [integrator.name for integrator in engine.integrators]
    assert len(set(names)) == len(names)
    assert all(integrator.kinds <= KINDS for integrator in engine.integrators)
    for spelling in offers.listed(engine):
        assert Method.parse(spelling, 0.0).name == spelling, "not the one spelling of this method"
        offers.check(engine, Method.parse(spelling, 0.0))


@pytest.mark.parametrize("name", [ONLY] if ONLY else registry.names())
def test_what_an_engine_is_installed_from_is_known_without_it(name: str) -> None:
    code = (
        "import sys\nfrom bodycheck.adapters import registry\n"
        f"print(registry.installation({name!r}).distribution, *{{module.partition('.')[0] for module in sys.modules}})"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    distribution, *modules = done.stdout.split()
    assert distribution
    assert not ENGINE_MODULES & set(modules)


@pytest.mark.parametrize("name", NAMES)
def test_obvious_scenes_have_their_obvious_answers(name: str) -> None:
    assert check(name) == []


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("spelling", ["no-such-integrator", "{first}:no-such-option=1", "{first}:model=no-such-model"])
def test_a_misspelled_method_is_bad_input(name: str, spelling: str) -> None:
    engine = registry.load(name).engine
    method = Method.parse(spelling.format(first=engine.integrators[0].name), 1e-3)
    # An engine that has one model of each scene may lack the option `model` itself.
    with pytest.raises(BadInput, match=r"(no-such-\w+|has no option 'model').*(allowed|there are): "):
        offers.check(engine, method)


@pytest.mark.parametrize(("name", "kind", "method"), METHODS)
def test_stepping_in_pieces_is_stepping_at_once(name: str, kind: str, method: str) -> None:
    """To the last bit, with strides of nothing, of one step, and of more than an engine may take in one call."""
    adapter, scene = registry.load(name), scene_of(kind)
    strides = np.array([0, 3, 0, 5, 300 if kind == "plane" else 9000, 1])
    whole = adapter.prepare([scene], Method.parse(method, 1e-4)).advance(strides)
    assert whole.shape == (1, len(strides), 1, 13)
    assert whole.dtype == np.float64
    simulation = adapter.prepare([scene], Method.parse(method, 1e-4))
    pieces = [simulation.advance(part) for part in (strides[:2], strides[2:3], strides[3:])]
    np.testing.assert_array_equal(np.concatenate(pieces, axis=1), whole)


@pytest.mark.parametrize(("name", "kind", "method"), METHODS)
def test_it_begins_at_the_state_of_the_scene(name: str, kind: str, method: str) -> None:
    adapter, scene = registry.load(name), scene_of(kind)
    row = adapter.prepare([scene], Method.parse(method, 1e-3)).advance(np.array([0]))[0, 0, 0]
    initial = scene.initial
    # A border converts frames by a few products, each of which rounds once; the numbers are at most some tens.
    rounding = 45 * float(np.finfo(adapter.engine.precision).eps)
    np.testing.assert_allclose(row[:3], initial.position, rtol=0, atol=rounding)
    assert geodesic_angle(row[3:7], np.array(initial.quaternion)) < rounding
    np.testing.assert_allclose(row[7:], [*initial.velocity, *initial.angular_velocity], rtol=0, atol=10 * rounding)


@pytest.mark.parametrize(("name", "method"), [(name, method) for name, kind, method in METHODS if kind == "flight"])
@pytest.mark.parametrize("count", [1, 2])
def test_links_begin_with_the_state_of_the_first_one(name: str, method: str, count: int) -> None:
    """And stepping them in pieces is stepping them at once, to the last bit."""
    adapter, scene = registry.load(name), scene_of("flight")
    if not isinstance(adapter, Links):
        pytest.skip("its adapter takes no links")
    initial = scene.initial
    try:
        one, other = (adapter.prepare_links(LINKS[:count], scene, Method.parse(method, 1e-4)) for _ in range(2))
    except SceneUnsupported as error:
        pytest.skip(str(error))
    row = one.advance(np.array([0]))[0, 0, 0]
    # As for the state of a scene; the velocities are converted to those of centres of mass and back, with arms below one metre.
    rounding = 45 * float(np.finfo(adapter.engine.precision).eps)
    np.testing.assert_allclose(row[:3], initial.position, rtol=0, atol=rounding)
    assert geodesic_angle(row[3:7], np.array(initial.quaternion)) < rounding
    np.testing.assert_allclose(row[7:], [*initial.velocity, *initial.angular_velocity], rtol=0, atol=10 * rounding)
    pieces = [one.advance(np.array([3])), one.advance(np.array([5, 0]))]
    np.testing.assert_array_equal(np.concatenate(pieces, axis=1), other.advance(np.array([3, 5, 0])))


@pytest.mark.parametrize(("name", "kind", "method"), METHODS)
def test_states_are_copies(name: str, kind: str, method: str) -> None:
    adapter, scene = registry.load(name), scene_of(kind)
    one, other = (adapter.prepare([scene], Method.parse(method, 1e-3)) for _ in range(2))
    one.advance(np.array([0, 10]))[:] = np.nan
    first = other.advance(np.array([0, 10]))
    kept = first.copy()
    np.testing.assert_array_equal(one.advance(np.array([10])), other.advance(np.array([10])))
    np.testing.assert_array_equal(first, kept)


def similar(scene: Scene, part: float, spin: float = 1.0) -> Scene:
    """The scene with a part of its horizontal velocity, and a multiple of its angular velocity."""
    (x, y, z), (a, b, c) = scene.initial.velocity, scene.initial.angular_velocity
    state = replace(scene.initial, velocity=(x * part, y * part, z), angular_velocity=(a * spin, b * spin, c * spin))
    return replace(scene, initial=state)


def tolerance(adapter: Adapter, kind: str) -> float:
    """The largest difference of a scene stepped with others from the same scene alone, absolute and relative.

    None, where the engine steps one scene at a time. One that steps all together may sum in another order.
    """
    if adapter.engine.batch == 1:
        return 0.0
    precision = np.finfo(adapter.engine.precision)
    # Contacts are solved by iterations, which MuJoCo's solver, that of several engines, ends at changes of 1e-8. In single
    # precision it cannot reach that, and a start that is one rounding off moves the states of these scenes by up to 0.3 in MJX,
    # by 0.001 in most; the scenes themselves differ by 0.06 and more.
    iterations = 0.0 if kind != "plane" else 1e-7 if precision.dtype == np.float64 else 1e-2
    return max(1e3 * float(precision.eps), iterations)


@pytest.mark.parametrize(("name", "kind", "method"), METHODS)
def test_several_scenes_are_each_as_if_it_were_alone(name: str, kind: str, method: str) -> None:
    """Row k of several scenes is the run of scene k alone, whatever becomes of the others: of the third, something impossible.

    To the last bit, where the engine steps one scene at a time. One that steps all together may sum in another order.
    """
    adapter, spelled = registry.load(name), Method.parse(method, 1e-3)
    precision = np.finfo(adapter.engine.precision)
    scenes = [similar(scene_of(kind), part) for part in (1.0, 0.5, 0.25, 0.125, 0.0625)]
    scenes[2] = similar(scene_of(kind), 1.0, spin=float(precision.max) ** 0.75)  # its square is too large for a number
    pieces = np.array([0, 7, 20]), np.array([3])
    simulation = offers.prepare(adapter, scenes, spelled)
    with np.errstate(all="ignore"):  # as in every run
        together = np.concatenate([simulation.advance(strides) for strides in pieces], axis=1)
    assert together.shape == (5, 4, 1, 13)
    limit = tolerance(adapter, kind)
    signals: list[str] = []
    for place, (scene, rows) in enumerate(zip(scenes, together, strict=True)):
        alone = adapter.prepare([scene], spelled)
        try:
            with np.errstate(all="ignore"):
                expected = np.concatenate([alone.advance(strides)[0] for strides in pieces])
        except EngineDiverged as signal:
            signals.append(str(signal))
            expected = np.full((1, 1, 13), np.nan)
        if place == 2:
            assert np.isfinite(rows[-1]).all() == np.isfinite(expected[-1]).all()
        else:
            np.testing.assert_allclose(rows, expected, rtol=limit, atol=limit)
    assert signals == (list(simulation.signals.values()) if isinstance(simulation, Signals) else [])


@pytest.mark.parametrize(("name", "kind", "method"), METHODS)
def test_scenes_with_other_bodies_and_gravities_are_each_as_if_it_were_alone(name: str, kind: str, method: str) -> None:
    adapter, spelled, scene = registry.load(name), Method.parse(method, 1e-3), scene_of(kind)
    varies = adapter.engine.varies
    if not varies:
        pytest.skip("its scenes differ in their initial states alone")
    scenes = []
    for place, one in enumerate(similar(scene, part) for part in (1.0, 0.5, 0.25, 0.125)):
        factor = 1 + place / 4
        body = replace(one.body, mass=factor * one.body.mass, moments=tuple(factor * own for own in one.body.moments))
        changed = replace(one, body=body) if "body" in varies else one
        scenes.append(replace(changed, gravity=factor * one.gravity) if "gravity" in varies else changed)
    strides, limit = np.array([0, 7, 20]), tolerance(adapter, kind)
    together = adapter.prepare(scenes, spelled).advance(strides)
    for one, rows in zip(scenes, together, strict=True):
        np.testing.assert_allclose(rows, adapter.prepare([one], spelled).advance(strides)[0], rtol=limit, atol=limit)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("kind", SCENES)
def test_the_models_of_a_scene_grow_from_one_that_can_be_run(name: str, kind: str) -> None:
    adapter, scene = registry.load(name), scene_of(kind)
    if not isinstance(adapter, Models):
        pytest.skip("its engine models a scene in one way")
    assert kind_of(scene) == kind
    for integrator in offers.offered(adapter.engine, scene):
        for model in adapter.models(scene, integrator).values():
            method = Method.parse(model.method, 1e-3)
            offers.check(adapter.engine, method)
            assert offers.not_offered(adapter.engine, scene, method) is None
            assert model.adds
            assert adapter.prepare([scene], method).advance(np.array([1])).shape == (1, 1, 1, 13)


@pytest.mark.parametrize(("name", "method"), [(name, method) for name, kind, method in METHODS if kind == "plane"])
def test_a_contact_is_known_by_its_law_and_its_load(name: str, method: str) -> None:
    adapter, scene = registry.load(name), scene_of("plane")
    if not isinstance(adapter, ContactLaw | ContactLoad):
        pytest.skip("its adapter does not tell of contacts")
    if isinstance(adapter, ContactLaw):
        law = adapter.contact_law(scene, Method.parse(method, 1e-3))
        assert law is None or law.friction == scene.plane.friction
    load = adapter.contact_load(scene, Method.parse(method, 1e-3), 50) if isinstance(adapter, ContactLoad) else None
    if load is not None:
        assert load.shape == (50,)
        assert (load >= 0).all()
        # Momentum: the load is the weight and what throws the body up, as convex contact does where it slides. To half of the
        # weight, because the load may be that of one stage of each step.
        rows = adapter.prepare([scene], Method.parse(method, 1e-3)).advance(np.array([0, 50]))[0, :, 0]
        weight = scene.body.mass * scene.gravity
        thrown = scene.body.mass * (rows[1, 9] - rows[0, 9]) / 50e-3
        assert load.mean() == pytest.approx(weight + thrown, abs=0.5 * weight)


@pytest.mark.parametrize(("name", "method"), LINKED)
def test_one_link_about_its_centre_of_mass_is_the_body(name: str, method: str) -> None:
    adapter, scene = registry.load(name), scene_of("flight")
    scene = replace(scene, body=replace(scene.body, axes=OBLIQUE))  # so that its tensor has products of inertia
    strides, own = np.array([0, 50]), Method.parse(method, 1e-3)
    body = adapter.prepare([scene], own).advance(strides)[0, :, 0]
    link = prepared_links(adapter, [link_of(scene.body)], scene, own).advance(strides)[0, :, 0]
    # Some roundings a step, of numbers up to some tens; an engine may find the principal axes of a tensor by itself.
    rounding = 1e4 * float(np.finfo(adapter.engine.precision).eps)
    np.testing.assert_allclose(np.delete(link, slice(3, 7), 1), np.delete(body, slice(3, 7), 1), rtol=0, atol=rounding)
    assert geodesic_angle(link[:, 3:7], body[:, 3:7]).max() < rounding


@pytest.mark.parametrize(("name", "method"), LINKED)
def test_a_centre_of_mass_off_the_origin_moves_on_a_straight_line(name: str, method: str) -> None:
    """Which shows that later states are those of the origin of the link's frame, as the first one is."""
    adapter, own = registry.load(name), Method.parse(method, 1e-3)
    whole = Scene(Body(2.0, (0.3, 0.4, 0.5)), State((1.0, 2.0, 3.0), OBLIQUE, (1.0, -2.0, 0.5), (3.0, 4.0, -5.0)))
    aside = Representation("", whole.body, (replace(link_of(whole.body), center_of_mass=ASIDE),), centre=ASIDE)
    scene = started(aside, whole)
    rows = prepared_links(adapter, aside.links, scene, own).advance(np.array([100]))[0, :, 0]
    (centre,) = along_principal_axes(aside, rows)
    # A scheme of first order is some millimetres off in 0.1 s; the velocity of another point would be 0.2 m off.
    np.testing.assert_allclose(centre[:3], np.array(whole.initial.position) + 0.1 * np.array(whole.initial.velocity), atol=0.02)
    np.testing.assert_allclose(centre[7:10], whole.initial.velocity, atol=0.1)


def prepared_links(adapter: Adapter, links: Sequence[Link], scene: Scene, method: Method) -> Simulation:
    """The simulation of a body of links; the test is skipped where the engine refuses it."""
    assert isinstance(adapter, Links)
    try:
        return adapter.prepare_links(links, scene, method)
    except SceneUnsupported as refused:
        pytest.skip(str(refused))
