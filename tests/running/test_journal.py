"""Journals are read as they were written, and gone on with wherever they were cut."""

import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from bodycheck.errors import BadInput
from bodycheck.results import journal

HEADER = {"identity": "the same", "text": "Größe"}


def written(path: Path, header: dict[str, Any], *records: dict[str, Any]) -> bytes:
    with journal.begin(path, header) as opened:
        for record in records:
            opened.add(record)
    return path.read_bytes()


def test_a_journal_is_read_as_it_was_written(tmp_path: Path) -> None:
    path = tmp_path / "new" / "folder" / "journal.jsonl"
    written(path, HEADER, {"one": 1}, {"two": [2.0, None, "zwölf"]})
    expected = journal.Contents({"record": "header", **HEADER}, ({"one": 1}, {"two": [2.0, None, "zwölf"]}), complete=True)
    assert journal.read(path) == expected


def test_a_journal_cut_anywhere_is_gone_on_with(tmp_path: Path) -> None:
    """At every byte, those within a letter of two bytes too."""
    path = tmp_path / "journal.jsonl"
    records = [{"number": number, "letter": "ü"} for number in range(3)]
    whole = written(path, HEADER, *records)
    ends = [place + 1 for place, byte in enumerate(whole) if byte == ord("\n")]
    for cut in range(len(whole)):
        path.write_bytes(whole[:cut])
        lines = sum(end <= cut for end in ends)
        if lines:
            contents = journal.read(path)
            assert (list(contents.records), contents.complete) == (records[: lines - 1], False)
        with journal.resume(path, HEADER) as resumed:
            assert list(resumed.records) == records[: max(0, lines - 1)]
            for record in records[len(resumed.records) :]:
                resumed.add(record)
        assert path.read_bytes() == whole


@pytest.mark.parametrize("header", [HEADER, HEADER | {"identity": "another"}])
def test_what_is_complete_or_other_work_is_begun_anew(tmp_path: Path, header: dict[str, Any]) -> None:
    path = tmp_path / "journal.jsonl"
    whole = written(path, HEADER, {"number": 1})
    if header != HEADER:
        path.write_bytes(whole[: whole.rindex(b'{"record": "footer"')])
    with journal.resume(path, header | {"text": "new"}) as resumed:
        assert resumed.records == ()
    assert journal.read(path) == journal.Contents({"record": "header", **header, "text": "new"}, (), complete=True)


def test_a_journal_whose_writer_fails_is_interrupted(tmp_path: Path) -> None:
    path = tmp_path / "journal.jsonl"
    with pytest.raises(TypeError), journal.begin(path, HEADER) as opened:
        list(map(opened.add, ({"number": 1}, {"number": 2j})))
    assert not journal.read(path).complete
    with journal.resume(path, HEADER) as resumed:
        assert resumed.records == ({"number": 1},)


def test_nobody_else_writes_a_journal_that_is_being_written(tmp_path: Path) -> None:
    path = tmp_path / "journal.jsonl"
    with journal.begin(path, HEADER) as opened:
        opened.add({"number": 1})
        for other in (journal.begin, journal.resume):
            with pytest.raises(journal.BadJournal, match="another process is writing it"):
                other(path, HEADER)
    assert journal.read(path).records == ({"number": 1},)
    assert list(tmp_path.iterdir()) == [path]


WRITER = """
import sys, time
from pathlib import Path
from bodycheck.results import journal
opened = journal.begin(Path(sys.argv[1]), {"identity": "the same"})
print("open", flush=True)
time.sleep(600)
"""


def test_the_lock_of_a_process_ends_with_it(tmp_path: Path) -> None:
    path = tmp_path / "journal.jsonl"
    with subprocess.Popen([sys.executable, "-c", WRITER, path], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "open\n"
        with pytest.raises(journal.BadJournal, match="another process is writing it"):
            journal.resume(path, HEADER)
        process.kill()
    with journal.resume(path, HEADER) as resumed:
        resumed.add({"number": 1})
    assert journal.read(path).complete
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"half a line",
        b'{"no": "header"}\n',
        b"[]\n",
        b'{"record": "header"}\nnonsense\n',
        b'{"record": "header"}\n3\n',
        b'{"record": "header"}\n' + b"[" * 100_000 + b"\n",
        b"\xff\n",
    ],
)
def test_what_is_no_journal_is_bad_input(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "journal.jsonl"
    path.write_bytes(content)
    with pytest.raises(BadInput, match="not a journal"):
        journal.read(path)
    with journal.resume(path, HEADER) as begun:
        assert begun.records == ()
    with pytest.raises(BadInput, match="not a journal"):
        journal.read(tmp_path / "absent.jsonl")


def test_a_folder_that_is_replaced_meanwhile_keeps_the_error_of_the_work(tmp_path: Path) -> None:
    folder = tmp_path / "out"

    def replace_by_a_file_and_fail() -> None:
        shutil.rmtree(folder)
        folder.write_text("a file")
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError), journal.begin(folder / "run.jsonl", HEADER):
        replace_by_a_file_and_fail()
