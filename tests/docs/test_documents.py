"""The documents: every link, path and option in them exists, and their examples run."""

import functools
import re
import tomllib
from pathlib import Path

import pytest

from bodycheck.casefile.case import load
from bodycheck.commands.command_line import app
from tests.support import ROOT
from tests.support.documents import blocks

DOCUMENTS = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")])

#: Folders of the repository; a document that names a file in one of them names a file that exists.
FOLDERS = (
    *("adapters", "benchmarks", "bodycheck", "cases", "claims", "distribution", "docs", "reference", "reports", "submissions"),
    "tests",
)

#: Pages for those who change bodycheck. They name files and folders from some room on, such as `pool.py`, and modules.
FOR_DEVELOPERS = ("CONTRIBUTING.md", "docs/architecture.md", "docs/decisions.md", "docs/howto/add-a-joint-type.md")

#: Files that bodycheck or its build writes.
WRITTEN = ("dist/",)

#: Documents with wider lines of code: tables of proofs and what scripts print.
WIDE = ("docs/proved.md", "docs/truth.md", "docs/claims.md", "docs/chapter-figures.md", "CHANGELOG.md")

#: The words for numbers.
NUMBERS = {9: "nine", 10: "ten", 11: "eleven", 12: "twelve", 13: "thirteen", 14: "fourteen", 15: "fifteen"}

#: Names in documents that stand for names which readers choose.
PLACEHOLDERS = ("NAME", "ENGINE", "my-case", "thrown-phone")


@functools.cache
def options(command: str) -> frozenset[str]:
    """The options of a command of bodycheck."""
    return frozenset(name for argument in app[command].assemble_argument_collection() for name in argument.names)


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_links_lead_to_files_and_headings(document: Path) -> None:
    for link in re.findall(r"\]\(([^)\s]+)\)", document.read_text(encoding="utf-8")):
        if "://" in link:
            continue
        place, _, heading = link.partition("#")
        target = document.parent / place if place else document
        assert target.exists(), link
        if heading:
            titles = re.findall(r"^#+ (.*)$", target.read_text(encoding="utf-8"), re.MULTILINE)
            assert heading in {re.sub(r"[^\w -]", "", title.lower()).replace(" ", "-") for title in titles}, link


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_paths_name_files(document: Path) -> None:
    if document.name == "CHANGELOG.md":
        pytest.skip("it also names files of earlier versions")
    text = document.read_text(encoding="utf-8")
    for path in re.findall(rf"(?<=[\s`])(?:{'|'.join(FOLDERS)})/[\w/-]*(?:\.\w+)*", text):
        # Tables of contents have pages without the ending, from their own folder on.
        there = (ROOT / path).exists() or (document.parent / f"{path}.md").exists()
        assert there or any(word in path for word in PLACEHOLDERS), path


@functools.cache
def files() -> tuple[str, ...]:
    """The paths of all files and folders of the repository from its root on, the latter with a slash at their end."""
    found = [*ROOT.glob("*.py"), *(ROOT / folder for folder in FOLDERS)]
    found += [path for folder in FOLDERS for path in (ROOT / folder).rglob("*") if "__pycache__" not in path.parts]
    return tuple(f"/{path.relative_to(ROOT).as_posix()}{'/' * path.is_dir()}" for path in found)


@pytest.mark.parametrize("name", FOR_DEVELOPERS)
def test_files_and_modules_of_pages_for_developers_exist(name: str) -> None:
    text = (ROOT / name).read_text("utf-8")
    named = set(re.findall(r"`((?:[\w-]+/)*(?:[\w-]+\.py|[\w-]+/))`", text)) - set(WRITTEN)
    assert len(named) > 5
    rooms = [folder.name for folder in (ROOT / "bodycheck").iterdir() if folder.is_dir()]
    modules = re.findall(rf"`((?:{'|'.join(rooms)})(?:\.[a-z_]+)+)`", text)
    named |= {f"{module.replace('.', '/')}.py" for module in modules if not module.endswith((".py", ".json", ".parquet"))}
    missing = [path for path in sorted(named) if not any(known.endswith(f"/{path}") for known in files())]
    assert [path for path in missing if not any(word in path for word in PLACEHOLDERS)] == []


def code_lines(document: Path) -> list[str]:
    """The lines of the blocks of code of a document, without those of Sphinx."""
    found, fence, is_code = [], "", False
    for line in document.read_text("utf-8").splitlines():
        if not fence:
            opened = re.match(r"\s*(`{3,}|:{3,})\{?([\w-]*)", line)
            if opened and "`" in opened[1]:
                fence, is_code = opened[1], not re.match(r"\s*`+\{(?!code)", line)
        elif line.strip() == fence:
            fence = ""
        elif is_code:
            found.append(line)
    return found


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_lines_of_code_have_80_columns(document: Path) -> None:
    """So that they fit into the column of the built page at 1280 pixels, and into a terminal."""
    if document.relative_to(ROOT).as_posix() not in WIDE:
        assert [line for line in code_lines(document) if len(line) > 80] == []


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_commands_have_the_options_that_documents_name(document: Path) -> None:
    commands = {name for name in app if not name.startswith("-")}
    # Code within a paragraph may go on in the next line.
    text = re.sub(r"(?<!`)`[^`]+`", lambda code: code[0].replace("\n", " "), document.read_text(encoding="utf-8"))
    for command, rest in re.findall(r"bodycheck (\w+)((?: [^`\n#;|]*)?)", text):
        if command in commands:
            for option in re.findall(r"(?<![\w-])--[a-z][a-z-]*", rest):
                assert option in options(command), f"bodycheck {command} {option}"


#: The page that says in short how bodycheck is used.
USE = ROOT / "docs" / "start" / "use.md"


def test_the_case_of_the_page_on_use_is_valid(tmp_path: Path) -> None:
    (text,) = blocks(USE, "toml")
    (tmp_path / "my-case.case.toml").write_text(text, encoding="utf-8")
    assert load(tmp_path / "my-case.case.toml").name == "my-case"


def test_the_mechanisms_of_the_guide_to_cases_are_valid(tmp_path: Path) -> None:
    """The example of a cart and a pole, at rest also with the loop, and the example with a model."""
    examples = [text for text in blocks(ROOT / "docs" / "cases.md", "toml") if text.startswith("format = 2\n")]
    (loop,) = (text for text in blocks(ROOT / "docs" / "cases.md", "toml") if text.startswith("[[loops]]\n"))
    inertia = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    ends = '<parent link="base"/><child link="upper"/>'
    (tmp_path / "arm.urdf").write_text(
        f'<robot name="arm"><link name="base"/><link name="upper">{inertia}</link>'
        f'<joint name="shoulder" type="continuous">{ends}</joint></robot>'
    )
    for place, text in enumerate(examples):
        path = tmp_path / f"{place}.case.toml"
        path.write_text(text, encoding="utf-8")
        assert load(path).name in ("cart-pole", "arm")
    still = examples[0].replace("velocity = 0.5", "velocity = 0.0")
    assert still != examples[0]
    path.write_text(still + loop, encoding="utf-8")
    assert load(path).name == "cart-pole"


def test_the_python_of_the_page_on_use_runs(capsys: pytest.CaptureFixture[str]) -> None:
    (code,) = blocks(USE, "python")
    exec(code, {})
    # The page says 17.3 m, three digits.
    assert float(capsys.readouterr().out) == pytest.approx(17.3, abs=0.05)


def test_the_page_on_use_names_every_command() -> None:
    named = re.findall(r"^    bodycheck (\w+)", USE.read_text(encoding="utf-8"), re.MULTILINE)
    assert sorted(named) == sorted(name for name in app if not name.startswith("-"))


def test_the_readme_is_one_screen() -> None:
    """Lines of 80 columns, of which a browser shows some 60 at once beside the picture."""
    lines = (ROOT / "README.md").read_text(encoding="utf-8").splitlines()
    assert len(lines) <= 70
    assert max(map(len, lines)) <= 80
    pictures = re.findall(r"(?:src|srcset)=\"([^\"]+)\"", "\n".join(lines))
    assert len(pictures) == 2  # light and dark
    assert all((ROOT / picture).exists() for picture in pictures)


def test_the_page_on_installation_names_every_extra() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    text = (ROOT / "docs" / "start" / "install.md").read_text(encoding="utf-8")
    named = set(re.findall(r"^\| `(\w+)` \|", text, re.MULTILINE))
    # Those of development are none of a user's.
    assert named == project["optional-dependencies"].keys() - {"docs", "test", "lint"}


def test_numbers_of_engines_are_those_of_the_adapters_and_of_the_table() -> None:
    """`docs/engines.md` lists the engines that are installed on request, and `docs/robots.md` those that read the robots."""
    names = ("README.md", "docs/engines.md", "docs/robots.md", "docs/start/install.md")
    text = {name: (ROOT / name).read_text("utf-8") for name in names}
    installable = {path.parent.name for path in (ROOT / "adapters").glob("*/__init__.py")} - {"mujoco", "pinocchio"}
    assert set(re.findall(r"^\| `(\w+)` \|", text["docs/engines.md"], re.MULTILINE)) == installable
    readme = " ".join(text["README.md"].split())
    assert f"MuJoCo, Pinocchio, and {NUMBERS[len(installable)]} more that it can install" in readme
    assert f"one of {NUMBERS[len(installable)]} further engines" in text["docs/start/install.md"]
    readers = re.findall(r"^\| \w+ [\d.]+( \| \d+){5} \|$", text["docs/robots.md"], re.MULTILINE)
    guide = (ROOT / "docs" / "howto" / "check-a-robot.md").read_text("utf-8")
    assert f"compares {NUMBERS[len(readers)]} engines on 69 real robots" in guide
