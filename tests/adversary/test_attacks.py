"""Attacks: what strangers send ends in results or in a message, and what is killed comes to the same.

A hostile case file is a case or has faults with places, and a case has a truth or a reason why it has none. A run of a case
ends with an exit code, whatever its engine does. Damaged folders and baselines are read or refused, and nothing is written
beside them.
"""

import sys

import pytest

from bodycheck.adapters import registry
from tests.adversary.kills import TOLD
from tests.adversary.saved import KINDS, SAVED
from tests.adversary.sizes import batches
from tests.adversary.trials import failures
from tests.support import saved_results


def test_a_few_attacks_of_all_kinds_end_well(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(SAVED, str(saved_results.made(tmp_path_factory, "run")))
    assert not failures("mixed:any_kind", 1, 40)


@pytest.mark.slow
@pytest.mark.parametrize(("first", "count"), batches("FILES"))
def test_hostile_files_have_faults_or_a_truth(first: int, count: int) -> None:
    assert not failures("loading:truth_of_a_file", first, count)


@pytest.mark.slow
@pytest.mark.parametrize(("first", "count"), batches("RUNS"))
def test_runs_of_hostile_files_end_well(first: int, count: int) -> None:
    assert not failures("runs:run_of_a_file", first, count)


@pytest.mark.slow
@pytest.mark.parametrize(("first", "count"), batches("FOLDERS"))
def test_damaged_folders_are_reported_or_refused(
    tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch, first: int, count: int
) -> None:
    monkeypatch.setenv(SAVED, str(saved_results.made(tmp_path_factory, *sorted({*KINDS}))))
    assert not failures("saved:report_of_damage", first, count)


@pytest.mark.slow
@pytest.mark.parametrize(("first", "count"), batches("FOLDERS"))
def test_damaged_ensembles_are_read_or_refused(first: int, count: int) -> None:
    assert not failures("ensembles:command_on_damage", first, count)


@pytest.mark.slow
@pytest.mark.parametrize(("first", "count"), batches("FOLDERS", 2))
def test_damaged_baselines_are_compared_or_refused(first: int, count: int) -> None:
    assert not failures("saved:diff_of_damage", first, count)


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="workers end with a killed command on Linux alone")
@pytest.mark.parametrize(("first", "count"), batches("KILLS", 10))
def test_what_is_killed_comes_to_the_same(
    tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch, first: int, count: int
) -> None:
    monkeypatch.setenv(TOLD, str(saved_results.shared(tmp_path_factory, "undisturbed")))
    assert not failures("kills:killed_command", first, count)


@pytest.mark.slow
@pytest.mark.skipif(not registry.installed("mujoco"), reason="MuJoCo, which reads the files, is not installed")
def test_damaged_robot_files_have_rows_and_spoil_no_others() -> None:
    assert not failures("robot_files:parity_of_a_folder", 1, 20)
