"""Files are written whole or not at all and through no link, and only regular files of a limited size are read."""

import errno
import os
from collections.abc import Callable
from pathlib import Path

import pytest

from bodycheck.errors import BadFolder
from bodycheck.files import reading, writing
from bodycheck.files.writing import NotWritten


def test_a_file_takes_the_place_of_another_and_leaves_what_shares_its_content(tmp_path: Path) -> None:
    outside, path = tmp_path / "outside", tmp_path / "results" / "report.html"
    outside.write_text("irreplaceable")
    path.parent.mkdir()
    path.hardlink_to(outside)
    path.chmod(0o640)
    writing.write(path, b"new")
    assert (path.read_bytes(), outside.read_text()) == (b"new", "irreplaceable")
    assert path.stat().st_mode & 0o777 == 0o640
    assert list(path.parent.iterdir()) == [path]


@pytest.mark.parametrize("link", ["results/report.html", "results/figures", "results/figures/deep"])
def test_no_link_inside_a_results_folder_is_written_through(link: str, tmp_path: Path) -> None:
    real = tmp_path / "real"
    for name in ("real", "outside"):
        (tmp_path / name).mkdir()
    (tmp_path / "outside" / "kept").write_text("irreplaceable")
    (tmp_path / "results").symlink_to(real)  # the folder itself may be a link
    (tmp_path / link).parent.mkdir(exist_ok=True)
    (tmp_path / link).symlink_to(tmp_path / "outside" / ("kept" if link.endswith("html") else ""))
    path = tmp_path / link if link.endswith("html") else tmp_path / "results" / "figures" / "deep" / "kept"
    with pytest.raises(NotWritten, match=f"{link}: is a symbolic link"):
        writing.write(path, b"new", tmp_path / "results")
    assert [path.read_text() for path in (tmp_path / "outside").iterdir()] == ["irreplaceable"]
    (tmp_path / link).unlink()
    writing.write(path, b"new", tmp_path / "results")
    assert path.read_bytes() == b"new"


def test_a_link_that_the_user_names_is_followed(tmp_path: Path) -> None:
    (tmp_path / "real.xml").write_text("old")
    (tmp_path / "link.xml").symlink_to("real.xml")
    writing.write_named(tmp_path / "link.xml", b"new")
    assert (tmp_path / "link.xml").is_symlink()
    assert (tmp_path / "real.xml").read_bytes() == b"new"
    writing.write_named(Path(os.devnull), b"new")
    assert not Path(os.devnull).is_file()  # it is still the device


def test_a_full_disk_leaves_a_file_as_it_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(descriptor: int, content: bytes) -> int:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    (tmp_path / "table.csv").write_text("old")
    monkeypatch.setattr(os, "write", full)
    with pytest.raises(NotWritten, match=r"table\.csv: cannot be written: No space left on device"):
        writing.write(tmp_path / "table.csv", b"new")
    monkeypatch.undo()
    assert (tmp_path / "table.csv").read_text() == "old"
    assert len(list(tmp_path.iterdir())) == 1


def test_what_cannot_be_written_is_said(tmp_path: Path) -> None:
    (tmp_path / "table.csv").mkdir()
    (tmp_path / "file").touch()
    for path in (tmp_path / "table.csv", tmp_path / "absent" / "table.csv", tmp_path / "file" / "table.csv"):
        with pytest.raises(NotWritten, match=f"{path}: cannot be written: "):
            writing.write(path, b"new")
    with pytest.raises(NotWritten, match="file/results: cannot be written: Not a directory"):
        writing.make_folder(tmp_path / "file" / "results")


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda path: path.mkdir(), "is not a regular file"),
        (os.mkfifo, "is not a regular file"),
        (lambda path: path.symlink_to("/dev/zero"), "is not a regular file"),
        (lambda path: path.write_bytes(b"x" * 11), "larger than 10 bytes"),
    ],
)
def test_only_regular_files_of_a_limited_size_are_read(make: Callable[[Path], None], words: str, tmp_path: Path) -> None:
    path = tmp_path / "file"
    make(path)
    with pytest.raises(reading.Refused, match=words) as refused:
        reading.content(path, 10, follow=True)
    assert str(path) in str(refused.value)


def test_a_link_is_read_where_the_user_names_it_and_not_inside_a_folder(tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes(b"x" * 10)
    (tmp_path / "link").symlink_to("file")
    assert reading.content(tmp_path / "link", 10, follow=True) == b"x" * 10
    with pytest.raises(reading.Refused, match="is a symbolic link"):
        reading.content(tmp_path / "link", 10)


def test_links_at_any_depth_of_a_folder_are_refused(tmp_path: Path) -> None:
    folder = tmp_path / "results"
    (folder / "trajectories" / "spin").mkdir(parents=True)
    (tmp_path / "link").symlink_to(folder)
    for name in ("absent", "results", "link"):
        reading.refuse_links(tmp_path / name)
    (folder / "trajectories" / "spin" / "truth").symlink_to("nowhere")
    with pytest.raises(BadFolder, match="spin/truth: is a symbolic link"):
        reading.refuse_links(tmp_path / "link")
