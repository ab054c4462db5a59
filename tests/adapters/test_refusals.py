"""An integrator can say why scenes of a kind are unsupported."""

from bodycheck.adapters import offers
from bodycheck.adapters.contract import Engine, Integrator, Method
from bodycheck.reference.scene import Plane, Scene
from tests.support.touching import OF_BALL, on

TOY = Engine(
    name="toy",
    distribution="toy",
    version="1",
    integrators=(Integrator("euler"), Integrator("old", refuses={"contact": "is no longer developed"})),
    models=frozenset({"gravity", "translation"}),
)


def test_a_refused_kind_of_scene_is_run_and_unsupported_with_the_reason() -> None:
    bouncing = on(Plane(0.5), OF_BALL)
    assert offers.offered(TOY, bouncing) == ("euler", "old")
    assert offers.not_offered(TOY, bouncing, Method.parse("euler", 1e-3)) is None
    reason = offers.not_offered(TOY, bouncing, Method.parse("old", 1e-3))
    assert reason == "does not model this scene: old is no longer developed"


def test_other_kinds_of_scene_are_not_refused() -> None:
    falling = Scene(OF_BALL, on(Plane(0.5), OF_BALL).initial, 9.81)
    assert offers.not_offered(TOY, falling, Method.parse("old", 1e-3)) is None
