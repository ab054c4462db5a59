"""Numbers of engines on the first pages come from records of claims."""

import re
from collections.abc import Iterator

import pytest

from bodycheck.adapters import registry
from tests.support import ROOT

#: The pages.
PAGES = ("README.md", "docs/start/findings.md")

#: Beginnings of passages that name an engine and have a number, but claim nothing about the engine.
EXCEPTIONS = (
    "The numbers are for MuJoCo 4.0.0",  # the releases that are measured
    "This command installs MuJoCo 3.2.0 to 4.0.0",  # what a command does
    "at 2 ms, the default time step of MuJoCo",  # a scene
    "on a ramp at 0.99 of the limiting slope",  # a scene
)

#: Names of engines in texts, besides their names in bodycheck.
NAMES = ("Bullet", "PhysX", *(name.replace("_", "[ _]") for name in registry.names()))
ENGINE = re.compile(rf"(?<![a-z])({'|'.join(NAMES)})(?![a-z])", re.IGNORECASE)


def passages(text: str) -> Iterator[str]:
    """Yield the paragraphs, list items and rows of tables of a page, without what claims and code blocks have.

    Code within a passage, such as a command or an option, and the target of a link are left out.
    """
    text = re.sub(r"^<!-- claims: .*? -->\n.*?^<!-- end of claims -->$", "", text, flags=re.MULTILINE | re.DOTALL)
    text = re.sub(r"^```.*?^```$|^(    [^\n]*\n)+", "", text, flags=re.MULTILINE | re.DOTALL)
    text = re.sub(r"(`[^`]*`)|(?<=\])\([^)]*\)", "", text)
    for block in re.split(r"\n\s*\n|\n(?=[-|] ?)", text):
        yield " ".join(block.split())


def without_record(text: str) -> list[str]:
    """Return the passages of a page that have the name of an engine and a number, but neither a record nor an exception."""
    suspects = [passage for passage in passages(text) if ENGINE.search(passage) and re.search(r"\d", passage)]
    return [passage for passage in suspects if not any(exception in passage for exception in EXCEPTIONS)]


@pytest.mark.parametrize("page", PAGES)
def test_numbers_of_engines_have_a_record(page: str) -> None:
    assert without_record((ROOT / page).read_text("utf-8")) == [], "write a record in the folder claims"


def test_exceptions_are_few_and_needed() -> None:
    assert len(EXCEPTIONS) <= 20
    every = [passage for page in PAGES for passage in passages((ROOT / page).read_text("utf-8"))]
    assert [exception for exception in EXCEPTIONS if not any(exception in passage for passage in every)] == []


@pytest.mark.parametrize(
    "text",
    [
        "MuJoCo is off by\n2 rad.\n",
        "a\n\n- mujoco warp creeps by 3 m\n",
        "| method | m |\n| --- | --- |\n| Pinocchio | 218 |\n",
        "<!-- claims: a -->\nx\n<!-- end of claims -->\nDrake: 5\n<!-- claims: a -->\nx\n<!-- end of claims -->\n",
        "PhysX sleeps at 0.001 m/s (`a command`).\n",
    ],
)
def test_a_number_of_an_engine_without_a_record_is_seen(text: str) -> None:
    assert len(without_record(text)) == 1


@pytest.mark.parametrize(
    "text",
    [
        "<!-- claims: a -->\nMuJoCo: 2 rad\n<!-- end of claims -->\n",
        "a\n\n    bodycheck run a --engine mujoco@4.0.0\n\nb\n",
        "MuJoCo, as `bodycheck releases mujoco 3.17.0 4.0.0` shows.\n",
        "[MuJoCo](docs/page-2.md) and others.\n",
        "MuJoCo is an engine.\n\nThere are 2.\n",
    ],
)
def test_other_passages_need_no_record(text: str) -> None:
    assert without_record(text) == []
