"""What a CASE of the command line stands for: a name, a path, a folder or a pattern."""

import os
from pathlib import Path

import pytest

from bodycheck.casefile import finding
from bodycheck.casefile.finding import named
from bodycheck.errors import BadInput

SHIPPED = ("curling-brick", "curling-disk", "free-brick")

#: Case files of a repository, what is no case file, and what installed packages brought along.
FILES = ("b.case.toml", "sub/a.case.toml", "sub/deep/c.case.toml", "sub/notes.toml", "sub/deep/.hidden.case.toml")
OTHERS = (".venv/d.case.toml", "env/pyvenv.cfg", "env/lib/e.case.toml", "build/f.case.toml", "node_modules/g.case.toml")


@pytest.fixture
def repository(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A repository of someone's own, in which the test works."""
    for name in (*FILES, *OTHERS):
        path = tmp_path / "repository" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch()
    monkeypatch.chdir(tmp_path / "repository")
    return tmp_path / "repository"


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (("free-brick",), ["free-brick"]),
        (("sub/a.case.toml",), ["sub/a.case.toml"]),
        (("sub/notes.toml",), ["sub/notes.toml"]),
        ((".",), ["b.case.toml", "sub/a.case.toml", "sub/deep/.hidden.case.toml", "sub/deep/c.case.toml"]),
        (("sub/deep", "."), ["sub/deep/.hidden.case.toml", "sub/deep/c.case.toml", "b.case.toml", "sub/a.case.toml"]),
        (("./sub/a.case.toml", "sub/a.case.toml", "sub/../sub/a.case.toml"), ["./sub/a.case.toml"]),
        (("*.case.toml",), ["b.case.toml"]),
        (("**/*.case.toml",), ["b.case.toml", "sub/a.case.toml", "sub/deep/c.case.toml"]),
        (("s*/[ab].case.toml",), ["sub/a.case.toml"]),
        (("*/deep",), ["sub/deep/.hidden.case.toml", "sub/deep/c.case.toml"]),
        (("curling-*",), ["curling-brick", "curling-disk"]),
        (("nobody", "nowhere/x.case.toml"), ["nobody", "nowhere/x.case.toml"]),
        (("x" * 5000,), ["x" * 5000]),
    ],
)
def test_what_an_argument_stands_for(repository: Path, arguments: tuple[str, ...], expected: list[str]) -> None:
    found = named(arguments, SHIPPED)
    assert list(found) == expected
    assert named(found, SHIPPED) == found


def test_a_pattern_may_be_absolute(repository: Path) -> None:
    assert named((f"{repository}/s*/a*",), SHIPPED) == (str(repository / "sub/a.case.toml"),)


def test_a_path_with_the_marks_of_a_pattern_is_a_path(repository: Path) -> None:
    (repository / "[ab].case.toml").touch()
    assert named(("[ab].case.toml",), SHIPPED) == ("[ab].case.toml",)


@pytest.mark.parametrize("argument", ["empty", "*.nothing", "**/x*.case.toml", "env*", "free-brick.*"])
def test_nothing_found_is_one_sentence(repository: Path, argument: str) -> None:
    (repository / "empty").mkdir()
    with pytest.raises(BadInput, match=r"^[^\n]*(there is no case file|no case file .* matches this pattern)[^\n]*$"):
        named((argument,), SHIPPED)


def test_links_lead_nowhere_else(repository: Path) -> None:
    """Folders that are links are not entered, and a link to a file out of the folder is refused rather than left out."""
    (repository / "sub/round").symlink_to(repository)
    (repository / "sub/inside.case.toml").symlink_to(repository / "sub/deep/c.case.toml")
    found = [Path(name).resolve().name for name in named(("sub",), SHIPPED)]
    assert found == ["a.case.toml", ".hidden.case.toml", "c.case.toml"]
    (repository / "sub/outside.case.toml").symlink_to("/etc/hostname")
    with pytest.raises(BadInput, match=r"^sub/outside.case.toml: is a link that leads out of sub; "):
        named(("sub",), SHIPPED)


def test_huge_trees_are_bounded(repository: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(finding, "MAX_CASES", 3)
    with pytest.raises(BadInput, match="stands for more than 3 case files"):
        named((".",), SHIPPED)
    monkeypatch.setattr(finding, "MAX_ENTRIES", 8)
    with pytest.raises(BadInput, match="has more than 8 files and folders"):
        named((".",), SHIPPED)
    with pytest.raises(BadInput, match="has more than 8 files and folders"):
        named(("**/*",), SHIPPED)


@pytest.mark.skipif(os.geteuid() == 0, reason="root reads every folder")
def test_a_folder_that_cannot_be_read_is_bad_input(repository: Path) -> None:
    (repository / "sub/deep").chmod(0)
    with pytest.raises(BadInput, match="sub/deep: cannot be read: "):
        named((".",), SHIPPED)
