"""Commands and scripts of claims are compared with their records: a wrong number and a false verdict are seen."""

from pathlib import Path

import pytest

from claims import measuring, records
from claims.measuring import Commands
from tests.claims.planted import RECORD, SCRIPT, plant


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("claims")


@pytest.fixture(scope="module")
def commands(tmp_path_factory: pytest.TempPathFactory) -> Commands:
    """The command that all records of this module have is run once."""
    return Commands(tmp_path_factory.mktemp("commands"))


def deviations(folder: Path, commands: Commands, record: str = RECORD, script: str = SCRIPT) -> list[str]:
    return list(measuring.deviations(records.read(plant(folder, record, script)), "4.0.0", commands))


def test_a_true_claim_holds(folder: Path, commands: Commands) -> None:
    assert deviations(folder, commands) == []
    assert len(commands.outputs) == 1


def test_a_wrong_number_deviates_from_the_command_and_from_the_script(folder: Path, commands: Commands) -> None:
    of_command, of_script = deviations(folder, commands, RECORD.replace("value = 9.81e-4", "value = 9.61e-4"))
    assert "mujoco/planted: error: bodycheck run" in of_command
    assert "--engine mujoco@4.0.0 --integrator Euler: gives 0.000981, the record says 0.000961 within 0.01" in of_command
    assert "mujoco/planted.py with mujoco 4.0.0: gives 0.000981, the record says 0.000961 within 0.01" in of_script


def test_a_false_verdict_deviates(folder: Path, commands: Commands) -> None:
    (deviation,) = deviations(folder, commands, RECORD.replace('value = "ok"', 'value = "diverged"'))
    assert deviation.endswith("gives 'ok', the record says 'diverged'")


def test_a_script_that_prints_another_number_or_none_deviates(folder: Path, commands: Commands) -> None:
    (deviation,) = deviations(folder, commands, script='print("error 1")\n')
    assert "planted.py with mujoco 4.0.0: gives 1, the record says 0.000981" in deviation
    (deviation,) = deviations(folder, commands, script='print("eror 1")\n')
    assert deviation.endswith("does not print it")


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ("--integrator Euler", "--integrator Oiler", "exit code 2"),
        ('integrator = "Euler", timestep', 'integrator = "RK4", timestep', "0 values in rows with"),
        ('column = "status"', 'column = "state"', "has no column state"),
        ('table = "results.csv"', 'table = "tradeoff.csv"', "tradeoff.csv: cannot be read"),
    ],
)
def test_a_command_that_does_not_give_the_value_fails(
    folder: Path, commands: Commands, old: str, new: str, reason: str
) -> None:
    with pytest.raises(measuring.Failed, match=reason):
        deviations(folder, commands, RECORD.replace(old, new))


def test_a_script_that_fails_is_named(folder: Path, commands: Commands) -> None:
    with pytest.raises(measuring.Failed, match=r"planted.py with mujoco 4.0.0: exit code 1: (.|\n)*ZeroDivisionError"):
        deviations(folder, commands, script="1 / 0\n")


def test_a_table_that_a_command_prints_is_read() -> None:
    value = records.Value(value=1.5, shown=".1f", tolerance=0.1, table="stdout", row={"method": "RK4"}, column="m")
    printed = "text\n| method | m |\n| --- | --- |\n| Euler | 2.5 |\n| RK4 | 1.5 |\n"
    assert measuring._cell(value, "a command", Path(), printed) == "1.5"
