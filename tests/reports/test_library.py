"""The script of the charts is bundled once, and what is kept of it is used only if it is whole and nobody else's."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from bodycheck.reports import library


@pytest.fixture
def bundled(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[list[str]]:
    """The entries that a script was bundled for."""
    found: list[str] = []
    monkeypatch.setenv("BODYCHECK_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr(library.vl_convert, "javascript_bundle", lambda entry: found.append(entry) or "let größe = 1;\n")
    yield found
    library.script.cache_clear()


def script() -> str:
    """The script as another process finds it."""
    library.script.cache_clear()
    return library.script()


def test_the_script_is_bundled_once(bundled: list[str], tmp_path: Path) -> None:
    assert script() == script() == "let größe = 1;\n"
    assert bundled == [library.ENTRY]
    (file,) = (tmp_path / "cache" / "scripts").iterdir()
    file.write_text(file.read_text("utf-8")[:-4], "utf-8")
    assert script() == "let größe = 1;\n"
    assert len(bundled) == 2
    file.chmod(0o666)  # others may write to it
    assert script() == "let größe = 1;\n"
    assert len(bundled) == 3


def test_a_cache_that_cannot_be_written_is_no_fault(bundled: list[str], tmp_path: Path) -> None:
    (tmp_path / "cache").write_text("no folder")
    assert script() == script() == "let größe = 1;\n"
    assert len(bundled) == 2
