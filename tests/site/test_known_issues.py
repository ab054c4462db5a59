"""Known issues: their file has threads on the web, of engines, scenes, figures and robots that there are."""

import re
from urllib.parse import urlsplit

import pytest
from packaging.version import Version

from bodycheck.adapters import registry
from bodycheck.casefile import case as case_files
from bodycheck.reports.quantities import QUANTITIES
from bodycheck.site import known
from bodycheck.site.known import Issue
from bodycheck.studies.audit.rows import PROPERTIES
from bodycheck.studies.parity.quantities import CAUSES
from claims import records
from tests.site import submissions as make
from tests.support.wording import facts


@pytest.mark.parametrize("issue", known.issues(), ids=lambda issue: f"{issue.engine} {issue.url.rpartition('/')[2]}")
def test_the_file_has_the_form_that_pages_expect(issue: Issue) -> None:
    address = urlsplit(issue.url)
    assert (address.scheme, address.netloc) == ("https", "github.com")
    *_, kind, number = address.path.split("/")
    assert re.fullmatch({"issues": r"\d+", "pull": r"\d+", "commit": r"[0-9a-f]{8}"}[kind], number)
    assert issue.engine in registry.names()
    assert issue.title
    assert not issue.title.endswith(".")
    assert [bool(issue.scene), bool(issue.robot), bool(issue.audit)].count(True) == 1
    if issue.scene:
        assert case_files.is_shipped(issue.scene)
        assert issue.figure in QUANTITIES
    if issue.robot:
        assert bool(issue.cause) != bool(issue.status)
        assert not issue.cause or issue.cause in CAUSES
        assert issue.status in ("", "refused", "differs")
    if issue.audit:
        assert issue.audit in PROPERTIES
    for version in filter(None, (issue.since, issue.until)):
        Version(version)


@pytest.mark.parametrize("issue", known.issues(), ids=lambda issue: f"{issue.engine} {issue.url.rpartition('/')[2]}")
def test_a_claim_about_the_engine_quotes_the_thread(issue: Issue) -> None:
    of_engine = [claim for claim in records.claims().values() if claim.engine == issue.engine]
    assert [claim.name for claim in of_engine if issue.url in (page.address for page in claim.documentation)]


def test_an_issue_shows_the_last_version_that_has_it_and_the_first_that_has_not() -> None:
    errors = {"3.6.0": 2.0, "3.7.0": 2.5e-5, "3.10.0": 2.75e-5, "3.11.0": 1.5, "4.0.0": 1.25}
    sent = [
        make.submission([make.run(version=version, integrator="implicitfast", attitude_error=error)], day=f"2026-01-0{day}")
        for day, (version, error) in enumerate(errors.items(), start=1)
    ]
    issue = next(one for one in known.issues() if one.since == "3.7.0")
    found = known.evidence(make.catalogued(*sent), issue)
    assert [(one.version, facts(one.text, "attitude error", "implicitfast")) for one in found] == [
        ("3.10.0", ["attitude error", "2.75e-5", "implicitfast"]),
        ("3.11.0", ["attitude error", "1.5", "implicitfast"]),
    ]


def test_a_refusal_is_called_a_refusal() -> None:
    row = make.ended("unsupported", "MuJoCo refuses the model: mass and inertia", case="iftomm-a01")
    issue = next(one for one in known.issues() if one.scene == "iftomm-a01")
    (found,) = known.evidence(make.catalogued(make.submission([row])), issue)
    assert found.text == "refused with Euler"


def test_an_issue_of_a_robot_counts_the_rows_with_its_cause() -> None:
    rows = [
        make.parity(version="3.12.0", status="differs", quantity="joint_type", cause="mimic-ignored"),
        make.parity(version="3.12.0"),
        make.parity(version="3.13.0"),
    ]
    issue = next(one for one in known.issues() if (one.engine, one.cause) == ("mujoco", "mimic-ignored"))
    found = known.evidence(make.catalogued(make.submission({"parity.csv": rows})), issue)
    assert [(one.version, facts(one.text, "mimic-ignored", "none")) for one in found] == [
        ("3.12.0", ["mimic-ignored", "1"]),
        ("3.13.0", ["mimic-ignored", "none"]),
    ]


def test_an_issue_without_a_number_has_no_evidence() -> None:
    catalogue = make.catalogued(make.submission([make.run(case=make.CONTACT)]))
    assert [known.evidence(catalogue, issue) for issue in known.issues()] == [()] * len(known.issues())
