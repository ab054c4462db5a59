"""The command `bodycheck export`: where the script is written, and how what cannot be is refused."""

from pathlib import Path

import pytest

from tests.support.commands import bodycheck


def test_the_script_is_printed_or_written_to_a_file(calls_here: None, tmp_path: Path) -> None:
    asked = ("export", "free-brick", "--engine", "mujoco", "--integrator", "RK4", "--timestep", "0.01")
    done = bodycheck(*asked)
    assert (done.returncode, done.stderr) == (0, "")
    assert 'integrator="RK4"' in done.stdout
    assert "TIMESTEP = 0.01" in done.stdout
    written = bodycheck(*asked, "--out", "script.py", folder=tmp_path)
    assert (written.returncode, written.stdout) == (0, "script.py\n")
    assert (tmp_path / "script.py").read_text() == done.stdout


def test_without_an_integrator_it_is_the_first_one_of_the_engine(calls_here: None) -> None:
    done = bodycheck("export", "curling-brick", "--engine", "mujoco")
    assert "with the method Euler and a time step of 0.002 s" in done.stdout


@pytest.mark.parametrize(
    ("options", "code", "told"),
    [
        (("free-brick", "--engine", "mujocco"), 2, "there is no engine 'mujocco'"),
        (("free-brick", "--engine", "mujoco", "--integrator", "RK5"), 2, "mujoco has no integrator 'RK5'; there are: Euler"),
        (("free-brick", "--engine", "mujoco", "--timestep", "0"), 2, "free-brick: time step 0 s: must be positive"),
        (("free-brick", "--engine", "mujoco", "--out", "no/where.py"), 2, "--out no/where.py: there is no folder no"),
        (("no-such-case", "--engine", "mujoco"), 2, "no-such-case"),
        (
            ("curling-brick", "--engine", "mujoco", "--integrator", "Euler:model=planar"),
            1,
            "curling-brick: a script of the model",
        ),
    ],
)
def test_what_is_not_possible_is_refused_in_one_line(
    calls_here: None, tmp_path: Path, options: tuple[str, ...], code: int, told: str
) -> None:
    done = bodycheck("export", *options, folder=tmp_path)
    assert (done.returncode, done.stdout) == (code, "")
    assert told in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert not list(tmp_path.iterdir())
