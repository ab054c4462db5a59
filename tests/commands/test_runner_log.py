"""The logs of CI runners: nothing that a file says or is called is taken for a command."""

import io
import json
import re
import tomllib
from pathlib import Path

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from bodycheck.runner_log import Guarded, escaped, harmless
from tests.support import ROOT
from tests.support.commands import bodycheck

#: How the runners of GitHub, Azure and TeamCity find commands in a line, which ends in a line feed or a carriage return.
COMMANDS = re.compile(r"^[\s\ufeff]*::|##\w*\[")
PIECES = st.sampled_from(["::", ":", "#", "##", "[", "vso", "error", "\n", "\r", "\r\n", " ", "\t", "\x1b[0m", "x", '"', "\\"])


def commands(text: str) -> list[str]:
    return [line for line in re.split(r"[\r\n]", text) if COMMANDS.search(line)]


@given(st.lists(PIECES, max_size=12).map("".join))
@example(" \t::error::x\n###[error]x ##vso[task.setvariable variable=x]y ::x")
def test_no_text_is_a_command(text: str) -> None:
    assert not commands(harmless(text))
    assert harmless(harmless(text)) == harmless(text)
    if not commands(text):
        assert harmless(text) == text


@given(st.text())
@example("\x1b[31mred\r\x9b2J\u202e\t")
def test_an_escaped_text_acts_on_no_terminal(text: str) -> None:
    assert all(line.isprintable() for line in escaped(text).split("\n"))
    assert escaped(escaped(text)) == escaped(text)
    assert escaped(text).count("\n") == text.count("\n")


def test_a_message_with_text_of_a_stranger_is_escaped(tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text("t,\x1b[31mred\n0,1\n0.1,x\n", "utf-8")
    done = bodycheck("compare", tmp_path / "log.csv", "free-brick", "--name", "isaac")
    assert done.returncode == 2
    assert "\\x1b[31mred: read 'x'" in done.stderr
    assert done.stderr.removesuffix("\n").isprintable()


@given(st.lists(st.lists(PIECES, max_size=5).map("".join), max_size=6))
def test_a_command_in_parts_is_found(parts: list[str]) -> None:
    stream = io.StringIO()
    guard = Guarded(stream)
    for part in parts:
        guard.write(part)
    guard.finish()
    assert stream.getvalue() == harmless("".join(parts))


@given(st.lists(PIECES, max_size=12).map("".join))
def test_json_and_toml_mean_the_same_behind_it(text: str) -> None:
    assert json.loads(harmless(json.dumps([text]))) == [text]
    assert tomllib.loads(harmless(f"x = {json.dumps(text)}")) == {"x": text}


def hostile(folder: Path) -> Path:
    path = folder / "::error title=x::y.case.toml"
    text = (ROOT / "cases" / "free-brick.case.toml").read_text().partition("[[expect]]")[0]
    path.write_text(text + '[[expect]]\nengine = "mujoco"\nintegrator = "a##[error]b"\ntimestep = 0.01\nposition_error = 1.0\n')
    return path


@pytest.mark.parametrize("command", ["validate", "run", "truth", "expect"])
def test_commands_print_no_command_that_a_file_contains(tmp_path: Path, command: str) -> None:
    name = hostile(tmp_path).name
    done = bodycheck(command, name, folder=tmp_path)
    assert not commands(done.stdout + done.stderr)
    (tmp_path / name).write_text("format = 1\n##[error]x\nx = = 1\n")
    done = bodycheck(command, name, folder=tmp_path)
    assert done.returncode == 2
    assert ":\\u003aerror title=x::y.case.toml:3:" in done.stderr
    assert not commands(done.stdout + done.stderr)


def test_pytest_prints_no_command_that_a_file_contains(pytester: pytest.Pytester, calls_here: None) -> None:
    hostile(pytester.path)
    pytester.path.joinpath("##[error]x.case.toml").write_text("##[error]x\nx = = 1\n")
    for options in ((), ("-v",), ("-vv", "-rA", "--continue-on-collection-errors")):
        result = pytester.runpytest(*options)
        assert not commands("\n".join(result.outlines + result.errlines))
    result.assert_outcomes(failed=1, errors=1)
    assert any("integrator 'a#\\u0023[error]b'" in line for line in result.outlines)
