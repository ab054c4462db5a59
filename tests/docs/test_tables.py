"""Pages have the tables of the source code and the sentences of the claims."""

import runpy
from pathlib import Path
from typing import Any

import pytest

from tests.support import ROOT


@pytest.fixture(scope="module")
def script() -> dict[str, Any]:
    return runpy.run_path(str(ROOT / "docs" / "tables.py"))


def test_pages_are_what_the_script_writes(script: dict[str, Any]) -> None:
    pages = script["pages"]()
    assert {ROOT / "docs" / name for name in ("cases.md", "claims.md", "driven.md")} <= pages.keys()
    stale = [page.relative_to(ROOT) for page, text in pages.items() if page.read_text("utf-8") != text]
    assert stale == [], "renew them with: python docs/tables.py"


def test_a_page_without_the_places_of_the_tables_is_refused(script: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match="no place for the table 'Axes'"):
        script["renewed"]("a page", {"Axes": "| a table |"})


def test_sentences_of_claims_are_inserted_into_a_page(script: dict[str, Any]) -> None:
    page = "a\n<!-- claims: mujoco/flip -->\nold\n<!-- end of claims -->\nb\n"
    renewed = script["with_claims"](page, ROOT / "docs" / "page.md")
    assert "2.1" in renewed
    assert "old" not in renewed
    assert script["with_claims"](renewed, ROOT / "docs" / "page.md") == renewed


def test_the_advice_has_the_numbers_of_the_submissions() -> None:
    advice = runpy.run_path(str(ROOT / "docs" / "advice.py"))
    page = (ROOT / "docs" / "howto" / "choose-a-method.md").read_text("utf-8")
    assert "\n".join(advice["table"](advice["rows"]())) in page, "renew it by: python docs/advice.py"


def test_the_advice_counts_scenes_and_prefers_the_cheaper_of_equal_methods() -> None:
    advice = runpy.run_path(str(ROOT / "docs" / "advice.py"))
    methods = {
        "default": ({"a": 0.1, "b": 1e-3}, [1.0, 1.0]),
        "dear": ({"a": 1e-9, "b": 1e-9}, [3.0, 3.0]),
        "cheap": ({"a": 1e-4, "b": 1e-4}, [2.0, 2.0]),
        "wrong": ({"a": 2e-3, "c": 1e-3}, [1.0, 1.0]),
    }
    assert advice["cell"](methods) == "`cheap` 2, default 1 of 3"
    assert advice["cell"](methods | {"default": ({"a": 0.0, "b": 0.0, "c": 0.0}, [1.0])}) == "default 3 of 3"


def test_mistakes_that_the_advice_leaves_out_are_those_of_the_adapter() -> None:
    advice = runpy.run_path(str(ROOT / "docs" / "advice.py"))
    engine = pytest.importorskip("bodycheck.adapters.pinocchio.engine", reason="Pinocchio is not installed").engine
    assert set(advice["MISTAKES"]) == {each.name for each in engine.integrators if each.demonstrates}


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("<!-- claims: mujoco/nothing -->\n<!-- end of claims -->\n", "there is no claim 'mujoco/nothing'"),
        ("<!-- claims: mujoco/flip -->\n", "1 lines are"),
        ("<!-- end of claims -->\n", "1 lines are"),
        ("<!-- claims: mujoco/flip -->\n<!-- claims: mujoco/flip -->\n<!-- end of claims -->\n", "2 lines are"),
    ],
)
def test_a_place_of_claims_that_is_wrong_is_refused(script: dict[str, Any], text: str, fault: str) -> None:
    with pytest.raises(ValueError, match=fault):
        script["with_claims"](text, Path("page.md"))


def test_links_of_a_sentence_lead_from_the_page(script: dict[str, Any]) -> None:
    linked = script["_with_links"]("[a](docs/contacts.md#rest), [b](https://b)", ROOT / "docs" / "start" / "findings.md")
    assert linked == "[a](../contacts.md#rest), [b](https://b)"
