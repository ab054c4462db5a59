"""The probe of representations finds what is wrong with welds, products of inertia and centres of mass, and nothing else."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import pytest

from bodycheck.adapters.contract import Adapter, Engine, Method, SceneUnsupported, Simulation, Strides
from bodycheck.adapters.links import Link
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array
from bodycheck.studies.audit.flights import Pilot
from bodycheck.studies.audit.probe import Finding
from bodycheck.studies.audit.probes.representation import LONGEST_STEPS, MULTIPLES, SCENE, representation
from tests.support.welded import (
    SCHEMES,
    Spoil,
    Welder,
    rotation,
    settling,
    stiffer,
    unturned,
    without_centres,
    without_products,
)

HEAVY, TURNED = "mass and moments of inertia times 2", "body frame turned against the principal axes"
TENSOR, ASIDE, WELDED = "full inertia tensor", "centre of mass off the origin", "two welded links"


def flown(adapter: Adapter, integrator: str = "semi-implicit-Euler") -> dict[str, Finding]:
    """The findings with steps of 2 ms by the names of the representations."""
    return {finding.probe.split(": ")[1]: finding for finding in representation(Pilot(adapter, integrator, 0.002))}


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("precision", ["float64", "float32"])
def test_a_clean_engine_has_no_finding(scheme: str, precision: Literal["float64", "float32"]) -> None:
    found = flown(Welder(precision=precision), scheme.replace(" ", "-"))
    assert set(found) == {HEAVY, TURNED, TENSOR, ASIDE, WELDED}
    assert {finding.verdict for finding in found.values()} == {"none"}, found


@pytest.mark.parametrize("precision", ["float64", "float32"])
@pytest.mark.parametrize(
    ("spoil", "spoiled"),
    [
        (unturned, {WELDED}),
        (without_products, {TENSOR, WELDED}),
        (without_centres, {ASIDE, WELDED}),
        (stiffer(0.0, 0.0, always=0.01), {TENSOR, ASIDE, WELDED}),
        (stiffer(2.0, 0.0, always=0.01), {TENSOR, ASIDE, WELDED}),
    ],
)
def test_a_fault_is_a_difference_that_does_not_vanish(
    spoil: Spoil, spoiled: set[str], precision: Literal["float64", "float32"]
) -> None:
    found = flown(Welder(spoil, precision))
    assert {name for name, finding in found.items() if finding.verdict == "found"} == spoiled
    assert {name for name, finding in found.items() if finding.probe.endswith("does not vanish with the time step")} == spoiled


@pytest.mark.parametrize(("first", "second", "order"), [(2.0, 0.0, 1), (0.0, 200.0, 2)])
@pytest.mark.parametrize("precision", ["float64", "float32"])
def test_a_difference_that_vanishes_is_found_with_its_order(
    first: float, second: float, order: int, precision: Literal["float64", "float32"]
) -> None:
    found = flown(Welder(stiffer(first, second), precision))
    for name in (TENSOR, ASIDE, WELDED):
        assert found[name].verdict == "found"
        said = re.search(r"vanishes with the time step with order (.*)$", found[name].probe)
        assert said is not None
        # At finite steps and beside rounding an order is observed to within its first decimal.
        assert float(said[1]) == pytest.approx(order, abs=0.15)
    assert {found[name].verdict for name in (HEAVY, TURNED)} == {"none"}


def test_a_difference_whose_order_grows_from_first_to_second_vanishes() -> None:
    found = flown(Welder(settling))
    assert {re.sub(r" [\d.]+$", "", found[name].probe.split(": ")[2]) for name in (TENSOR, ASIDE, WELDED)} == {
        "differs, and vanishes with the time step with order"
    }


def test_the_value_is_the_largest_difference_at_the_audited_step() -> None:
    """Of a tensor that is one per cent too large in xx, seen in the attitude."""
    spoil = stiffer(0.0, 0.0, always=0.01)
    value = flown(Welder(spoil))[ASIDE].value
    links = [Link(SCENE.body.mass, (*SCENE.body.moments, 0.0, 0.0, 0.0))]  # the offset changes nothing in this engine
    method, strides = Method("semi-implicit-Euler", 0.002), np.array([LONGEST_STEPS * MULTIPLES[0]])
    spoiled, sound = (
        Welder(one).prepare_links(links, SCENE, method).advance(strides)[0, 0, 0] for one in (spoil, Welder().spoil)
    )
    assert flown(Welder(spoil))[ASIDE].unit == "rad"
    angle = (rotation(sound[3:7]).inv() * rotation(spoiled[3:7])).magnitude()
    # The difference grows, so that the last instant is the one with the largest.
    assert value == pytest.approx(angle, rel=1e-6)


@dataclass(frozen=True)
class Unlinked:
    """An adapter that does not take links."""

    precision: Literal["float64", "float32"] = "float64"

    @property
    def engine(self) -> Engine:
        return replace(Welder().engine, precision=self.precision)

    def prepare(self, scenes: Sequence[Scene], method: Method) -> Simulation:
        return Welder().prepare(scenes, method)


class Refusing(Unlinked):
    def prepare_links(self, links: Sequence[Link], scene: Scene, method: Method) -> Simulation:
        if len(links) > 1:
            raise SceneUnsupported("the engine cannot weld")
        return Welder().prepare_links(links, scene, method)


@pytest.mark.parametrize(
    ("adapter", "refused", "reason"),
    [(Unlinked(), {TENSOR, ASIDE, WELDED}, "cannot give the engine"), (Refusing(), {WELDED}, "the engine cannot weld")],
)
def test_what_cannot_be_flown_is_not_probed(adapter: Adapter, refused: set[str], reason: str) -> None:
    found = flown(adapter)
    assert {name for name, finding in found.items() if finding.verdict == "not-probed"} == refused
    assert all(reason in found[name].probe for name in refused)
    assert {finding.verdict for name, finding in found.items() if name not in refused} == {"none"}


class Lost:
    """A simulation whose states are not numbers."""

    def advance(self, strides: Strides) -> Array:
        return np.full((1, len(strides), 1, 13), np.nan)


class Exploding(Unlinked):
    def prepare_links(self, links: Sequence[Link], scene: Scene, method: Method) -> Simulation:
        return Lost()


def test_states_that_are_not_numbers_are_a_fault() -> None:
    found = flown(Exploding())
    assert {(found[name].verdict, found[name].value) for name in (TENSOR, ASIDE, WELDED)} == {("found", None)}
