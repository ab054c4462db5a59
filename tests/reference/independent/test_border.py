"""The independent start of a motion: the same numbers as those of the exact one, by other formulas, and nothing in common."""

import ast
from dataclasses import replace

import numpy as np
import pytest

from bodycheck.reference.exact.inertia import mass_properties
from bodycheck.reference.exact.numbers import MP
from bodycheck.reference.exact.rotations import matrix
from bodycheck.reference.exact.start import defined_rotation, defined_scene
from bodycheck.reference.independent.border import Border, border, times
from bodycheck.reference.scene import (
    Attitude,
    Brick,
    Cylinder,
    Definition,
    Ellipsoid,
    EulerAngles,
    EulerRates,
    Particle,
    Shape,
    Solid,
    Sphere,
    Tensor,
    Vector,
    valid,
)
from tests.support import ROOT

#: Both compute with a hundred digits; sums over ten parts lose a few.
AGREEMENT = 1e-90

#: What the independent way may import of the reference: the description of scenes, numerical tools, and itself.
ALLOWED = ("definition", "scene", "trajectory", "witness", "independent", "integration.heyoka_solver", "integration.rotation")


def an_attitude(rng: np.random.Generator) -> Attitude:
    if rng.random() < 0.5:
        phi, theta, psi = rng.normal(size=3).tolist()
        return EulerAngles(phi, theta, psi)
    w, x, y, z = (rng.normal(size=4) * 10 ** rng.uniform(-2, 2)).tolist()
    return w, x, y, z


def a_vector(rng: np.random.Generator) -> Vector:
    x, y, z = rng.normal(size=3).tolist()
    return x, y, z


def a_solid(rng: np.random.Generator, attitude: Attitude) -> Solid:
    a, b, c = rng.uniform(0.01, 1, 3).tolist()
    shapes: tuple[Shape, ...] = (Brick((a, b, c)), Ellipsoid((a, b, c)), Cylinder(a, b), Sphere(a))
    return Solid(shapes[rng.integers(4)], float(rng.uniform(0.1, 5)), a_vector(rng), attitude)


def a_definition(rng: np.random.Generator, kind: str) -> Definition:
    inertia: Solid | Tensor | tuple[Particle, ...] | tuple[Solid, ...]
    match kind:
        case "solid":
            inertia = a_solid(rng, (1.0, 0.0, 0.0, 0.0))
        case "solids":
            inertia = tuple(a_solid(rng, an_attitude(rng)) for _ in range(rng.integers(2, 11)))
        case "particles":
            inertia = tuple(Particle(float(rng.uniform(0.1, 5)), a_vector(rng)) for _ in range(rng.integers(3, 11)))
        case _:
            root = rng.normal(size=(3, 3))
            rows = (root @ root.T).tolist()
            inertia = Tensor(1.0, (tuple(rows[0]), tuple(rows[1]), tuple(rows[2])))
    rotation = EulerRates(*rng.normal(size=3).tolist()) if rng.random() < 0.5 else a_vector(rng)
    return Definition(inertia, an_attitude(rng), rotation)


def largest_difference(one: object, other: object) -> float:
    return float(abs(np.array(one, dtype=object) - np.array(other, dtype=object)).max())


@pytest.mark.parametrize("kind", ["solid", "solids", "particles", "tensor"])
def test_tensor_attitude_and_rates_are_those_of_the_exact_start(kind: str) -> None:
    rng = np.random.default_rng(sum(map(ord, kind)))
    for _ in range(10):
        definition = a_definition(rng, kind)
        found, exact = border(defined_scene(definition, None)), mass_properties(definition.inertia)
        xx, yy, zz, xy, xz, yz = exact.tensor
        scale = max(xx, yy, zz)
        assert abs(found.mass - exact.mass) <= AGREEMENT * exact.mass
        assert largest_difference(found.tensor, [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) <= AGREEMENT * scale
        turn, rates = defined_rotation(definition.attitude, definition.rotation)
        assert largest_difference(found.cosines, matrix(turn)) <= AGREEMENT
        assert largest_difference(found.rates, rates) <= AGREEMENT
        assert largest_difference(found.momentum, times(found.tensor, found.rates)) == 0
        identity = [times(found.mobility, list(column)) for column in zip(*found.tensor, strict=True)]
        assert largest_difference(identity, MP.eye(3).tolist()) <= AGREEMENT


@pytest.mark.parametrize("theta", [0.0, 0.7])
def test_the_rates_of_euler_angles_of_a_quaternion(theta: float) -> None:
    """Where K is vertical, phi is 0; the rates are those of the angles that the quaternion has."""
    c, s = np.cos(theta / 2), np.sin(theta / 2)
    attitude = (0.8 * c, 0.8 * s, 0.6 * s, 0.6 * c)
    definition = Definition(Solid(Sphere(1.0), 1.0), attitude, EulerRates(0.3, -0.5, 0.7))
    found = border(defined_scene(definition, None))
    assert largest_difference(found.rates, defined_rotation(attitude, definition.rotation)[1]) <= AGREEMENT


def test_a_scene_with_other_numbers_is_the_scene_of_these() -> None:
    definition = Definition(Solid(Brick((0.1, 0.2, 0.3)), 2.0), EulerAngles(0.1, 0.2, 0.3), (1.0, 2.0, 3.0))
    scene = defined_scene(definition, None)
    assert all((valid(scene).inertia, valid(scene).attitude, valid(scene).rotation))
    faster = replace(scene, initial=replace(scene.initial, angular_velocity=(4.0, 0.0, 0.0)))
    assert border(faster).rates == [4, 0, 0]
    assert same_inertia(border(faster), border(scene))
    other = replace(scene, body=replace(scene.body, moments=(1.0, 2.0, 2.5)))
    assert [border(other).tensor[n][n] for n in range(3)] == [1, 2, 2.5]
    upright = replace(scene, initial=replace(scene.initial, quaternion=(1.0, 0.0, 0.0, 0.0)))
    assert border(upright).cosines == MP.eye(3).tolist()


def same_inertia(one: Border, other: Border) -> bool:
    return (one.mass, one.tensor, one.mobility) == (other.mass, other.tensor, other.mobility)


def test_it_imports_nothing_that_it_is_to_check() -> None:
    modules = sorted((ROOT / "reference" / "independent").glob("*.py"))
    assert len(modules) > 2
    for path in modules:
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.module is not None and node.module.startswith("bodycheck"):
                assert node.module.removeprefix("bodycheck.reference.").startswith(ALLOWED), f"{path.name}: {node.module}"
