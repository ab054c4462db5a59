"""The vocabulary of verdicts covers what files have, and says it in the same way everywhere."""

from collections.abc import Mapping
from typing import Any, get_args

import pytest

from bodycheck.results import verdicts
from bodycheck.results.verdicts import Word
from bodycheck.site import engine_facts
from bodycheck.studies.audit import rows as audit
from bodycheck.studies.contact.rows import ContactRow, lines
from bodycheck.studies.parity import quantities as parity
from bodycheck.studies.parity.page import SIGNS
from tests.site import submissions


def test_every_status_of_a_study_has_its_word() -> None:
    assert set(verdicts.ROBOTS) == {*get_args(parity.Status), "not compared"} == set(get_args(verdicts.RobotVerdict))
    assert set(verdicts.AUDIT) == set(get_args(audit.Status)) == set(get_args(verdicts.AuditVerdict))
    assert set(verdicts.SCENES) == set(get_args(verdicts.Verdict))
    assert set(SIGNS) == set(get_args(parity.Status))


@pytest.mark.parametrize("family", [verdicts.SCENES, verdicts.ROBOTS])
def test_verdicts_of_one_family_are_told_apart(family: Mapping[Any, Word]) -> None:
    for told in ([word.mark for word in family.values()], [word.title for word in family.values()]):
        assert len(set(told)) == len(told)


def test_the_site_shows_the_lines_of_the_contact_sheet() -> None:
    rows = [
        submissions.contact(),
        submissions.contact(setting="best", value=1e-5, integrator="RK4"),
        submissions.contact(figure="creep", truth=0.0),
        submissions.contact(setting="best", figure="position_error", unit="m"),
    ]
    catalogue = submissions.catalogued(submissions.submission({"contact.csv": rows}))
    shown = engine_facts.contact_sheet(catalogue, "mujoco")
    assert [facts.line for facts in shown] == lines([ContactRow(**row) for row in rows])
    for facts in shown:
        assert facts.line.rows.keys() == facts.entries.keys()
        for setting, row in facts.line.rows.items():
            entry = facts.entries[setting]
            assert (row.setting, row.value) == (entry.get("setting"), entry.get("value"))
