"""What `bodycheck submit` packs, what it removes, and what it refuses."""

import json
import zipfile
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bodycheck.errors import BadInput
from bodycheck.results.origin import BESIDE
from bodycheck.site.command import submit
from bodycheck.site.submissions import archive, contents, gathering, packing, personal
from bodycheck.site.submissions.personal import Cleaning
from bodycheck.site.submissions.texts import shown, text
from tests.site import submissions as made

#: What stands in results that were made by Jane Roe on her machine, in places where commands put such.
SECRETS = ("jroe", "Jane Roe", "roe-laptop", "@example.org", "/home", "secret-project", "Users")

OWN = """format = 1
name = "my-case"
title = "A brick"
source = "Jane Roe <jane@example.org>, see /home/jroe/secret-project/notes.txt"
# measured on roe-laptop by jroe
[body]
shape = "none"
mass = 1.0
inertia = [1.0, 2.0, 3.0]
[initial]
angular_velocity = [1.0, 2.0, 3.0]
[run]
duration = 1.0
samples = 11
"""


@pytest.fixture
def janes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(personal, "own_names", lambda: ("jroe", "roe-laptop", "Jane Roe"))
    told = made.header(
        command=[
            "/home/jroe/bin/bodycheck",
            "run",
            "/home/jroe/secret-project/my-case.case.toml",
            "--out",
            "/home/jroe/out",
        ],
        missing={"dart": "no module in /home/jroe/venv/lib/python3.11/site-packages/dartpy.so, ask jane@example.org"},
        environments={"mujoco": {"own @ file:///home/jroe/secret-project/own.whl": "0" * 64}},
    )
    rows = [
        made.run(),
        made.ended("crashed", "C:\\Users\\Jane Roe\\secret-project\\x.dll failed on roe-laptop\tat 1 m/s", case="my-case"),
        made.ended("diverged", "see ~jroe/secret-project/log or /home/jroe", case=made.CONTACT),
    ]
    return made.write_folder(tmp_path / "secret-project", {"results.csv": rows}, told, {"my-case": OWN})


def test_nothing_personal_is_packed(janes: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "packed.zip"
    assert submit(janes, out=out) == 0
    with zipfile.ZipFile(out) as stream:
        everything = "".join(f"{name}\n{stream.read(name).decode()}" for name in stream.namelist())
    assert [secret for secret in SECRETS if secret in everything] == []
    (found,), left_out = gathering.gathered([out])
    assert not left_out
    assert found.header.command == ["bodycheck", "run", "my-case.case.toml"]
    assert found.header.missing == {"dart": "no module in dartpy.so, ask (e-mail address)"}
    reasons = [row["reason"] for row in found.tables["results.csv"]]
    assert reasons == [None, "x.dll failed on (name) at 1 m/s", "see log or ~"]
    assert 'source = "(name) <(e-mail address)>, see notes.txt"' in found.cases["my-case"]
    assert "mass = 1.0" in found.cases["my-case"]
    told = capsys.readouterr().err
    assert "results.csv: 3 rows" in told
    assert "of which with their whole text in public: my-case\n" in told
    assert "engines: mujoco 4.0.0" in told
    assert "e-mail addresses" in told
    assert "names of the machine or its user" in told


def test_the_names_of_parts_of_a_robot_are_no_paths(tmp_path: Path) -> None:
    folder = made.write_folder(tmp_path / "parity", {"parity.csv": [made.parity(subject="/arm/left/link")]})
    assert packing.packed(folder).submission.tables["parity.csv"][0]["subject"] == "/arm/left/link"


@pytest.mark.parametrize(
    ("name", "public"),
    [
        ("e\u0301", r"e\u0301"),
        ("\u05d0\u05d1", r"\u05d0\u05d1"),
        ("<script>x</script>", r"\x3cscript>x\x3c/script>"),
        ("a javascript : b", r"a javascript \x3a b"),
        ("jane@example.org", "(e-mail address)"),
        ("plain ü", "plain ü"),
    ],
)
def test_names_of_parts_of_a_robot_are_escaped(tmp_path: Path, name: str, public: str) -> None:
    row = made.parity(subject=name, model=name, engine_value=f"of {name}", status="differs")
    folder = made.write_folder(tmp_path / "parity", {"parity.csv": [row, made.parity()]})
    packed = packing.packed(folder)
    escaped, plain = packed.submission.tables["parity.csv"]
    assert (escaped["subject"], escaped["model"], plain["subject"]) == (public, public, "link1")
    assert text(str(escaped["engine_value"]))
    assert (packing.ESCAPED in packed.removed) == ("\\" in public)


def test_a_submission_says_the_same_as_its_folder(tmp_path: Path) -> None:
    folder = made.write_folder(tmp_path / "run", {"results.csv": [made.run(), made.exact(case=made.MECHANISM)]})
    assert packing.packed(folder).submission.key == gathering.read(folder).key
    assert packing.packed(folder).content == packing.packed(folder).content


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "2.125",
            "4.125",
            "results.csv:2: attitude_error: read 4.125; allowed: at most 3.14159265359 in intermediate-axis-flip",
        ),
        ("0.25", "-0.25", r"results.csv:2: position_error: read -0.25; allowed: numbers that are not negative"),
        (",ok,", ",good,", r"results.csv:2: status: read 'good'; allowed: crashed, diverged, ok, timeout, unsupported"),
        (
            "4.0.0,Euler",
            "4.0.1,Euler",
            "results.csv:2: version: read '4.0.1'; allowed: 4.0.0, which the header has for mujoco",
        ),
        ("0.002", "two", r"results.csv:2: timestep: 'two' is not a finite number"),
        ("mujoco", "MuJoCo", r"results.csv:2: engine: 'MuJoCo' is not the name of an engine"),
        ("status", "state", r"results.csv:1: has a column 'state'; allowed: set, case, engine"),
    ],
)
def test_a_fault_is_one_clear_error_and_nothing_is_written(old: str, new: str, message: str, tmp_path: Path) -> None:
    folder = made.write_folder(tmp_path / "run", {"results.csv": [made.run()]})
    path = folder / "results.csv"
    path.write_text(path.read_text().replace(old, new, 1))
    with pytest.raises(BadInput, match=message) as caught:
        submit(folder, out=tmp_path / "out.zip")
    assert str(caught.value).startswith(str(folder))
    assert not (tmp_path / "out.zip").exists()


def test_a_folder_of_a_study_without_pages_is_refused_by_its_name(tmp_path: Path) -> None:
    (tmp_path / "extremes.csv").write_text("case\n")
    with pytest.raises(BadInput, match=r"has extremes.csv, which the site has no pages for; allowed: results.csv, "):
        submit(tmp_path, out=tmp_path / "out.zip")


@pytest.mark.parametrize(("folder", "out"), [("missing", "out.zip"), (".", "out.tar")])
def test_bad_usage(folder: str, out: str, tmp_path: Path) -> None:
    with pytest.raises(BadInput):
        submit(tmp_path / folder, out=tmp_path / out)
    assert not list(tmp_path.iterdir())


def test_tables_of_two_commands_are_refused(tmp_path: Path) -> None:
    folder = made.write_folder(tmp_path / "run", {"results.csv": [made.run()], "contact.csv": [made.contact()]})
    beside = folder / f"contact.csv{BESIDE}"
    told = json.loads(beside.read_text())
    told["notes"][0]["started"] = "2025-01-01T00:00:00+00:00"
    beside.write_text(json.dumps(told))
    with pytest.raises(BadInput, match=r"contact.csv: has the results of another command than results.csv"):
        submit(folder, out=tmp_path / "out.zip")


#: Texts of parts that paths, addresses and names are made of.
WORDS = ["/", "\\", "home", "Users", "~", "@", ".", "C:", "file://", "jroe", "a", "org", "-", ":", "(", "1"]
PARTS = st.lists(st.sampled_from([*WORDS, '"', " ", "\n"]), max_size=30).map("".join)


@given(PARTS | st.text(max_size=60))
def test_what_was_cleaned_is_clean(value: str) -> None:
    cleaned = Cleaning(("jroe",)).text(value)
    assert personal.first(cleaned) is None
    assert Cleaning(("jroe",)).text(cleaned) == cleaned


@given(st.text(max_size=200))
def test_a_cleaned_text_can_stand_on_a_page_unless_it_has_markup(value: str) -> None:
    made_shown = shown(Cleaning().text(value))
    if "<" not in made_shown and "javascript" not in made_shown.lower():
        assert text(made_shown) == made_shown


NAMES = "mujoco@3.17.0 mujoco@4.0.0.dev5 m/s rad/s kg·m² 1/2 <body/> ~0.1 https://example.org/a/b"


@pytest.mark.parametrize("name", NAMES.split())
def test_names_of_engines_and_units_stay(name: str) -> None:
    assert Cleaning().text(f"of {name} and more") == f"of {name} and more"


def test_a_zip_file_with_personal_parts_is_left_out(tmp_path: Path) -> None:
    """Which another program than `bodycheck submit` made."""
    rows = [made.run(), made.ended("crashed", "at home", case=made.CONTACT)]
    folder = made.write_folder(tmp_path / "run", {"results.csv": rows})
    packed = packing.contents(folder)
    leaking = packed.files["tables/results.csv"].replace(b"at home", b"in /home/jroe/x")
    other = contents.Contents(packed.header, {**packed.files, "tables/results.csv": leaking})
    (tmp_path / "other.zip").write_bytes(archive.zipped(other))
    found, (left_out,) = gathering.gathered([tmp_path / "other.zip"])
    assert not found
    assert "the path of a home folder" in left_out.reason
