"""Hostile results folders and submissions, each made of an honest one by one change."""

import csv
import io
import json
import os
import socket
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from bodycheck.results.origin import BESIDE
from bodycheck.site.submissions import archive, contents, packing
from tests.site import submissions as made

Attack = Callable[[Path], Path]

RESULTS, NOTE = "results.csv", f"results.csv{BESIDE}"

#: Values for a column of results.csv that no run has.
ENTRIES: tuple[tuple[str, str], ...] = (
    *(("case", name) for name in ("../../index", "Free-Brick", "free-brick.0123456789ab", "no-such", "con", "", "a" * 500)),
    *(("engine", name) for name in ("../index", "index.html", "MuJoCo", "mujoco@", "mujoco@1@2", "dart", "file", "", "é" * 40)),
    *(("version", text) for text in ("4.0.0<script>", "../..", "9" * 60, "4.0.1", "", "4 0", "٤")),
    *(("integrator", text) for text in ("<script>x</script>", "Euler:", "Euler:a", "", "a" * 400, "E\u202eler", "Euler\u0000")),
    *(("timestep", text) for text in ("nan", "inf", "-0.002", "0", "1e999", "1e-999", "1_0", "٣", "0x10", "", "1" * 5000)),
    *(("status", text) for text in ("OK", "", "good", "<b>ok</b>", "not run")),
    *(("passed", text) for text in ("true", "1", "yes")),
    *(("attitude_error", text) for text in ("-1", "4", "3.2", "1e201", "1e400", "nan", "Infinity", "one", "<svg onload=x>")),
    *(("truth_error", text) for text in ("-1e-10", "1e300", "-inf")),
    *(("steps", text) for text in ("0", "1.5", "9" * 20, "-1", "1e3", "1 000")),
    *(
        ("reason", text)
        for text in (
            "<script>alert(1)</script>",
            "< / script >",
            "<img src=x onerror=alert(1)>",
            "<a onmouseover = 'x'>",
            "javascript:alert(1)",
            "\u202etxt.exe",
            "\u2066isolated\u2069",
            "שלום",
            "Z\u0351\u036b\u0343a\u030a\u0326lgo",
            "\x1b[31mred",
            "bell\x07",
            "\ufeff",
            "zero\u200bwidth",
            "soft\u00adhyphen",
            "line\u2028separator",
            "a" * 5000,
        )
    ),
)

#: Values for the header that no command writes, by entry.
HEADERS: tuple[tuple[str, Any], ...] = (
    ("started", "yesterday"),
    ("started", "9999-12-31T00:00:00+00:00"),
    ("started", "2026-02-30T00:00:00+00:00"),
    ("started", "2026-01-01T00:00:00+00:00\n"),
    ("started", "٢٠٢٦-01-01T00:00:00+00:00"),
    ("started", 1),
    ("bodycheck", "0.1.0\u202e"),
    ("bodycheck", "x" * 100),
    ("bodycheck", None),
    ("command", "bodycheck run"),
    ("command", {}),
    ("command", ["bodycheck", *["run"] * 1000]),
    ("command", ["bodycheck", "<script>x</script>"]),
    ("machine", {f"key{place}": "x" for place in range(1000)}),
    ("machine", {"processor": "x" * 1000}),
    ("machine", {"processor": "<img src=//example.org/x>"}),
    ("machine", {"processor": ["nested"]}),
    ("machine", {"<b>": "x"}),
    ("machine", None),
    ("packages", {"numpy": {"deep": {"deeper": 1}}}),
    ("engines", {}),
    ("engines", {"mujoco": "4.0.1"}),
    ("engines", {"../mujoco": "4.0.0", "mujoco": "4.0.0"}),
    ("engines", {"mujoco": "4.0.0", **{f"engine{place}": "1" for place in range(1000)}}),
    ("engines", {"mujoco": "4.0.0", "MUJOCO": "4.0.0"}),
    ("missing", {"dart": "<script>x</script>"}),
    ("missing", {"index.html": "why"}),
    ("environments", {"mujoco": {"p" * 500: "0"}}),
    ("environments", {"mujoco": {f"package{place}": "0" for place in range(1000)}}),
    ("defaults", {"mujoco": {"integrator": "<style>*{}</style>"}}),
    ("precisions", {"mujoco": "float16"}),
    ("soft", {"mujoco": {"loops": "<script>x</script>"}}),
    ("without_method", {"mujoco": {"../index": "why"}}),
    ("without_method", {"mujoco": {"free-brick": "\u202e"}}),
    ("more", {"entries": "unknown"}),
)


def entry(column: str, text: str) -> Attack:
    """An attack by one entry of results.csv."""

    def attack(folder: Path) -> Path:
        rows = _rows(made.write_folder(folder / "hostile", {RESULTS: [made.run()]}))
        rows[1][rows[0].index(column)] = text
        return _packed(folder, {f"tables/{RESULTS}": table_of(rows)})

    return attack


def table(change: Callable[[bytes], bytes]) -> Attack:
    """An attack by the bytes of results.csv."""

    def attack(folder: Path) -> Path:
        honest = made.write_folder(folder / "hostile", {RESULTS: [made.run()]}) / RESULTS
        return _packed(folder, {f"tables/{RESULTS}": change(honest.read_bytes())})

    return attack


def header(name: str, value: Any) -> Attack:
    """An attack by one entry of the header."""

    def attack(folder: Path) -> Path:
        made.write_folder(folder / "hostile", {RESULTS: [made.run()]})
        return _packed(folder, {}, {name: value})

    return attack


def case(name: str, text: str) -> Attack:
    """An attack by a case file, with a run of the case."""

    def attack(folder: Path) -> Path:
        rows = _rows(made.write_folder(folder / "hostile", {RESULTS: [made.run()]}))
        rows[1][rows[0].index("case")] = name
        return _packed(folder, {f"tables/{RESULTS}": table_of(rows), f"cases/{name}.case.toml": text.encode()})

    return attack


def tracks(own: bytes) -> Attack:
    """An attack by the file with motions."""

    def attack(folder: Path) -> Path:
        made.write_folder(folder / "hostile", {RESULTS: [made.run()]})
        return _packed(folder, {contents.TRACKS: own})

    return attack


def note(change: Callable[[Any], Any]) -> Attack:
    """An attack by the file beside results.csv of a results folder."""

    def attack(folder: Path) -> Path:
        path = made.write_folder(folder / "hostile", {RESULTS: [made.run()]}) / NOTE
        changed = change(json.loads(path.read_text()))
        path.write_text(changed if isinstance(changed, str) else json.dumps(changed))
        return path.parent

    return attack


def placed(name: str, put: Callable[[Path], None]) -> Attack:
    """An attack by what stands in the place of a file of a results folder."""

    def attack(folder: Path) -> Path:
        honest = made.write_folder(folder / "hostile", {RESULTS: [made.run()]})
        (honest / name).unlink()
        put(honest / name)
        return honest

    return attack


def zipped(write: Callable[[zipfile.ZipFile, Mapping[str, bytes]], None]) -> Attack:
    """An attack by a zip file that is made otherwise of the files of a submission."""

    def attack(folder: Path) -> Path:
        honest = packing.contents(made.write_folder(folder / "hostile", {RESULTS: [made.run()]}))
        path = _own(folder) / "hostile.zip"
        with zipfile.ZipFile(path, "w") as stream:
            write(stream, {archive.MANIFEST: contents.manifest(honest), **honest.files})
        return path

    return attack


def content(change: Callable[[bytes], bytes]) -> Attack:
    """An attack by the bytes of a zip file."""

    def attack(folder: Path) -> Path:
        honest = packing.contents(made.write_folder(folder / "hostile", {RESULTS: [made.run()]}))
        path = _own(folder) / "hostile.zip"
        path.write_bytes(change(archive.zipped(honest)))
        return path

    return attack


def symlink(target: str) -> Callable[[Path], None]:
    """A symbolic link to a file that exists."""
    return lambda path: path.symlink_to(target)


def text(written: str) -> Callable[[Path], None]:
    """A file with a text."""

    def put(path: Path) -> None:
        path.write_text(written)

    return put


def fifo(path: Path) -> None:
    """A pipe that nobody writes into."""
    os.mkfifo(path)


def listening(path: Path) -> None:
    """A socket; its name must be short."""
    here = Path.cwd()
    os.chdir(path.parent)
    try:
        with socket.socket(socket.AF_UNIX) as made_socket:
            made_socket.bind(path.name)
    finally:
        os.chdir(here)


def sparse(path: Path) -> None:
    """A file of 100 GB that takes no room."""
    with path.open("wb") as stream:
        stream.truncate(100 << 30)


def write_all(stream: zipfile.ZipFile, files: Mapping[str, bytes]) -> None:
    """Write files into a zip file."""
    for name, own in files.items():
        stream.writestr(name, own, zipfile.ZIP_DEFLATED)


def with_manifest(change: Callable[[dict[str, Any]], Any]) -> Attack:
    """An attack by submission.json."""

    def write(stream: zipfile.ZipFile, files: Mapping[str, bytes]) -> None:
        changed = change(json.loads(files[archive.MANIFEST]))
        told = changed if isinstance(changed, str) else json.dumps(changed)
        write_all(stream, {**files, archive.MANIFEST: told.encode()})

    return zipped(write)


def with_file(name: str, own: bytes) -> Attack:
    """An attack by a file that is not one of a submission's."""
    return zipped(lambda stream, files: write_all(stream, {**files, name: own}))


def rows_of(own: bytes) -> list[list[str]]:
    """The rows of a table, the first of which are its columns."""
    return list(csv.reader(io.StringIO(own.decode(), newline="")))


def table_of(rows: list[list[str]]) -> bytes:
    """The table with these rows."""
    stream = io.StringIO()
    csv.writer(stream, lineterminator="\n").writerows(rows)
    return stream.getvalue().encode("utf-8", "replace")


def _rows(folder: Path) -> list[list[str]]:
    return rows_of((folder / RESULTS).read_bytes())


def _own(folder: Path) -> Path:
    path = folder / "zip"
    path.mkdir(exist_ok=True)
    return path


def _packed(folder: Path, files: Mapping[str, bytes], told: Mapping[str, Any] | None = None) -> Path:
    """A zip file of the honest folder with other files and entries of the header, whose digests are right."""
    honest = packing.contents(folder / "hostile")
    hostile = contents.Contents({**honest.header, **(told or {})}, {**honest.files, **files})
    path = _own(folder) / "hostile.zip"
    path.write_bytes(archive.zipped(hostile))
    return path
