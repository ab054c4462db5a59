"""The witness of a slide: its own law of friction, and the faults that it must see in what all formulations share."""

import math
from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from bodycheck.reference import planar
from bodycheck.reference.exact.start import defined_scene
from bodycheck.reference.kinematics import geodesic_angle
from bodycheck.reference.scene import Body, Brick, Cylinder, Definition, EulerAngles, Plane, Scene, Solid
from bodycheck.reference.sliding import motion
from bodycheck.reference.sliding.friction import Law, friction
from bodycheck.reference.sliding.motion import Slide, slide
from bodycheck.reference.sliding.quadrature import accelerations, flat
from bodycheck.reference.sliding.ways import ways
from bodycheck.reference.trajectory import Array
from bodycheck.reference.witness import Witness, angle_between

TIMES = np.linspace(0, 2, 101)
BRICK, DISK = Brick((0.1, 0.2, 0.05)), Cylinder(0.1, 0.02)


@cache
def slid(scene: Scene) -> Slide:
    """The right slide at `TIMES`, computed once for all faults."""
    return slide(scene, TIMES)


def defined(shape: Brick | Cylinder, velocity: tuple[float, float], spin: float, plane: Plane) -> Scene:
    """A body that lies on a plane, turned by 0.4 rad, as from a file."""
    height = shape.semi_axes[2] if isinstance(shape, Brick) else shape.half_length
    scene = defined_scene(Definition(Solid(shape, 2.0), EulerAngles(0.5, 0.0, -0.1), (0.0, 0.0, spin)), shape)
    initial = replace(scene.initial, position=(0.3, -0.2, height), velocity=(*velocity, 0.0))
    return replace(scene, initial=initial, gravity=9.81, plane=plane)


SLIDES = {
    "area": defined(BRICK, (2.0, 0.3), 10.0, Plane(0.5)),
    "area, balanced": defined(BRICK, (2.0, 0.3), 10.0, Plane(0.5, "area", "balanced")),
    "corners": defined(BRICK, (2.0, 0.3), 10.0, Plane(0.5, "corners")),
    "disk": defined(DISK, (2.0, 0.3), 10.0, Plane(0.5)),
}
CLOSED = {
    "spin": defined(BRICK, (0.0, 0.0), 10.0, Plane(0.5)),
    "decoupled": defined(BRICK, (2.0, 0.3), 10.0, Plane(0.5, "decoupled")),
}


@pytest.mark.parametrize("shape", [BRICK, DISK, Brick((1.0, 0.03, 0.01))])
@pytest.mark.parametrize("plane", [Plane(0.5), Plane(0.5, "corners"), Plane(0.3, "area", "balanced"), Plane(0.5, "decoupled")])
def test_the_quadrature_is_the_law_of_friction(shape: Brick | Cylinder, plane: Plane) -> None:
    """Wherever the instantaneous centre is; to 1e-11 of mu g, as the boundary integrals of a slender face lose four digits."""
    if isinstance(shape, Cylinder) and plane.law == "corners":
        pytest.skip("a cylinder has no corners")
    scene = defined(shape, (1.0, 0.0), 1.0, plane)
    law, body, rng = friction(scene.body, plane, 9.81), flat(scene), np.random.default_rng(1)
    reach, count = math.hypot(*shape.semi_axes[:2]) if isinstance(shape, Brick) else shape.radius, 300
    spin, heading, yaw = rng.normal(size=count), rng.uniform(0, 2 * np.pi, count), rng.uniform(-3, 3, count)
    speed = np.abs(spin) * reach * 10 ** rng.uniform(-3, 3, count)
    speed[:100] = np.abs(spin[:100]) * reach * (1 + 10 ** rng.uniform(-12, -1, 100))
    k = math.sqrt(scene.body.moments[2] / scene.body.mass)
    found = accelerations(body, yaw, np.column_stack([speed * np.cos(heading), speed * np.sin(heading), k * spin]))
    for row, psi, v, angle, w in zip(found, yaw, speed, heading, spin, strict=True):
        f1, f2, torque = law(v * math.cos(angle - psi), v * math.sin(angle - psi), w)
        c, s = math.cos(psi), math.sin(psi)
        expected = np.array([c * f1 - s * f2, s * f1 + c * f2, torque / k]) / scene.body.mass
        np.testing.assert_allclose(row, expected, rtol=0, atol=1e-11 * plane.friction * 9.81)


def scaled(force: float, torque: float) -> Callable[[Body, Plane, float], Law]:
    def planted(body: Body, plane: Plane, gravity: float) -> Law:
        law = friction(body, plane, gravity)

        def wrong(v1: float, v2: float, w: float) -> tuple[float, float, float]:
            f1, f2, moment = law(v1, v2, w)
            return force * f1, force * f2, torque * moment

        return wrong

    return planted


def with_a_wrong_moment(scene: Scene) -> Scene:
    """The scene as it would be made of its file if moments C were 3/4 of what they are."""
    a, b, c = scene.body.moments
    wrong = (a, b, 0.75 * c)
    assert scene.definition is not None
    assert scene.definition.nearest is not None
    definition = replace(scene.definition, nearest=replace(scene.definition.nearest, moments=wrong))
    return replace(scene, body=replace(scene.body, moments=wrong), definition=definition)


def errors(wrong: Slide, right: Slide) -> Array:
    one, other = wrong.trajectory, right.trajectory
    return np.stack(
        [
            np.linalg.norm(one.position - other.position, axis=1),
            geodesic_angle(one.quaternion, other.quaternion),
            np.linalg.norm(one.velocity - other.velocity, axis=1),
            np.linalg.norm(one.angular_velocity - other.angular_velocity, axis=1),
        ]
    )


def assert_bounded(wrong: Slide, right: Slide) -> None:
    """The fault moves the body by far more than rounding, and no further than the bounds of the wrong slide."""
    bounds = np.stack([wrong.position_error, wrong.error, wrong.velocity_error, wrong.angular_velocity_error])
    found = errors(wrong, right)
    assert found.max() > 1e-7
    # The right slide has errors of rounding too.
    assert (found <= bounds + 1e-11).all()


@pytest.mark.parametrize("name", [*SLIDES, *CLOSED])
def test_a_wrong_torque_is_in_the_bound(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    scene = {**SLIDES, **CLOSED}[name]
    right = slid(scene)
    monkeypatch.setattr(motion, "friction", scaled(1.0, 1.01))
    assert_bounded(slide(scene, TIMES), right)


@pytest.mark.parametrize("name", SLIDES)
def test_a_slightly_wrong_force_is_in_the_bound(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    right = slid(SLIDES[name])
    monkeypatch.setattr(motion, "friction", scaled(1 + 1e-6, 1.0))
    assert_bounded(slide(SLIDES[name], TIMES), right)


@pytest.mark.parametrize("name", [*SLIDES, *CLOSED])
def test_a_wrong_moment_of_inertia_is_in_the_bound(name: str) -> None:
    scene = {**SLIDES, **CLOSED}[name]
    assert_bounded(slide(with_a_wrong_moment(scene), TIMES), slid(scene))


@pytest.mark.parametrize("name", [*SLIDES, *CLOSED])
def test_a_yaw_of_the_wrong_sign_is_in_the_bound(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The yaw is 0.8 rad off from the beginning, and that of the stop too."""
    scene = {**SLIDES, **CLOSED}[name]
    yaw = planar.yaw
    monkeypatch.setattr(planar, "yaw", lambda quaternion: -yaw(quaternion))
    found = slide(scene, TIMES)
    assert (found.error >= 0.8).all()


def test_a_moment_that_the_scene_states_is_no_fault() -> None:
    """A scene in which the moment was replaced is the scene of the new number."""
    scene = SLIDES["area"]
    a, b, c = scene.body.moments
    other = slide(replace(scene, body=replace(scene.body, moments=(a, b, 0.75 * c))), TIMES)
    assert other.error[-1] < 1e-11


def excess(one: Witness, other: Witness) -> float:
    """The largest disagreement of two ways over what their bounds allow."""
    return max(
        float((angle_between(one.quaternion, other.quaternion) / (one.error + other.error)).max()),
        float((np.linalg.norm(one.position - other.position, axis=1) / (one.position_error + other.position_error)).max()),
        float((np.linalg.norm(one.velocity - other.velocity, axis=1) / (one.velocity_error + other.velocity_error)).max()),
    )


@pytest.mark.parametrize("name", [*SLIDES, *CLOSED])
def test_all_ways_agree_within_their_bounds_unless_one_is_wrong(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    scene = {**SLIDES, **CLOSED}[name]
    found = ways(scene, TIMES)
    assert len(found) == (3 if name in SLIDES else 2)
    assert max(excess(one, other) for one in found for other in found) <= 1
    monkeypatch.setattr(motion, "friction", scaled(1.0, 1.01))
    wrong = ways(scene, TIMES)
    assert excess(wrong[0], wrong[-1]) > 1
