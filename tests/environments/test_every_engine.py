"""Every engine that has an adapter, in an environment of its own: `make engines`, which needs package sources and minutes."""

import json
import re
from math import log2
from pathlib import Path
from typing import Any

import pytest

from bodycheck.adapters import registry
from bodycheck.environments import environments
from bodycheck.running import engines
from tests.support import ROOT
from tests.support.commands import bodycheck

#: Most time in s for the tests of one engine. Some engines compile for seconds a model.
LIMIT_S = 3000.0

#: The engines that bodycheck does not install itself.
APART = [name for name in registry.names() if registry.installed(name) is None]


#: Columns that measure time.
MEASURED = {"wall_time", "time_per_step", "realtime_factor"}

Row = dict[str, Any]


def short(name: str, folder: Path) -> Path:
    """A copy of a shipped case of 2 s, which takes seconds in any engine, without what is expected of the whole."""
    text = (ROOT / "cases" / f"{name}.case.toml").read_text("utf-8").partition("[[expect]]")[0]
    file = folder / f"{name}.case.toml"
    file.write_text(re.sub(r"^duration = .*$", "duration = 2.0", text, flags=re.MULTILINE), "utf-8")
    return file


def rows(*arguments: object) -> list[Row]:
    """The rows of `bodycheck run`, in which no adapter fails. A scheme may diverge at a time step that is too large."""
    done = bodycheck("run", *arguments, "--json")
    assert done.returncode in (0, 1), done.stderr
    found: list[Row] = json.loads(done.stdout)
    failed = [row for row in found if row["status"] not in ("ok", "unsupported", "diverged")]
    assert not failed
    return found


@pytest.mark.engines
@pytest.mark.parametrize("name", APART)
def test_an_engine_keeps_the_contract_in_its_own_environment(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    environment = environments.obtain(name, environments.newest(name))
    monkeypatch.chdir(ROOT)
    contracts = [f"tests/adapters/test_{kind}contract.py" for kind in ("", "mechanism_", "robot_", "file_")]
    tests = [*contracts, *(str(path) for path in sorted(ROOT.glob(f"tests/adapters/{name}")))]
    done = environments.run(environment, "pytest", ["-q", *tests, "--adapter", name], None, LIMIT_S)
    print(done.stdout[-20_000:], done.stderr[-20_000:])
    assert done.returncode == 0


@pytest.mark.engines
def test_all_engines_run_one_suite_and_leave_each_other_alone(tmp_path: Path) -> None:
    """Every engine completes every scene that it models, and MuJoCo's rows are the same to the last bit beside all others."""
    for name in APART:
        environments.obtain(name, environments.newest(name))
    scenes = {
        **dict.fromkeys(("free-brick", "intermediate-axis-flip", "osrf-boxes-complex"), frozenset({"rotation"})),
        "football-drag": frozenset({"drag"}),
        "sliding-brick": frozenset({"contact", "friction"}),
    }
    cases = [short(name, tmp_path) for name in scenes]
    found = rows(*cases)
    records, faults = engines.describe(registry.names())
    assert not faults
    completed = {(row["engine"], row["case"]) for row in found if row["status"] == "ok"}
    expected = {(name, case) for name, own in records.items() for case, needs in scenes.items() if needs <= own.models}
    assert completed >= expected, sorted(expected - completed)
    alone = rows(*cases, "--engine", "mujoco")
    beside = [row for row in found if row["engine"] == "mujoco"]
    assert [{k: v for k, v in row.items() if k not in MEASURED} for row in beside] == [
        {k: v for k, v in row.items() if k not in MEASURED} for row in alone
    ]


@pytest.mark.engines
def test_two_releases_of_mujoco_stand_side_by_side(tmp_path: Path) -> None:
    """RK4 was of second order in the attitude until 3.17, and is of fourth order in 4.0."""
    for version in ("3.17.0", "4.0.0"):
        environments.obtain("mujoco", version)
    steps = (0.004, 0.002)
    words = [word for version in ("3.17.0", "4.0.0") for word in ("--engine", f"mujoco@{version}")]
    words += [word for step in steps for word in ("--timestep", str(step))]
    found = rows(short("free-brick", tmp_path), "--integrator", "RK4", *words)
    error = {(row["version"], row["timestep"]): row["attitude_error"] for row in found}
    orders = [log2(error[version, steps[0]] / error[version, steps[1]]) for version in ("3.17.0", "4.0.0")]
    # At two finite steps an order is observed to within its second decimal.
    assert orders == [pytest.approx(2.0, abs=0.1), pytest.approx(4.0, abs=0.1)]
