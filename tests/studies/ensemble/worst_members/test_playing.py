"""Animations of the worst members, which are run again with the methods that are compared."""

from pathlib import Path

import numpy as np

from bodycheck.adapters import registry
from bodycheck.running import campaign, engines
from bodycheck.studies.ensemble.findings.aggregates import aggregate
from bodycheck.studies.ensemble.findings.stored import EngineMethod
from bodycheck.studies.ensemble.worst_members import playing
from tests.support.cases import a_case
from tests.support.ensembles import made

BRICK = {"shape": "brick", "semi_axes": [0.1, 0.2, 0.3], "mass": 1.0}


def text_of(member: int) -> str:
    initial = {"angular_velocity": [0.1, 5.0 + member, 0.0]}
    return a_case(f"spin-{member}", body=BRICK, initial=initial, run={"duration": 0.5, "samples": 51})


def test_the_worst_member_of_each_method_is_shown_with_the_best_others(tmp_path: Path) -> None:
    version = str(registry.installed("mujoco"))
    methods = [EngineMethod("mujoco", version, name, 0.01) for name in ("Euler", "RK4")]
    errors = [np.array([1e-2, 5e-2, 2e-2]), np.array([1e-7, 2e-7, 3e-7])]
    runs = {flown: {"attitude_error": own} for flown, own in zip(methods, errors, strict=True)}
    ensemble = aggregate(made(tmp_path / "ensemble", {"initial.angular_velocity.1": np.arange(3.0)}, runs))
    assert playing.chosen(ensemble) == {1: [0, 1], 2: [1, 0]}  # the member of the worst method comes first
    records, _ = engines.describe(["mujoco"])
    header = campaign.header(["bodycheck"], records, {})
    shown = playing.animations(ensemble, text_of, tmp_path / "runs", header)
    titles = [
        f"Member {member}, with the largest attitude error of mujoco {name}" for member, name in ((1, "Euler"), (2, "RK4"))
    ]
    assert [one.title for one in shown] == titles
    for one in shown:
        assert one.data is not None
        assert {run["label"] for run in one.data["runs"]} == {"mujoco Euler", "mujoco RK4"}
