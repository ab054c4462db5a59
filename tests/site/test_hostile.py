"""What strangers may send: the site shows that something was left out, and why, in errors.html, and nothing else changes."""

import os
import re
import subprocess
import sys
import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path

import pytest

from bodycheck.casefile import case as case_files
from bodycheck.site import build, catalogue, links
from bodycheck.site.submissions import archive, gathering
from bodycheck.site.submissions.submission import LeftOut, Submission
from tests.site import hostile
from tests.site import submissions as made
from tests.site.hostile import Attack, content, note, placed, table, with_file, with_manifest, zipped

FLIP = case_files.load(made.FREE).text

#: A case file of which no more than the name is that of the shipped one, and one of a stranger.
OTHER_PHYSICS = FLIP.replace("duration = ", "duration = 1")
OWN = FLIP.replace(f'name = "{made.FREE}"', 'name = "my-case"')

DEEP = 200_000


def wide(rows: bytes) -> bytes:
    """A table of a thousand columns."""
    head, *others = rows.splitlines()
    return b"\n".join([head + b"".join(b",c%d" % place for place in range(1000)), *(line + b"," * 1000 for line in others)])


def longer(rows: bytes) -> bytes:
    """A table of as many rows as there is room for."""
    head, row, *_ = rows.splitlines(keepends=True)
    return head + row * (archive.MOST_OF_ONE // len(row) - 1)


TABLES: dict[str, Attack] = {
    "no bytes": table(lambda _: b""),
    "only lines": table(lambda _: b"\n" * 1_000_000),
    "only commas": table(lambda _: b"," * 20_000_000),
    "no rows": table(lambda rows: rows.splitlines(keepends=True)[0]),
    "a thousand columns": table(wide),
    "a column twice": table(lambda rows: rows.replace(b"velocity_error", b"position_error", 1)),
    "a column less": table(lambda rows: rows.replace(b"status", b"state", 1)),
    "a long name of a column": table(lambda rows: rows.replace(b"status", b"s" * 90_000, 1)),
    "markup as a column": table(lambda rows: rows.replace(b"status", b"<script>x</script>", 1)),
    "a short row": table(lambda rows: rows + b"free-brick\n"),
    "a long row": table(lambda rows: rows.rstrip() + b"," * 10 + b"\n"),
    "a row twice": table(lambda rows: rows + rows.splitlines(keepends=True)[1]),
    "many rows": table(longer),
    "an open quote": table(lambda rows: rows + b'"open' + b"\nx" * 100_000),
    "a null": table(lambda rows: rows.replace(b"ok", b"o\x00k", 1)),
    "other bytes": table(lambda rows: rows.replace(b"ok", b"\xff\xfe", 1)),
    "random bytes": table(lambda _: bytes(range(256)) * 100),
    "UTF-16": table(lambda rows: rows.decode().encode("utf-16")),
    "not ok with figures": table(lambda rows: rows.replace(b",ok,", b",diverged,", 1)),
}

NOTES: dict[str, Attack] = {
    "no object": note(lambda _: []),
    "no notes": note(lambda told: {**told, "notes": []}),
    "two notes": note(lambda told: {**told, "notes": told["notes"] * 2}),
    "a note that is none": note(lambda told: {**told, "notes": ["<script>"]}),
    "a deep list": note(lambda _: "[" * DEEP + "]" * DEEP),
    "a deep object": note(lambda _: '{"a":' * DEEP + "1" + "}" * DEEP),
    "a huge integer": note(lambda _: '{"notes": [' + "9" * 100_000 + "]}"),
    "not a number": note(lambda _: '{"notes": [NaN]}'),
    "no JSON": note(lambda _: "<script>"),
    "no command": note(lambda told: {**told, "notes": [{**told["notes"][0], "command": None}]}),
    "digests that are none": note(lambda told: {**told, "notes": [{**told["notes"][0], "cases_sha256": [1]}]}),
    "digests of others": note(lambda told: {**told, "notes": [{**told["notes"][0], "cases_sha256": {made.FREE: "0" * 64}}]}),
    "an unknown case": note(lambda told: {**told, "notes": [{**told["notes"][0], "cases_sha256": {"../x": "0" * 64}}]}),
    "a case that cannot be": note(lambda told: {**told, "notes": [{**told["notes"][0], "cases_sha256": {made.FREE: ["x"]}}]}),
}

PLACES: dict[str, Attack] = {
    f"{what} as {name}": placed(name, put)
    for name in (hostile.RESULTS, hostile.NOTE, "run.jsonl")
    for what, put in (
        ("a link", hostile.symlink("/etc/passwd")),
        ("a link to a device", hostile.symlink("/dev/zero")),
        ("a link to itself", hostile.symlink(name)),
        ("a pipe", hostile.fifo),
        ("a socket", hostile.listening),
        ("100 GB", hostile.sparse),
        ("a deep list", hostile.text("[" * DEEP)),
    )
    if not (name == "run.jsonl" and what in ("a pipe", "a socket"))  # which a folder may have beside its tables
}

CASES: dict[str, Attack] = {
    "other physics": hostile.case(made.FREE, OTHER_PHYSICS),
    "another name": hostile.case("my-case", FLIP),
    "no case": hostile.case("my-case", "<script>x</script>"),
    "nothing": hostile.case("my-case", ""),
    "markup in the title": hostile.case("my-case", 'title = "<script>x</script>"\n' + OWN.replace("title", "#", 1)),
    "a turned title": hostile.case("my-case", 'title = "x\u202ey"\n' + OWN.replace("title", "#", 1)),
    "an address": hostile.case("my-case", 'title = "by someone@example.org"\n' + OWN.replace("title", "#", 1)),
    "a deep list": hostile.case("my-case", f"{OWN}\nx = {'[' * 50_000}"),
    "deep keys": hostile.case("my-case", f"{OWN}\n[{'.'.join('a' * 20_000)}]\n"),
    "deep tables": hostile.case("my-case", f"{OWN}\nx = {'{a=' * 50_000}"),
    "a megabyte": hostile.case("my-case", f"{OWN}\n#{'x' * (1 << 20)}"),
    "many numbers": hostile.case("my-case", f"{OWN}\nx = [{'1,' * 20_000}]"),
    "many bodies": hostile.case("my-case", OWN + '\n[[bodies]]\nname = "a"\nmass = 1\n' * 10_000),
}


def bomb(stream: zipfile.ZipFile, files: Mapping[str, bytes]) -> None:
    hostile.write_all(stream, {**files, "tables/results.csv": b"\0" * (archive.MOST_OF_ONE + 1)})


def other_compression(stream: zipfile.ZipFile, files: Mapping[str, bytes]) -> None:
    for name, own in files.items():
        stream.writestr(name, own, zipfile.ZIP_LZMA)


def twice(stream: zipfile.ZipFile, files: Mapping[str, bytes]) -> None:
    hostile.write_all(stream, files)
    with pytest.warns(UserWarning, match="Duplicate name"):
        hostile.write_all(stream, files)


def encrypted(written: bytes) -> bytes:
    """Both entries of each file say that it is encrypted."""
    marked = bytearray(written)
    for mark, place in ((b"PK\x03\x04", 6), (b"PK\x01\x02", 8)):
        start = -1
        while (start := marked.find(mark, start + 1)) >= 0:
            marked[start + place] |= 1
    return bytes(marked)


NAMES = (
    *("../evil.html", "/etc/passwd", "tables/../index.html", "TABLES/results.csv", "tables/Results.csv", "tables/results.csv/"),
    *("cases/x.html", "cases/../x.case.toml", "cases/A.case.toml", "index.html", "a\\b", "errors.html", "tables\u2215x", "con"),
)

ZIPS: dict[str, Attack] = {
    "no zip file": content(lambda _: b"<script>"),
    "no bytes": content(lambda _: b""),
    "a part": content(lambda written: written[: len(written) // 2]),
    "damaged": content(lambda written: written[:200] + b"\0" * 300 + written[500:]),
    "encrypted": content(encrypted),
    "much of nothing": content(lambda written: b"PK\x01\x02" * 100_000 + written),
    "too large": content(lambda written: b"\0" * (archive.MOST_PACKED + 1) + written),
    "a bomb": zipped(bomb),
    "other compression": zipped(other_compression),
    "files twice": zipped(twice),
    "many files": zipped(lambda stream, _: hostile.write_all(stream, {f"cases/c{n}.case.toml": b"" for n in range(3000)})),
    "no manifest": zipped(lambda stream, files: hostile.write_all(stream, {"tables/results.csv": files["tables/results.csv"]})),
    "a table less": with_manifest(lambda told: {**told, "files": {**told["files"], "tables/contact.csv": "0" * 64}}),
    "another digest": with_manifest(lambda told: {**told, "files": dict.fromkeys(told["files"], "0" * 64)}),
    "digests that are none": with_manifest(lambda told: {**told, "files": {"tables/results.csv": ["x"]}}),
    "another format": with_manifest(lambda told: {**told, "format": 2}),
    "a format that is none": with_manifest(lambda told: {**told, "format": ["<script>"]}),
    "no header": with_manifest(lambda told: {**told, "header": None}),
    "a manifest that is none": with_manifest(lambda _: "[]"),
    "a deep manifest": with_manifest(lambda _: "[" * DEEP + "]" * DEEP),
    "a large manifest": with_manifest(lambda told: {**told, "more": "x" * (archive.MOST_OF_MANIFEST + 1)}),
    **{f"a file {name!r}": with_file(name, b"x") for name in NAMES},
    "a file with a long name": with_file("cases/" + "a" * 60_000 + ".case.toml", b"x"),
}

TRACKS: dict[str, Attack] = {
    "nothing": hostile.tracks(b""),
    "a deep list": hostile.tracks(b"[" * DEEP + b"]" * DEEP),
    "no object": hostile.tracks(b"[]"),
    "not a number": hostile.tracks(b'{"format": NaN}'),
    "markup": hostile.tracks(b"<script>x</script>"),
    "many lists": hostile.tracks(b"[" + b"[]," * 1_000_000 + b"[]]"),
}

ATTACKS: dict[str, Attack] = {
    **{f"{column}: {value[:30]!r}": hostile.entry(column, value) for column, value in hostile.ENTRIES},
    **{f"header: {name}: {str(value)[:40]!r}": hostile.header(name, value) for name, value in hostile.HEADERS},
    **{f"table: {name}": attack for name, attack in TABLES.items()},
    **{f"note: {name}": attack for name, attack in NOTES.items()},
    **{f"place: {name}": attack for name, attack in PLACES.items()},
    **{f"case: {name}": attack for name, attack in CASES.items()},
    **{f"tracks: {name}": attack for name, attack in TRACKS.items()},
    **{f"zip: {name}": attack for name, attack in ZIPS.items()},
}


def files_of(paths: Sequence[Path]) -> dict[str, bytes]:
    """The files of the site of some paths."""
    return {file.path: file.content for file in build.files(catalogue.catalogued(*gathering.gathered(paths)))}


@pytest.fixture(scope="module")
def honest(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    folder = tmp_path_factory.mktemp("honest")
    runs = [made.run(), made.run(integrator="RK4"), made.ended("diverged", "not a number", case=made.CONTACT)]
    older = [{**row, "version": "3.17.0"} for row in runs]
    more = {"contact.csv": [made.contact()], "parity.csv": [made.parity()]}
    return [
        made.write_folder(folder / "older", {"results.csv": older}, made.header("2025-12-01", {"mujoco": "3.17.0"})),
        made.write_folder(folder / "newer", {"results.csv": runs, **more}),
    ]


@pytest.fixture(scope="module")
def attacks(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """All attacks, with names that are attacks as well."""
    paths = []
    for place, attack in enumerate(ATTACKS.values()):
        path = attack(tmp_path_factory.mktemp("attack"))
        paths.append(path.rename(path.with_name(f"<img src=x>\u202e{place}{path.suffix}")))
    return paths


@pytest.fixture(scope="module")
def gathered(honest: list[Path], attacks: list[Path]) -> tuple[tuple[Submission, ...], tuple[LeftOut, ...]]:
    """What is gathered of all attacks at once, before and after the honest ones."""
    half = len(attacks) // 2
    return gathering.gathered([*attacks[:half], *honest, *attacks[half:]])


@pytest.mark.parametrize("name", ATTACKS)
def test_an_attack_is_left_out_and_told(
    name: str, gathered: tuple[tuple[Submission, ...], tuple[LeftOut, ...]], attacks: list[Path]
) -> None:
    place = list(ATTACKS).index(name)
    (one,) = (one for one in gathered[1] if one.name == f"<img src=x>?{place}{attacks[place].suffix}")
    assert one.reason
    assert "is damaged" not in one.reason, "each is seen where it is read"
    assert one.reason.isprintable()
    assert len(one.reason) <= gathering.LONGEST


def test_attacks_take_no_more_memory_and_time_than_there_is(attacks: list[Path]) -> None:
    """All are read where memory ends at 4 GB, and the process after 120 s of computing: a hundredth of what they ask for."""
    prelude = "import resource; resource.setrlimit(resource.RLIMIT_AS, (1 << 32, 1 << 32)); "
    prelude += "resource.setrlimit(resource.RLIMIT_CPU, (120, 120))\n"
    code = "import sys; from pathlib import Path; from bodycheck.site.submissions import gathering\n"
    code += "found, left_out = gathering.gathered([*map(Path, sys.argv[1:])]); print(len(found), len(left_out))"
    command = [sys.executable, "-c", prelude + code, *map(str, attacks)]
    done = subprocess.run(command, capture_output=True, text=True, env={**os.environ, "OPENBLAS_NUM_THREADS": "1"}, check=False)
    assert (done.stdout, done.returncode) == (f"0 {len(ATTACKS)}\n", 0), done.stderr


def without_link(content: bytes) -> bytes:
    """A page without the link in its head to what is left out, which is there only if something is."""
    return re.sub(rb'<a href="[./]*errors\.html">Left out</a>\n', b"", content)


def test_attacks_change_no_page_but_that_of_what_is_left_out(
    gathered: tuple[tuple[Submission, ...], tuple[LeftOut, ...]], honest: list[Path]
) -> None:
    before = files_of(honest)
    after = {file.path: file.content for file in build.files(catalogue.catalogued(*gathered))}
    paths = before.keys() | after.keys()
    assert {path for path in paths if before.get(path) != without_link(after.get(path, b""))} == {links.ERRORS}
    told = after[links.ERRORS].decode()
    assert "<img" not in told
    assert "<script>" not in told
    assert "\u202e" not in told
    assert told.count('<th scope="row">') == len(ATTACKS)
