import sys
import tomllib
from collections.abc import Iterator, Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from bodycheck.adapters.method import Method
from bodycheck.casefile.case import Case, load, parse, parse_stored
from bodycheck.casefile.toml_text import short
from bodycheck.studies.ensemble.findings import stored
from bodycheck.studies.ensemble.worst_members import worst
from bodycheck.studies.ensemble.worst_members.trials import Tried
from bodycheck.studies.ensemble.worst_members.worst import MOST_LINES, Worst
from tests.support.cases import a_case
from tests.support.commands import bodycheck
from tests.support.narrow_engines import NARROW
from tests.support.planted_engines import plant
from tests.support.processes import calls_here
from tests.support.wording import facts

#: Members of the ensemble: their velocities and spins.
DRAWN = np.random.default_rng(1).uniform(-0.9, 0.9, (200, 6)) * [1, 1, 1, 9, 9, 9]

#: The members in which the engine is wrong, gives up, raises an error, and ends its process.
WRONG, GIVEN_UP, RAISED, ENDED = 61, 17, 133, 90
DRAWN[np.abs(DRAWN[:, 4] - 2) < 0.02, 4] = 3.0
DRAWN[WRONG, 4] = 2.00317
DRAWN[GIVEN_UP, 1] = 0.99241
DRAWN[RAISED, 0] = 0.99117
DRAWN[ENDED, 2] = 0.99117

#: Its errors of position in other members, and in that one, after 2 s, by the formulas of the engine.
USUAL, LARGE = 2e-7, 0.6

LIMIT = {"engine": "narrow", "integrator": "step", "timestep": 0.01, "position_error": 0.1}


def document(member: int) -> dict[str, Any]:
    velocity, spin = DRAWN[member, :3].tolist(), DRAWN[member, 3:].tolist()
    text = a_case(
        f"ball-{member}",
        body={"shape": "sphere", "radius": 0.1037, "mass": 1.0731},
        initial={"position": [0.31, -0.7, 1.234], "velocity": velocity, "angular_velocity": spin},
        scene={"gravity": 9.81},
        run={"duration": 2.0, "samples": 101},
    )
    return tomllib.loads(text)


def ensemble(folder: Path, case: Case, crashed: int) -> stored.Ensemble:
    """The runs of the ensemble, as the engine would leave them. crashed: the member that has crashed."""
    statuses = np.array(["ok"] * len(DRAWN), dtype=object)
    statuses[GIVEN_UP], statuses[crashed] = "diverged", "crashed"
    errors = np.where(np.arange(len(DRAWN)) == WRONG, LARGE, USUAL)
    columns = {
        "engine": ["narrow"] * len(DRAWN),
        "version": ["1.0"] * len(DRAWN),
        "integrator": ["step"] * len(DRAWN),
        "timestep": [0.01] * len(DRAWN),
        "member": list(range(len(DRAWN))),
        "status": statuses.tolist(),
        "passed": [bool(limit.holds(error)) for error in errors for e in case.expectations for limit in e.limits] or None,
        "position_error": np.where(statuses == "ok", errors, np.nan),
        "energy_drift": np.where(statuses == "ok", np.arange(len(DRAWN)) * 1e-16, np.nan),
    }
    columns["passed"] = columns["passed"] or pa.nulls(len(DRAWN), pa.bool_())
    for path, table in (("runs/narrow/ball", columns), ("members/ball", {"member": columns["member"]})):
        (folder / path).mkdir(parents=True)
        pq.write_table(pa.table(table), folder / path / "part-00000.parquet")
    return stored.read(folder, "ball")


@pytest.fixture
def planted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    plant(tmp_path / "engines", {"narrow": NARROW})
    monkeypatch.setenv("BODYCHECK_CACHE", str(tmp_path / "cache"))
    monkeypatch.syspath_prepend(tmp_path / "engines")


@pytest.fixture
def here() -> Iterator[None]:
    with calls_here():
        yield


def written(folder: Path, crashed: int = RAISED, **more: Any) -> dict[int, Worst]:
    """The worst members of the ensemble, which are written into a folder."""
    case = parse(a_case("ball", body={"shape": "sphere", "radius": 0.1, "mass": 1.0}, **more), "ball")
    known = ensemble(folder, case, crashed)
    made = worst.write(folder, case, known, lambda member: short(document(member)), "seed 1", lambda *done: None)
    return {one.way.member: one for one in made}


def check_failing(one: Worst) -> dict[str, Any]:
    """Check that the file of a worst member is short and fails as it is, and return its document."""
    assert one.path is not None
    text = one.path.read_text("utf-8")
    assert len(text.splitlines()) <= MOST_LINES
    assert load(one.path).title == one.title
    done = bodycheck("run", one.path, "--engine", "narrow", "--jobs", 1, "--quiet")
    assert done.returncode == 1, done.stderr
    return tomllib.loads(text)


def test_each_way_of_failing_becomes_a_simple_case_that_fails(planted: None, here: None, tmp_path: Path) -> None:
    found = written(tmp_path / "out")
    assert found.keys() == {WRONG, GIVEN_UP, RAISED}  # and none for the drift, which is nothing but rounding
    made = {member: check_failing(one) for member, one in found.items()}
    assert made[WRONG]["initial"] == {"angular_velocity": [0.0, 2.0, 0.0]}
    assert made[RAISED]["initial"] == {"velocity": [1.0, 0.0, 0.0]}
    assert made[GIVEN_UP]["initial"] == {"velocity": [0.0, 1.0, 0.0]}
    for member, one in made.items():
        assert found[member].path == tmp_path / "out" / "worst" / f"ball-{member}.case.toml"
        assert "scene" not in one
        assert one["body"] == {"shape": "sphere", "radius": 0.1, "mass": 1.0}
        # The error grows with the time and must stay above half of what it was; the others fail in the first step.
        assert one["run"] == {"duration": 2.0 if member == WRONG else 0.01, "samples": 2}


@pytest.mark.slow
def test_an_engine_that_ends_its_process_is_told_by_a_case_as_well(planted: None, tmp_path: Path) -> None:
    made = check_failing(written(tmp_path / "out", crashed=ENDED)[ENDED])
    assert made["initial"] == {"velocity": [0.0, 0.0, 1.0]}
    names = ("narrow", "step", "crashed", "its process exited with code 7", "expected", "ok")
    assert facts(made["title"], *names) == ["narrow", "1.0", "step", "0.01", *names[2:]]


def test_a_file_says_what_fails_by_how_much_and_where_it_is_from(planted: None, here: None, tmp_path: Path) -> None:
    text = (written(tmp_path / "out")[WRONG].path or Path()).read_text("utf-8")
    first, second, *_ = text.splitlines()
    assert (first[:2], second[:2]) == ("# ", "# ")
    assert facts(first, "ball") == ["61", "ball", "1"]
    assert facts(second, "position_error") == ["position_error", "0.6", "99", "198", "2e-07"]
    names = ("narrow", "step", "position error")
    assert facts(tomllib.loads(text)["title"], *names) == [*("narrow", "1.0", "step", "0.01"), "position error", "0.6", "0.3"]
    assert "position_error = 0.3\n" in text


def test_a_broken_expectation_of_the_case_keeps_its_limit(planted: None, here: None, tmp_path: Path) -> None:
    found = written(tmp_path / "out", expect=[LIMIT])
    made = tomllib.loads((found[WRONG].path or Path()).read_text("utf-8"))
    assert made["expect"] == [LIMIT | {"version": "1.0"}]
    assert "also" not in (found[WRONG].path or Path()).read_text(
        "utf-8"
    )  # that it has the largest value too goes without saying
    assert made["run"]["duration"] == 0.5  # the first round one after which the error, 0.3 m in a second, breaks the limit


def test_the_same_ensemble_gives_the_same_files(planted: None, here: None, tmp_path: Path) -> None:
    one, other = (written(tmp_path / name) for name in ("one", "other"))
    for member, made in one.items():
        assert (made.path or Path()).read_bytes() == (other[member].path or Path()).read_bytes()


def test_a_member_that_does_not_fail_alone_is_told_and_not_written(
    planted: None, here: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn = DRAWN.copy()
    drawn[WRONG, 4] = 3.0
    monkeypatch.setattr(sys.modules[__name__], "DRAWN", drawn)
    made = written(tmp_path / "out")[WRONG]
    assert made.path is None
    names = ("position_error", "narrow step", "not when it is run alone")
    assert facts(made.title, *names) == ["61", *names]


def test_the_first_trial_that_takes_too_long_ends_the_search(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    calls: list[int] = []

    def slow(engine: str, method: Method, cases: Sequence[Case]) -> list[Tried]:
        """Cases that differ from those that were drawn take too long."""
        calls.append(len(cases))
        drawn = [case.duration == 2.0 and case.scene.gravity > 0 for case in cases]
        ok = Tried("ok", "", {"position_error": LARGE}, {"position_error": 1e-12}, "1.0")
        return [ok if one else Tried("timeout", "stopped after 300 s") for one in drawn]

    monkeypatch.setattr(worst, "trials", lambda: nullcontext(slow))
    monkeypatch.setattr(worst, "parse", lambda text, file: parse_stored(text, file))  # the engine is not there
    made = written(tmp_path / "out")[WRONG]
    assert made.path is not None
    text = made.path.read_text("utf-8")
    assert "as it was drawn" in text
    assert tomllib.loads(text)["initial"] == document(WRONG)["initial"]
    assert len(calls) == 4 + 2  # each alone, the first candidates of this one, and this one as it is written
