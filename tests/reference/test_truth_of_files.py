"""Files whose bounds were broken once: the truth of what the file says, with its witnesses, against multiprecision."""

import math

import pytest

from bodycheck.casefile.case import parse
from bodycheck.reference import witnesses
from bodycheck.reference.truth import truth
from bodycheck.reference.truths import Truth
from tests.support.bound_checks import Figure, figures

CASE = """\
format = 1
name = "example"
title = "An example"
{body}
[initial]
{initial}
[run]
duration = {duration}
samples = 6
"""

#: The brick of Example 2.1, given in a frame in which it is turned.
TURNED = """\
[[body.parts]]
shape = "brick"
semi_axes = [0.1, 0.3, 0.2]
mass = 1.0
euler_zxz = [0.3, 0.8, -0.4]
"""

#: Two heavy particles, and two that are a millionth of a metre from the line through these.
NEARLY_IN_LINE = "".join(
    f"[[body.particles]]\nmass = {mass}\nposition = [{sign * x}, 0.0, {sign * z}]\n"
    for mass, x, z in ((5.0, 0.6, 0.8), (0.5, 0.8e-6, -0.6e-6))
    for sign in (1.0, -1.0)
)

PRINCIPAL = 'body = {{ shape = "none", mass = 1.0, inertia = [{}, {}, {}] }}\n'.format


def example(body: str, initial: str, duration: float) -> tuple[Truth, dict[str, Figure]]:
    """The truth of a case and its figures against multiprecision."""
    text = CASE.format(body=body, initial=initial, duration=duration)
    case = parse(text, "f")
    found = truth(case.scene, case.instants)
    return found, figures(text, found)


def holds(found: dict[str, Figure]) -> bool:
    """Whether no bound is broken."""
    return not any(figure.broken.size for figure in found.values())


def test_the_brick_of_example_2_1_given_turned() -> None:
    """It was 1.3 rad off and certified to 3.7e-15 rad, since the motion amplifies the rounding of its principal axes."""
    rates = "angular_velocity = [2.1199322023239766, -6.853164493328192, 6.967067093471654]"
    found, seen = example(TURNED, rates, 20.0)
    assert holds(seen)
    assert found.bounds.error.max() < 1e-14
    assert len(found.witnesses) == 2


def test_particles_that_are_nearly_in_line() -> None:
    """It was 1.45e-7 rad off with a printed bound of 4.3e-15 rad, from the sums over the particles in double precision."""
    found, seen = example(NEARLY_IN_LINE, "angular_velocity = [3.0, 2.0, 8.0]", 10.0)
    assert holds(seen)
    assert found.bounds.error.max() < 1e-14


@pytest.mark.parametrize("wobble", [1e-6, 1e-10, 1e-14])
def test_the_errors_of_witnesses_near_the_separatrix_are_not_those_of_the_truth(wobble: float) -> None:
    found, seen = example(PRINCIPAL(1.0, 2.0, 2.25), f"angular_velocity = [{wobble}, 3.0, 0.0]", 100.0)
    assert holds(seen)
    assert found.bounds.error.max() < 1e-14
    assert found.witnesses


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_spin_about_a_principal_axis_with_a_rate_that_is_pi(axis: int) -> None:
    rates = [0.0, 0.0, 0.0]
    rates[axis] = math.pi
    found, seen = example(PRINCIPAL(1.0, 2.0, 2.5), f"angular_velocity = {rates}", 1000.0)
    assert holds(seen)
    assert found.bounds.error.max() < 1e-14


@pytest.mark.parametrize("turning", [1e4, 1e5, 1e6])
@pytest.mark.parametrize(
    ("moments", "integrated"),
    [((1.0, 1.5, 1.7), True), ((1.0, 1.0 + 1e-9, 1.0 + 2e-9), False)],
    ids=["tumble", "nearly a sphere"],
)
def test_no_integration_turns_farther_than_the_limit(
    turning: float, moments: tuple[float, float, float], integrated: bool
) -> None:
    """The cost of a witness is known before it is paid: one period is followed, or the second closed form stands in."""
    initial = "angular_velocity = [1.0, 2.0, 3.0]"
    found, seen = example(PRINCIPAL(*moments), initial, turning / math.sqrt(14))
    assert holds(seen)
    # The phases are reduced in the widest type, whose rounding is 1e-19 a radian.
    assert found.bounds.error.max() < 1e-14 + 1e-18 * turning
    known = witnesses.course(witnesses.start(found.scene), found.trajectory.t)
    assert (known.turning < witnesses.FARTHEST_RAD) is integrated
    assert all(("heyoka" in name or "scipy" in name) is integrated for name in found.witnesses if "parabola" not in name)
    assert found.witnesses
