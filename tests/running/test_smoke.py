"""The checks of adapters: the fault of an exception is told once, with the line of the adapter that raised it."""

import re
from pathlib import Path

import pytest

from bodycheck.adapters import registry
from bodycheck.running import smoke
from tests.support.planted_engines import plant

#: An adapter whose `prepare` looks up what is not there, in a function that it calls.
LOOKING_UP = """
from dataclasses import replace
engine = replace(RECORD, models=frozenset({"gravity", "translation", "rotation"}))

def prepare(scenes, method):
    return masses({})

def masses(of):
    return of["mass"]
"""


@pytest.fixture
def planted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    plant(tmp_path, {"looking-up": LOOKING_UP, "unimportable": "\nlen(3)\n", "asking": "import json\njson.loads('{')\n"})
    monkeypatch.setenv("BODYCHECK_CACHE", str(tmp_path / "cache"))
    monkeypatch.syspath_prepend(tmp_path)


def line_of(text: str, tmp_path: Path, place: int) -> str:
    """Return the name of the module of an engine and the number of the line with a text."""
    (module,) = tmp_path.glob(f"planted_*_{place}.py")
    (number,) = [number for number, line in enumerate(module.read_text("utf-8").splitlines(), 1) if line.strip() == text]
    return f"{module.name}:{number}"


def test_an_exception_is_told_once_with_its_line(planted: None, tmp_path: Path) -> None:
    line = line_of('return of["mass"]', tmp_path, 0)
    checks = f"looking-up step: {smoke.SCENES[0].name}, but it raises KeyError: 'mass' at {line}; so do 6 further checks"
    assert smoke.check("looking-up") == [checks]


@pytest.mark.parametrize(("name", "place", "text"), [("unimportable", 1, "len(3)"), ("asking", 2, "json.loads('{')")])
def test_an_exception_at_import_names_the_line_of_the_adapter(
    planted: None, tmp_path: Path, name: str, place: int, text: str
) -> None:
    with pytest.raises(registry.EngineBroken, match=f"Error: .* at {re.escape(line_of(text, tmp_path, place))}$"):
        registry.load(name)
