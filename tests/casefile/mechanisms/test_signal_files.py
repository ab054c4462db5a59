"""Signals of controllers in CSV files: what is read and stored of them, and the faults of files that come from strangers."""

import os
from pathlib import Path

import pytest

from bodycheck import CaseFaults, load
from bodycheck.casefile.case import parse
from bodycheck.casefile.identity import identity
from bodycheck.casefile.mechanisms.control_grammar import MAX_SIGNAL
from bodycheck.casefile.mechanisms.signal_files import MAX_BYTES, MAX_STORED
from bodycheck.casefile.mechanisms.stored import file_text
from bodycheck.reference.mechanisms.control import Samples
from bodycheck.reference.mechanisms.mechanism import Mechanism
from tests.support.mechanism_texts import CART_POLE

SIGNAL = '{file = "log/torque.csv", column = "pin", between = "linear"}'
DRIVEN = f'{CART_POLE}[[controllers]]\njoint = "pin"\nlaw = "effort"\neffort = {SIGNAL}\n'
LOG = "t,rail,pin\n0,1,0.1\n0.5,2,0.30000000000000004\n1.0e0,3,-.2\n"
VALUES = Samples((0.0, 0.5, 1.0), (0.1, 0.30000000000000004, -0.2), "linear")


def case_file(folder: Path, text: str = DRIVEN, log: str | bytes = LOG) -> Path:
    (folder / "log").mkdir(exist_ok=True)
    (folder / "log" / "torque.csv").write_bytes(log if isinstance(log, bytes) else log.encode())
    path = folder / "case.case.toml"
    path.write_text(text, "utf-8")
    return path


def efforts(case: object) -> list[object]:
    scene = getattr(case, "scene")  # noqa: B009
    assert isinstance(scene, Mechanism)
    return [controller.effort for controller in scene.controllers]


def faults(path: Path) -> list[str]:
    """Return the texts of the faults, each without the name of the case file."""
    with pytest.raises(CaseFaults) as caught:
        load(path)
    return [str(fault).removeprefix(f"{path}:") for fault in caught.value.faults]


@pytest.mark.parametrize("log", [LOG, LOG.replace("\n", "\r\n"), "\ufeff" + LOG, LOG.replace(",", " , "), LOG + "\n"])
def test_a_column_of_a_file_is_the_signal_and_is_read_again_without_the_file(tmp_path: Path, log: str) -> None:
    path = case_file(tmp_path, log=log)
    case = load(path)
    assert efforts(case) == [VALUES]
    (tmp_path / "log" / "torque.csv").unlink()
    assert parse(case.text, "stored") == case
    assert file_text(case) == DRIVEN


def test_the_same_numbers_in_a_file_and_in_the_case_are_the_same_motion(tmp_path: Path) -> None:
    inline = DRIVEN.replace(SIGNAL, '{times = [0.0, 0.5, 1.0], values = [0.1, 0.30000000000000004, -0.2], between = "linear"}')
    assert identity(load(case_file(tmp_path))) == identity(parse(inline, "f"))
    assert identity(load(case_file(tmp_path, log=LOG.replace("-.2", "-.3")))) != identity(parse(inline, "f"))


def test_several_columns_of_a_file_and_a_column_that_is_used_twice(tmp_path: Path) -> None:
    rail = '[[controllers]]\njoint = "rail"\nlaw = "pd"\n'
    two = f'target = {{file = "log/torque.csv", column = "rail"}}\neffort = {SIGNAL}\n'
    case = load(case_file(tmp_path, DRIVEN + rail + two))
    assert case.text.count("[[signals]]") == 2
    assert isinstance(case.scene, Mechanism)
    assert case.scene.controllers[1].target == Samples((0.0, 0.5, 1.0), (1.0, 2.0, 3.0), "hold")
    assert parse(case.text, "stored") == case


def test_a_text_without_its_file_is_refused() -> None:
    with pytest.raises(CaseFaults, match="is read only where a case file is loaded from its folder"):
        parse(DRIVEN, "f")


LINE = DRIVEN.splitlines().index(f"effort = {SIGNAL}") + 1


@pytest.mark.parametrize(
    ("log", "messages"),
    [
        ("", ["line 1, column 1: is empty; allowed: the heading t, for the times (s)"]),
        ("time,pin\n0,1\n", ["line 1, column 1: read 'time'; allowed: the heading t, for the times (s)"]),
        ("t,pin\n", ["has 0 rows below the headings; allowed: 1 to 10000"]),
        ("t,pin\n" + "0,1\n" * (MAX_SIGNAL + 1), ["has 10001 rows below the headings; allowed: 1 to 10000"]),
        ("t,pinn,rail\n0,1,2\n", ["has no column 'pin'; allowed: pinn, rail; did you mean 'pinn'?"]),
        ("t,pin,pin\n0,1,2\n", ["has no column 'pin'; allowed: none, as it has no other column"]),
        ("t,pin\n0,1\n0,2\n", ["line 3, column t: read 0; allowed: a time after 0.0, as times ascend"]),
        ("t,pin\n0,1\n1,2,3\n", ["line 3: has 3 fields; allowed: 2, as many as headings"]),
        (
            "t,pin\nnan,high\n1,1e101\n2,0x1\n",
            [
                "line 2, column t: read 'nan'; allowed: a number of at most 1e100",
                "line 2, column pin: read 'high'; allowed: a number of at most 1e100",
                "line 3, column pin: read '1e101'; allowed: a number of at most 1e100",
                "line 4, column pin: read '0x1'; allowed: a number of at most 1e100",
            ],
        ),
        (b"t,pin\n0,\xff\n", ["cannot be read: it is not UTF-8"]),
        ('t,pin\n0,"1\n', ["line 2: is no CSV: unexpected end of data"]),
    ],
)
def test_faults_of_a_file_name_its_lines_and_columns(tmp_path: Path, log: str | bytes, messages: list[str]) -> None:
    where = f"{LINE}:11: controllers[1].effort.file: read 'log/torque.csv'; log/torque.csv: "
    assert faults(case_file(tmp_path, log=log)) == [where + message for message in messages]


def test_only_some_faults_of_a_file_are_listed(tmp_path: Path) -> None:
    messages = faults(case_file(tmp_path, log="t,pin\n" + "".join(f"{time},x\n" for time in range(100))))
    assert len(messages) == 11
    assert messages[-1].endswith("has 90 more faults")


@pytest.mark.parametrize(
    "name", ["../torque.csv", "/etc/passwd", "absent.csv", "link.csv", "https://example.org/a.csv", "log", "pipe.csv"]
)
def test_nothing_outside_of_the_folder_is_read_and_only_regular_files(tmp_path: Path, name: str) -> None:
    folder = tmp_path / "cases"
    folder.mkdir()
    (tmp_path / "torque.csv").write_text(LOG)
    (folder / "link.csv").symlink_to(tmp_path / "torque.csv")
    os.mkfifo(folder / "pipe.csv")
    (message,) = faults(case_file(folder, DRIVEN.replace("log/torque.csv", name)))
    assert "controllers[1].effort.file" in message
    assert "root:" not in message


def test_files_and_what_is_stored_of_them_are_bounded(tmp_path: Path) -> None:
    (message,) = faults(case_file(tmp_path, log="t,pin\n" + " " * MAX_BYTES))
    assert "log/torque.csv" in message
    columns = MAX_STORED // (2 * MAX_SIGNAL) + 1
    heading = ",".join(["t", *(f"c{index}" for index in range(columns))])
    rows = "".join(f"{time}{',0' * columns}\n" for time in range(MAX_SIGNAL))
    bodies = "".join(f'[[bodies]]\nname = "b{n}"\nmass = 1.0\ninertia = [1, 1, 1]\n' for n in range(columns))
    joints = "".join(
        f'[[joints]]\nname = "j{n}"\ntype = "revolute"\nchild = "b{n}"\naxis = [0, 0, 1]\n' for n in range(columns)
    )
    table = '[[controllers]]\njoint = "j{0}"\nlaw = "effort"\neffort = {{file = "log/torque.csv", column = "c{0}"}}\n'
    text = 'format = 2\nname = "many"\ntitle = "Many"\n' + bodies + joints + "".join(map(table.format, range(columns)))
    (message,) = faults(case_file(tmp_path, text + "[run]\nduration = 1.0\nsamples = 2\n", f"{heading}\n{rows}"))
    assert f"the files of signals have {columns * 2 * MAX_SIGNAL} times and values in all; allowed: {MAX_STORED}" in message


def test_what_a_stranger_stores_is_checked(tmp_path: Path) -> None:
    stored = load(case_file(tmp_path)).text
    for old, new in (
        ("times = [0.0, 0.5, 1.0]", "times = [0.0, 0.5, 0.5]"),
        ("0.0, 0.5, 1.0]", "0.0, 0.5]"),
        ("-0.2]", "nan]"),
    ):
        assert old in stored
        with pytest.raises(CaseFaults):
            parse(stored.replace(old, new), "f")
