"""Scenes as arrays are the scenes that the case file of each member gives."""

from dataclasses import replace

import numpy as np
import pytest

from bodycheck.reference.exact.numbers import MP
from bodycheck.reference.exact.start import defined_scene, start
from bodycheck.reference.scene import (
    Body,
    Brick,
    Cylinder,
    Definition,
    Ellipsoid,
    EulerRates,
    Particle,
    Plane,
    Scene,
    Shape,
    Solid,
    Sphere,
    State,
    Tensor,
)
from bodycheck.reference.scenes import Scenes, obstacle, sizes_of, variable, vary
from bodycheck.reference.trajectory import Array

COUNT = 60
SHAPES: dict[str, Shape] = {
    "brick": Brick((0.1, 0.2, 0.3)),
    "ellipsoid": Ellipsoid((0.3, 0.1, 0.1)),
    "cylinder": Cylinder(0.2, 0.35),
    "sphere": Sphere(0.7),
}


def base_of(shape: Shape, mass: float = 1.3) -> Scene:
    made = defined_scene(Definition(Solid(shape, mass), rotation=(1.0, 2.0, 3.0)), shape)
    return replace(made, initial=replace(made.initial, position=(1.0, -2.0, 3.0), velocity=(0.1, 0.2, 0.3)), gravity=9.81)


def drawn(shape: Shape, seed: int) -> dict[str, Array]:
    """Values of all that can vary in a scene of a homogeneous solid."""
    rng = np.random.default_rng(seed)
    sizes = rng.uniform(0.05, 1.0, (COUNT, len(sizes_of(shape))))
    named = {"semi_axes": sizes} if isinstance(shape, Brick | Ellipsoid) else {"radius": sizes[:, 0]}
    if isinstance(shape, Cylinder):
        named["half_length"] = sizes[:, 1]
    return named | {
        "mass": rng.uniform(0.1, 5.0, COUNT),
        "position": rng.normal(size=(COUNT, 3)),
        "quaternion": rng.normal(size=(COUNT, 4)) * 10 ** rng.uniform(-200, 200, (COUNT, 1)),
        "velocity": rng.normal(size=(COUNT, 3)),
        "angular_velocity": rng.normal(size=(COUNT, 3)),
        "gravity": rng.uniform(0, 10, COUNT),
    }


def defined(base: Scene, values: dict[str, Array], k: int) -> Scene:
    """A member as its case file gives it."""
    given = {name: tuple(array[k].tolist()) if array.ndim == 2 else float(array[k]) for name, array in values.items()}
    shape = base.body.shape
    assert shape is not None
    own = replace(shape, **{name: given[name] for name in ("semi_axes", "radius", "half_length") if name in given})
    made = defined_scene(Definition(Solid(own, given["mass"]), given["quaternion"], given["angular_velocity"]), own)
    moved = replace(made.initial, position=given["position"], velocity=given["velocity"])
    return replace(made, initial=moved, gravity=given["gravity"])


@pytest.mark.parametrize("name", SHAPES)
def test_each_member_is_the_scene_of_its_case_file(name: str) -> None:
    base, values = base_of(SHAPES[name]), drawn(SHAPES[name], 1)
    scenes = vary(base, values)
    assert len(scenes) == COUNT
    for k in range(COUNT):
        expected = defined(base, values, k)
        assert scenes.scene(k) == replace(expected, definition=None)
        exact = start(expected).moments
        for axis, moment in enumerate(exact):
            found = MP.convert(scenes.exact_moments.high[k, axis]) + MP.convert(scenes.exact_moments.low[k, axis])
            # Two digits less than a pair of 80-bit numbers has; pairs of doubles have 106 bits.
            bits = 120 if np.finfo(np.longdouble).nmant > 52 else 98
            assert abs(found - moment) <= MP.mpf(2) ** -bits * moment


def test_what_does_not_vary_is_that_of_the_base() -> None:
    base = base_of(SHAPES["brick"])
    scenes = vary(base, {"gravity": np.array([1.0, 2.0])})
    assert scenes.sizes is None
    assert [scenes.scene(k) for k in range(2)] == [replace(base, gravity=gravity, definition=None) for gravity in (1.0, 2.0)]
    mass = vary(base, {"mass": np.array([2.6])})
    assert mass.scene(0) == replace(base_of(SHAPES["brick"], 2.6), definition=None)


def test_moments_that_are_given_do_not_follow_from_mass_and_sizes() -> None:
    moments = np.array([[1.0, 1.5, 2.0]])
    varied = vary(
        base_of(SHAPES["brick"]), {"moments": moments, "mass": np.array([7.0]), "semi_axes": np.array([[1.0, 2.0, 3.0]])}
    )
    assert varied.scene(0).body == Body(7.0, (1.0, 1.5, 2.0), Brick((1.0, 2.0, 3.0)))
    tensor = Tensor(1.0, ((0.1, 0.0, 0.0), (0.0, 0.2, 0.0), (0.0, 0.0, 0.25)))
    for base in (defined_scene(Definition(tensor), None), Scene(Body(1.0, (0.1, 0.2, 0.25)), State())):
        assert vary(base, {"mass": np.array([7.0])}).scene(0).body == Body(7.0, (0.1, 0.2, 0.25))


def test_a_part_has_the_same_members() -> None:
    scenes = vary(base_of(SHAPES["cylinder"]), drawn(SHAPES["cylinder"], 2))
    chosen: list[tuple[Scenes, list[int]]] = [
        (scenes.part(slice(3, 9, 2)), [3, 5, 7]),
        (scenes.part(np.array([8, 0])), [8, 0]),
        (scenes.part(np.arange(COUNT) % 20 == 0), [0, 20, 40]),
    ]
    for part, places in chosen:
        assert [part.scene(k) for k in range(len(part))] == [scenes.scene(place) for place in places]


def test_what_keeps_a_scene_from_varying_is_said() -> None:
    base = base_of(SHAPES["brick"])
    assert variable(base)
    particles = Definition((Particle(1.0, (1.0, 0.0, 0.0)), Particle(2.0, (0.0, 1.0, 0.0)), Particle(3.0, (0.0, 0.0, 1.0))))
    tensor = Tensor(1.0, ((1.0, 0.1, 0.0), (0.1, 2.0, 0.0), (0.0, 0.0, 2.5)))
    rates = Definition(Solid(SHAPES["brick"], 1.0), rotation=EulerRates(1.0, 2.0, 3.0))
    cube = tuple(Solid(Sphere(0.1), 1.0, (x, y, z)) for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0))
    obstacles = {
        "plane": replace(base, plane=Plane()),
        "drag": replace(base, drag=0.1),
        "principal axes": defined_scene(Definition(tensor), None),
        "parts": defined_scene(Definition(cube), None),
        "Euler": defined_scene(rates, SHAPES["brick"]),
    }
    for word, scene in obstacles.items():
        assert word in (obstacle(scene) or "")
        with pytest.raises(ValueError, match=word):
            vary(scene, {"gravity": np.ones(2)})
    assert not variable(defined_scene(particles, None))


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({}, "nothing varies"),
        ({"colour": np.ones(2)}, "'colour' cannot vary"),
        ({"radius": np.ones(2)}, "'radius' cannot vary"),
        ({"mass": np.ones((2, 1))}, "mass has the shape"),
        ({"mass": np.ones(2), "velocity": np.ones((3, 3))}, "velocity has the shape"),
    ],
)
def test_values_of_another_kind_are_refused(values: dict[str, Array], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        vary(base_of(SHAPES["brick"]), values)
