"""Records of claims: what they must contain, and the sentences that they give."""

import re
from pathlib import Path

import pytest

from bodycheck.errors import BadInput
from claims import records
from claims.records import Claim
from tests.claims.planted import RECORD, SCRIPT, plant


def test_every_record_is_right() -> None:
    assert records.claims().keys() >= {"mujoco/flip"}


def test_the_sentence_has_the_numbers_of_the_values(tmp_path: Path) -> None:
    claim = records.read(plant(tmp_path))
    assert records.sentence(claim) == "A stone falls 9.81e-4 m too far with Euler, in a run that is ok."
    assert records.sentence(claim, "short") == "0.001 m"
    with pytest.raises(BadInput, match=r"mujoco/planted: has no wording 'long'; there are: short"):
        records.sentence(claim, "long")


@pytest.mark.parametrize(("number", "shown", "text"), [(5.27e-9, ".1e", "5.3e-9"), (2e10, ".0e", "2e10"), (3.0, ".1f", "3.0")])
def test_exponents_are_written_without_padding(number: float, shown: str, text: str) -> None:
    assert records.Value(value=number, shown=shown, tolerance=0.1).text == text


@pytest.mark.parametrize(
    ("old", "new", "fault"),
    [
        ('engine = "mujoco"', 'engine = "mujuco"', r"planted.toml:2: engine: Value error, allowed: .*mujoco.*; read: 'mujuco'"),
        (
            'engine = "mujoco"',
            'engine = "drake"',
            r"planted.toml:2: engine: allowed: 'mujoco', the folder of the file; read: 'drake'",
        ),
        ('kind = "default"', 'kind = "bug"', r"planted.toml:4: kind: .*'fault', 'choice' or 'default'; read: 'bug'"),
        ('["4.0.0"]', '["new"]', r"planted.toml:3: releases.0: .*'new'"),
        ('["4.0.0"]', "[]", r"planted.toml:3: releases: .*at least 1"),
        ('"bodycheck run', '"sh run', r"planted.toml:5: command: "),
        ("{error}", "{eror}", r"planted.toml:1: sentence: allowed in braces: error, status; read: 'eror'"),
        ("tolerance = 0.01", "", r"values.error.tolerance: required for a number"),
        ('shown = ".2e"', 'shown = "q"', r"values.error.shown: allowed: a format of Python"),
        ('column = "position_error"', "", r"values.error.column: allowed: table and column together"),
        ('value = "ok"', "value = true", r"values.status.value"),
        ('value = "ok"', 'value = "ok"\ntolerance = 0.1', r"values.status.tolerance: not allowed for a word"),
        ('value = "ok"', 'value = "ok"\nreleases = ["3.0.0"]', r"values.status.releases: allowed: 4.0.0; read: '3.0.0'"),
        ("https://", "http://", r"documentation.0.address: .*begins with https://"),
        ('"b"]', "]", r"cause.against: .*at least 2"),
        ("[wordings]", "[words]", r"planted.toml:\d+: words: Extra inputs"),
        ('kind = "default"', 'kind = "default"\nname = "x"', r"planted.toml:5: name: Extra inputs"),
        ("[wordings]", "[wordings", r"planted.toml: is not TOML"),
    ],
)
def test_a_wrong_record_is_refused(tmp_path: Path, old: str, new: str, fault: str) -> None:
    assert RECORD.count(old) >= 1
    with pytest.raises(BadInput) as refused:
        records.read(plant(tmp_path, RECORD.replace(old, new, 1)))
    assert re.search(fault, str(refused.value)), str(refused.value)


@pytest.mark.parametrize(
    ("script", "fault"),
    [
        (None, r"planted.py: is missing"),
        ("\n" * 31, r"planted.py: has 31 lines, allowed: 30"),
        ("import bodycheck.casefile\n", r"planted.py: imports 'bodycheck', allowed: mujoco, numpy and the standard library"),
        ("from adapters import contract\n", r"planted.py: imports 'adapters'"),
    ],
)
def test_a_script_that_is_long_or_needs_bodycheck_is_refused(tmp_path: Path, script: str | None, fault: str) -> None:
    with pytest.raises(BadInput, match=fault):
        records.read(plant(tmp_path, RECORD, script))


def test_a_script_of_thirty_lines_is_right(tmp_path: Path) -> None:
    lines = SCRIPT.splitlines()
    claim = records.read(plant(tmp_path, RECORD, "\n".join([*lines, *["#"] * (30 - len(lines))])))
    assert isinstance(claim, Claim)
