"""Entries of the cache: what is damaged or may be another user's counts as missing, and one line says why."""

import os
import re
import stat
import sys
from collections.abc import Callable
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest

from bodycheck.environments import contents, user_cache

NAME = "records/entry.json"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The cache folder, in which there is one entry, of the text "größe"."""
    folder = tmp_path / "cache"
    monkeypatch.setenv(user_cache.VARIABLE, str(folder))
    user_cache._warn.cache_clear()
    user_cache.keep(NAME, "größe\n1")
    return folder


def test_an_entry_has_its_text_and_its_time_whatever_the_clock_of_its_file(folder: Path) -> None:
    os.utime(folder / NAME, (4e9, 4e9))
    entry = user_cache.kept(NAME)
    assert entry is not None
    assert entry.text == "größe\n1"
    assert abs(entry.time - datetime.now(UTC)) < timedelta(minutes=5)
    assert user_cache.times("records") == [entry.time]
    user_cache.forget(NAME)
    assert user_cache.kept(NAME) is None
    user_cache.forget(NAME)


def truncated(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:-1])


def extended(path: Path) -> None:
    path.write_bytes(path.read_bytes() + b" ")


def emptied(path: Path) -> None:
    path.write_bytes(b"")


def of_other_bytes(path: Path) -> None:
    path.write_bytes(b"\x80\x04\x95cposix\nsystem\n")


def of_deep_json(path: Path) -> None:
    path.write_bytes(b"[" * 1_000_000)


def huge(path: Path) -> None:
    os.truncate(path, user_cache.MAX_BYTES + 1)


def a_folder(path: Path) -> None:
    path.unlink()
    path.mkdir()


def a_link(path: Path) -> None:
    path.rename(path.with_name("elsewhere"))
    path.symlink_to("elsewhere")


def a_pipe(path: Path) -> None:
    path.unlink()
    os.mkfifo(path)


@pytest.mark.parametrize("damage", [truncated, extended, emptied, of_other_bytes, of_deep_json, huge, a_folder, a_link, a_pipe])
def test_a_damaged_entry_counts_as_missing_without_a_word(
    folder: Path, damage: Callable[[Path], None], capsys: pytest.CaptureFixture[str]
) -> None:
    damage(folder / NAME)
    assert user_cache.kept(NAME) is None
    assert len(user_cache.times("records")) <= 2  # those of damaged entries may be among them; none is waited for
    user_cache.keep(NAME, "new")
    kept = user_cache.kept(NAME)
    assert damage in (a_folder, a_link) or (kept is not None and kept.text == "new")
    assert capsys.readouterr().err == ""


@pytest.mark.skipif(sys.platform == "win32", reason="folders have no such permissions there")
@pytest.mark.parametrize("place", ["", "records", NAME])
def test_a_cache_that_others_can_change_is_neither_read_nor_written_and_one_line_says_so(
    folder: Path, place: str, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / place).chmod(0o777)
    before = (folder / NAME).read_bytes()
    for _ in range(2):
        assert user_cache.kept(NAME) is None
        if place != NAME:  # a file that others can change is replaced by one that they cannot change
            user_cache.keep(NAME, "new")
            assert (folder / NAME).read_bytes() == before
    line = f"bodycheck: {folder}: not used, because another user can change {folder / place}; let BODYCHECK_CACHE name "
    assert re.fullmatch(f"{re.escape(line)}.*\n", capsys.readouterr().err)


@pytest.mark.skipif(sys.platform == "win32", reason="folders have no such permissions there")
def test_an_entry_is_private_whatever_the_mask_of_new_files(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = os.umask(0)
    try:
        user_cache.keep("new/entry", "text")
    finally:
        os.umask(before)
    assert user_cache.kept("new/entry") is not None
    assert stat.S_IMODE((folder / "new/entry").stat().st_mode) == 0o600
    assert capsys.readouterr().err == ""


def test_a_digest_changes_with_what_is_installed_and_not_with_other_files(tmp_path: Path) -> None:
    (tmp_path / "toy-1.0.dist-info").mkdir()
    record = tmp_path / "toy-1.0.dist-info" / "RECORD"
    record.write_text("a,,\n")
    digests = [contents.of_distributions([tmp_path])]
    (tmp_path / "results.csv").write_text("1")
    (tmp_path / "results").mkdir()
    assert contents.of_distributions([tmp_path, tmp_path / "nowhere"]) == digests[0]
    for change in (lambda: record.write_text("b,c,\n"), lambda: (tmp_path / "module.py").write_text("1")):
        change()
        digests.append(contents.of_distributions([tmp_path]))
    whole = contents.of_folders([tmp_path])
    (tmp_path / "__pycache__").mkdir()
    (tmp_path / "__pycache__" / "module.pyc").write_text("1")
    assert contents.of_folders([tmp_path]) == whole
    os.utime(tmp_path / "module.py", (4e9, 4e9))
    assert contents.of_folders([tmp_path]) != whole
    assert len(set(digests)) == 3
