"""Citations: every engine and every publication that a shipped case names has an entry, and every entry is BibTeX."""

import json
import re
from pathlib import Path

import pytest

from bodycheck.adapters import registry
from bodycheck.casefile.authoring import template
from bodycheck.casefile.case import load, shipped
from bodycheck.commands import cite
from bodycheck.errors import BadInput
from tests.support import ROOT
from tests.support.commands import bodycheck

#: Words with which the source of a shipped case begins that names nothing published, or nothing whose title is known.
UNPUBLISHED = (
    "closed form", "Closed form", "bodycheck", "statics", "rolling", "momentum", "free fall", "centripetal",
    "Made for bodycheck",
    "Coulomb friction", "Euler's equations", "Equations of motion", "straight motion", "steady circle", "no law",
    "A rod slips", "the specific force", "MuJoCo, test", "M. Arnold", "Chaplygin",
)  # fmt: skip


def braces_match(entry: str) -> bool:
    """Whether every brace that opens closes, and none before. BibTeX counts braces with a backslash before them too."""
    depth = 0
    for character in entry:
        depth += {"{": 1, "}": -1}.get(character, 0)
        if depth < 0:
            return False
    return depth == 0


def fields(entry: str) -> dict[str, str]:
    """The fields of an entry, in braces. Raises ValueError if it is no entry."""
    if not (whole := re.fullmatch(r"@(\w+)\{([\w.@-]+),\n(.*)\}", entry, re.DOTALL)) or not braces_match(entry):
        raise ValueError(entry)
    lines = whole[3].splitlines()
    parts = [re.fullmatch(r"  (\w+) = \{(.*)\},", line) for line in lines]
    if not all(parts):
        raise ValueError(entry)
    return {part[1]: part[2] for part in parts if part is not None}


@pytest.mark.parametrize("name", sorted(path.name for path in (ROOT / "adapters").iterdir() if (path / "engine.py").exists()))
def test_every_engine_has_an_entry_with_its_version(name: str) -> None:
    entry = fields(cite._of_engine(name, "1.2.3"))
    assert {"author", "title"} <= set(entry)
    assert entry["note"] == "Version 1.2.3"
    assert f"{{{name}," in cite._of_engine(name, None)


def test_an_engine_of_another_package_has_its_name() -> None:
    assert fields(cite._of_engine("my_engine", "1_0")) == {"title": r"{my\_engine}", "note": r"Version 1\_0"}


def test_every_publication_is_cited_by_a_shipped_case_and_every_source_is_known() -> None:
    publications = cite._publications()
    sources = {load(name).source for name in shipped()}
    for key, (words, entry) in publications.items():
        assert any(words in source for source in sources), key
        assert "title" in fields(entry)
        assert f"{{{key}," in entry
    for source in sources:
        assert any(words in source for words, _ in publications.values()) or source.startswith(UNPUBLISHED), source


def test_the_command_cites_bodycheck_engines_and_sources() -> None:
    done = bodycheck("cite", "mujoco", "drake@1.51.0", "--case", "free-brick", "--case", "sliding-brick", "--json")
    listed = json.loads(done.stdout)
    version = listed[1]["name"].removeprefix("mujoco@")
    assert [(one["kind"], one["name"]) for one in listed] == [
        ("bodycheck", "bodycheck"),
        ("engine", f"mujoco@{version}"),
        ("engine", "drake@1.51.0"),
        ("source", "gans2013"),
    ]
    assert all(fields(one["bibtex"]) for one in listed)
    assert fields(listed[1]["bibtex"])["note"] == f"Version {version}"


def test_the_source_of_another_case_is_cited_in_its_own_words(tmp_path: Path) -> None:
    """A stranger's text is no command of LaTeX."""
    source = r"100 % \input{secret} & _x_ }, note = {x $y$ #1 ~ ^^41 {"
    text = template().replace('source = ""', f"source = '{source}'").replace('name = "my-case"', 'name = "thrown"')
    (tmp_path / "thrown.case.toml").write_text(text, "utf-8")
    done = bodycheck("cite", "mujoco", "--case", "thrown.case.toml", folder=tmp_path)
    entry = done.stdout.split("\n\n")[-1].strip()
    closed, opened = r"{\textbraceright}", r"{\textbraceleft}"
    assert fields(entry)["note"] == (
        rf"Source of the case: 100 \% {{\textbackslash}}input{opened}secret{closed} \& \_x\_ {closed}, note = {opened}x "
        rf"\$y\$ \#1 {{\textasciitilde}} {{\textasciicircum}}{{\textasciicircum}}41 {opened}"
    )


@pytest.mark.parametrize(
    "name", ["mujoco@\x1b[2J", "\x1b[31mx", "../../etc/passwd", "mujoco@1.0}, note = {x", "mujoco@1\n2", "x" * 100_000, "", "@"]
)
def test_the_name_of_an_engine_from_a_stranger_is_bad_input(name: str) -> None:
    with pytest.raises(BadInput) as refused:
        list(cite._of_engines([name]))
    assert str(refused.value).isprintable()
    assert len(str(refused.value)) < 300


def test_an_unknown_engine_is_bad_input() -> None:
    done = bodycheck("cite", "bullit")
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith("cite bullit: there is no engine 'bullit'; allowed: ")
    assert all(name in done.stderr for name in registry.names())
