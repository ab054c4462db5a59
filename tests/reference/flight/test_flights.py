"""Motions of many bodies at once are those of the bodies one by one, and within their bounds of Taylor series in integers."""

import json
import subprocess
import sys
from collections import Counter
from dataclasses import fields, replace

import numpy as np
import pytest

from bodycheck.reference.exact.numbers import Wide
from bodycheck.reference.exact.start import defined_scene
from bodycheck.reference.flight import closed_form
from bodycheck.reference.flight import flights as module
from bodycheck.reference.flight.flights import Flights, flights
from bodycheck.reference.kinematics import geodesic_angle
from bodycheck.reference.scene import Brick, Cylinder, Definition, Ellipsoid, Shape, Solid, Sphere
from bodycheck.reference.scenes import vary
from tests.reference.flight.integer_series import angle_between, witness
from tests.support.free_flights import KINDS, of_kinds, random_bricks

EPS = float(np.finfo(float).eps)
TIMES = np.array([0.0, 0.3, 2.0, 40.0])


def same_bits(one: Flights, places: object, other: Flights) -> None:
    """The motions of some members are those of other flights, and so are their bounds, bit for bit."""
    for part in ("trajectory", "bounds"):
        for field in fields(getattr(one, part)):
            if field.name != "t":
                found, expected = getattr(getattr(one, part), field.name)[places], getattr(getattr(other, part), field.name)
                np.testing.assert_array_equal(found, expected, err_msg=field.name)
    np.testing.assert_array_equal(one.forms[places], other.forms)


def agree(found: Flights, k: int, single: closed_form.Flight) -> None:
    """A member has the form and the bounds of the single scene, and lies as close to it as these allow."""
    motion, bounds = found.trajectory, found.bounds
    assert found.forms[k] == single.form.name
    angle = geodesic_angle(motion.quaternion[k], single.motion.quaternion)
    # Each angle is computed from rounded quaternions.
    assert (angle <= bounds.error[k] + single.bounds.error + 4 * EPS).all()
    for name in ("position", "velocity", "angular_velocity"):
        apart = np.linalg.norm(getattr(motion, name)[k] - getattr(single.motion, name), axis=1)
        assert (apart <= getattr(bounds, f"{name}_error")[k] + getattr(single.bounds, f"{name}_error")).all(), name
    for field in fields(bounds):
        # The same formula of numbers that differ by roundings.
        np.testing.assert_allclose(getattr(bounds, field.name)[k], getattr(single.bounds, field.name), rtol=1e-12, atol=1e-300)


def test_every_kind_of_motion_is_that_of_a_single_scene() -> None:
    scenes = of_kinds()
    found = flights(scenes, TIMES)
    for k in range(len(scenes)):
        agree(found, k, closed_form.flight(scenes.scene(k), TIMES))


def test_every_kind_of_motion_is_within_its_bounds_of_exact_series() -> None:
    scenes, times = of_kinds(), np.array([0.0, 0.3, 2.0])
    found = flights(scenes, times)
    kinds = list(KINDS)
    for k in range(len(scenes)):
        # The rates are below the last digit of the series, or each of its steps is as short as the needle is thin.
        if kinds[k] in ("tiny", "needle"):
            continue
        series = witness(scenes.scene(k), times)
        angles = [angle_between(exact, got) for (exact, _), got in zip(series, found.trajectory.quaternion[k], strict=True)]
        assert (np.array(angles) <= found.bounds.error[k]).all(), kinds[k]
        apart = [
            np.linalg.norm(exact - got) for (_, exact), got in zip(series, found.trajectory.angular_velocity[k], strict=True)
        ]
        assert (np.array(apart) <= found.bounds.angular_velocity_error[k]).all(), kinds[k]


def test_random_bricks_move_as_their_case_files_say() -> None:
    base, values = random_bricks(60)
    found = flights(vary(base, values), TIMES)
    for k in range(60):
        shape = Brick(tuple(values["semi_axes"][k].tolist()))
        rows = {name: tuple(value[k].tolist()) for name, value in values.items() if value.ndim == 2}
        made = defined_scene(
            Definition(Solid(shape, values["mass"].item(k)), rows["quaternion"], rows["angular_velocity"]), shape
        )
        moved = replace(made.initial, position=rows["position"], velocity=rows["velocity"])
        agree(found, k, closed_form.flight(replace(made, initial=moved, gravity=9.81), TIMES))


@pytest.mark.parametrize(
    ("shape", "sizes", "form"),
    [
        (Brick((1.0, 1.0, 2.0)), {"semi_axes": [[1.0, 1.0, 2.0], [2.0, 1.0, 2.0], [1.0, 3.0, 3.0]]}, "symmetric top"),
        (Ellipsoid((1.0, 1.0, 2.0)), {"semi_axes": [[0.1, 0.1, 0.1]]}, "steady turn"),
        (Cylinder(0.3, 0.5), {"radius": [0.3, 0.7], "half_length": [0.2, 0.8]}, "symmetric top"),
        (Sphere(0.3), {"radius": [0.3, 0.7]}, "steady turn"),
        # Squares that differ by less than a pair of numbers can tell beside the third.
        (Brick((1.0, 1.0, 2.0)), {"semi_axes": [[1e-30, 2e-30, 1.0]]}, "elliptic functions"),
    ],
)
def test_equal_moments_of_shapes_are_known_to_be_equal(shape: Shape, sizes: dict[str, list[float]], form: str) -> None:
    base = defined_scene(Definition(Solid(shape, 1.0), rotation=(1.0, 2.0, 3.0)), shape)
    scenes = vary(base, {name: np.array(values) for name, values in sizes.items()})
    found = flights(scenes, TIMES)
    assert set(found.forms) == {form}
    for k in range(len(scenes)):
        shape = scenes.shape(k) or shape
        single = defined_scene(Definition(Solid(shape, 1.0), rotation=(1.0, 2.0, 3.0)), shape)
        agree(found, k, closed_form.flight(single, TIMES))


def test_a_member_has_the_same_bits_alone_and_among_others() -> None:
    times = np.linspace(0.0, 2.0, 101)
    base, values = random_bricks(400)
    for scenes in (vary(base, values), of_kinds()):
        together = flights(scenes, times)
        for k in range(0, len(scenes), 7):
            same_bits(together, slice(k, k + 1), flights(scenes.part(slice(k, k + 1)), times))
        shuffled = np.random.default_rng(3).permutation(len(scenes))
        same_bits(together, shuffled, flights(scenes.part(shuffled), times))


def test_only_what_pairs_cannot_tell_is_left_to_the_way_of_single_scenes(monkeypatch: pytest.MonkeyPatch) -> None:
    left: list[int] = []
    right = module._start
    monkeypatch.setattr(module, "_start", lambda scenes, place: (left.append(place), right(scenes, place))[1])
    base, values = random_bricks(1000)
    flights(vary(base, values), np.array([0.0]))
    assert not left
    flights(of_kinds(), np.array([0.0]))
    if np.finfo(Wide).nmant > 52:
        assert Counter(list(KINDS)[place] for place in left) == Counter(
            ["separatrix", "just outside the separatrix", "just inside the separatrix", "a tiny rate"]
        )


def test_no_instants_and_no_order_of_instants() -> None:
    scenes = of_kinds()
    assert flights(scenes, np.array([])).trajectory.quaternion.shape == (len(scenes), 0, 4)
    forward, anyhow = flights(scenes, TIMES), flights(scenes, TIMES[::-1].copy())
    np.testing.assert_array_equal(forward.trajectory.quaternion[:, ::-1], anyhow.trajectory.quaternion)


def test_without_a_wider_type_the_bounds_grow_and_hold() -> None:
    """What a machine would do whose long double is a double: the same code with the wide type taken away."""
    program = f"""
import json
import numpy as np
np.longdouble = np.float64
from bodycheck.reference.flight.flights import flights
from bodycheck.reference.scenes import vary
from tests.support.free_flights import of_kinds, random_bricks
many = [of_kinds(), vary(*random_bricks(50))]
found = [flights(scenes, np.array({TIMES.tolist()})) for scenes in many]
print(json.dumps([[each.trajectory.quaternion.tolist(), each.bounds.error.tolist()] for each in found]))
"""
    output = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout
    for scenes, (quaternion, error) in zip((of_kinds(), vary(*random_bricks(50))), json.loads(output), strict=True):
        here = flights(scenes, TIMES)
        apart = geodesic_angle(here.trajectory.quaternion, np.array(quaternion))
        assert (apart <= here.bounds.error + np.array(error) + 4 * EPS).all()
