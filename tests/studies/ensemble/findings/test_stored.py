"""Reading the files of an ensemble: every number comes to its method and member, however the rows are cut into files."""

from pathlib import Path

import numpy as np
import pytest

from bodycheck.errors import BadFolder
from bodycheck.studies.ensemble.findings.stored import EngineMethod, read
from tests.support.ensembles import CASE, EULER, RK4, write


@pytest.mark.parametrize("rows_of_file", [1 << 18, 7, 1])
def test_every_number_comes_to_its_place(tmp_path: Path, rows_of_file: int) -> None:
    members = np.arange(20)
    errors = {EULER: members * 1e-3, RK4: members * 1e-6, EngineMethod("drake", "1", "rk", 0.002): members * 1e-9}
    runs = {flown: {"attitude_error": values} for flown, values in errors.items()}
    write(tmp_path, {"initial.velocity.0": members * 2.0}, runs, rows_of_file)
    found = read(tmp_path, CASE, ["mujoco", "drake"])
    assert found.methods == tuple(errors)
    assert np.array_equal(found.column("attitude_error"), np.stack(list(errors.values())))
    assert np.array_equal(found.values("initial.velocity.0"), members * 2.0)
    assert found.drawn == ("initial.velocity.0",)
    assert found.figures == ("attitude_error",)
    assert found.supported.all()
    assert not found.failed.any()


def test_what_failed(tmp_path: Path) -> None:
    status = ["ok", "ok", "ok", "diverged", "unsupported"]
    columns = {
        "status": status,
        "passed": [None, True, False, False, None],
        "reason": ["", "", "too large", "not a number", "does not model drag"],
        "attitude_error": [1.0, 2.0, 3.0, None, None],
    }
    found = read(write(tmp_path, {"body.mass": np.arange(5.0)}, {EULER: columns}), CASE)
    assert found.supported[0].tolist() == [True] * 4 + [False]
    assert found.failed[0].tolist() == [False, False, True, True, False]
    assert np.array_equal(found.column("attitude_error")[0], [1, 2, 3, np.nan, np.nan], equal_nan=True)
    assert found.reasons(0, [3, 4]) == {3: "not a number", 4: "does not model drag"}


def test_engines_whose_runs_lack_a_figure(tmp_path: Path) -> None:
    runs = {EULER: {"attitude_error": [1.0, 2.0]}, EngineMethod("drake", "1", "rk", 0.002): {"penetration": [3.0, 4.0]}}
    found = read(write(tmp_path, {"body.mass": np.arange(2.0)}, runs), CASE, ["mujoco"])
    assert np.array_equal(found.column("attitude_error"), [[1, 2], [np.nan, np.nan]], equal_nan=True)
    assert np.array_equal(found.column("penetration"), [[np.nan, np.nan], [3, 4]], equal_nan=True)


def test_a_folder_without_runs_or_with_damaged_ones(tmp_path: Path) -> None:
    with pytest.raises(BadFolder, match="has no runs of an ensemble of spin"):
        read(tmp_path, CASE)
    write(tmp_path, {"body.mass": np.arange(2.0)}, {EULER: {"attitude_error": [1.0, 2.0]}})
    path = tmp_path / "runs" / "mujoco" / CASE / "part-00000.parquet"
    path.write_bytes(path.read_bytes()[:50])
    with pytest.raises(BadFolder, match=r"part-00000\.parquet: cannot be read as a table"):
        read(tmp_path, CASE)
