"""Certificates belong to the shipped cases as they are, and the page of proofs has their table."""

import runpy

from bodycheck.casefile.case import load, parse, shipped
from bodycheck.running.certificates import certificate_of, certificates, word_of
from tests.support import ROOT
from tests.support.cases import a_case


def test_every_shipped_case_has_a_certificate_of_its_content() -> None:
    stale = [name for name in shipped() if certificate_of(load(name)) is None]
    assert stale == [], "renew them with: python docs/proved.py --changed"
    assert sorted(certificates()) == list(shipped())


def test_the_page_has_the_table_of_the_certificates() -> None:
    page = (ROOT / "docs" / "proved.md").read_text("utf-8")
    table = "\n".join(runpy.run_path(str(ROOT / "docs" / "proved.py"))["table"](certificates()))
    assert table in page, "renew it with: python docs/proved.py --table"
    assert " in part" not in table  # otherwise the page has to say so


def test_a_case_of_other_content_has_no_certificate() -> None:
    case = parse(a_case("free-brick"), "free-brick")
    assert certificate_of(case) is None
    assert word_of(case, compared=True) == "cross-checked"
    assert word_of(case, compared=False) == "estimated"
    assert word_of(load("free-brick"), compared=False) == "enclosed"
