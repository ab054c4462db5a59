"""Submissions that contradict each other stand side by side, and those that cannot have been measured are left out."""

from datetime import UTC, datetime
from pathlib import Path

import pytest

from bodycheck.errors import BadInput
from bodycheck.site import front, links, released, robot_tables, scene_runs
from bodycheck.site.pages import robots
from bodycheck.site.submissions import gathering
from tests.site import submissions as made

NOW = datetime(2026, 1, 1, 12, 0, 0, tzinfo=UTC)


def left_out(folder: Path, rows: list[made.Row], **told: object) -> str:
    """The reason for which a results folder is left out at `NOW`; empty if it is not."""
    made.write_folder(folder, {"results.csv": rows}, made.header(**told))
    shown, reasons = gathering.gathered([folder], NOW)
    assert len(shown) + len(reasons) == 1
    return reasons[0].reason if reasons else ""


def test_what_was_started_after_the_clock_of_the_site_is_left_out(tmp_path: Path) -> None:
    assert left_out(tmp_path / "now", [made.run()], day="2026-01-01") == ""
    reason = left_out(tmp_path / "later", [made.run()], started="2026-01-01T12:00:01+00:00")
    assert reason.endswith("2026-01-01T12:00:01+00:00 is after the present time of this site, 2026-01-01T12:00:00+00:00")


@pytest.mark.parametrize("version", ["9999", "9999!9", "4.0.0+local", "zzz"])
def test_a_version_that_no_list_of_releases_has_is_left_out(tmp_path: Path, version: str) -> None:
    reason = left_out(tmp_path / "out", [made.run(version=version)], engines={"mujoco": version})
    assert "no list of releases has mujoco" in reason
    assert f"the list is of {released._lists()['day']}" in reason


def test_the_last_of_several_releases_is_looked_up_too(tmp_path: Path) -> None:
    study = made.submission({"releases.csv": [made.release("3.2.0")]}, engines={"mujoco": "3.2.0 to 9999"})
    with pytest.raises(BadInput, match="no list of releases has mujoco '9999'"):
        gathering._check_origin(study, NOW)


@pytest.mark.parametrize(("engine", "version"), [("mujoco", "3.2.0"), ("mujoco", "4.0"), ("own", "0.1")])
def test_releases_and_engines_without_a_list_are_shown(tmp_path: Path, engine: str, version: str) -> None:
    assert left_out(tmp_path / "out", [made.run(engine=engine, version=version)], engines={engine: version}) == ""


def test_a_newer_submission_does_not_displace_the_number_of_an_older_one() -> None:
    honest = made.submission([made.run(attitude_error=2e-9)], day="2026-01-01")
    forged = made.submission([made.run(attitude_error=3.0)], day="2026-01-02")
    catalogue = made.catalogued(honest, forged)
    (shown,) = (cell for group in front.Front(catalogue).groups for line in group.lines for cell in line.own)
    assert shown.text == "3 or 2e-9"
    assert "disputed" in shown.style.split()
    assert f"{honest.named} says 2e-9 rad" in shown.told
    assert f"{forged.named} says 3 rad" in shown.told
    lines, _ = scene_runs.newest(catalogue, catalogue.scenes[made.FREE])
    assert [(line.run.get("attitude_error"), line.source) for line in lines] == [(3.0, forged.named), (2e-9, honest.named)]


def test_submissions_that_say_the_same_are_shown_once() -> None:
    both = [made.submission([made.run()], day=f"2026-01-0{day}") for day in (1, 2)]
    catalogue = made.catalogued(*both)
    (shown,) = (cell for group in front.Front(catalogue).groups for line in group.lines for cell in line.own)
    assert " or " not in shown.text
    (line,) = scene_runs.newest(catalogue, catalogue.scenes[made.FREE])[0]
    assert line.source == ""


def test_readings_of_a_robot_that_contradict_each_other_stand_side_by_side() -> None:
    honest = made.submission({"parity.csv": [made.parity(quantity="mass")]}, day="2026-01-01")
    again = made.submission({"parity.csv": [made.parity(quantity="mass", relative=1e-17)]}, day="2026-01-02")
    forged = {"quantity": "order", "status": "differs", "cause": "unexplained", "relative": 1.0, "subject": "j"}
    other = made.submission({"parity.csv": [made.parity(**forged)]}, day="2026-01-03")
    catalogue = made.catalogued(honest, again, other)
    newest, _, _ = robot_tables.readings(catalogue.robots["panda"])
    assert [(one.verdict, one.source) for one in newest] == [("agrees", again.named), ("differs", other.named)]
    pages = {one.path: one.content.decode() for one in robots.pages(catalogue)}
    for named in (again.named, other.named):
        assert pages[links.robot("panda")].count(named) >= 2
        assert named in pages[links.ROBOTS]


def test_no_submission_hides_a_change_by_a_large_effect_of_rounding() -> None:
    studies = [
        made.submission({"releases.csv": [made.release("4.0.0", attitude_error_allowance=each)]}, day=f"2026-01-0{day}")
        for day, each in ((1, 1e-9), (2, 1e9))
    ]
    (allowances,) = made.catalogued(*studies).allowances.values()
    assert allowances["attitude_error_allowance"] == 1e-9


def test_different_reasons_why_an_engine_has_no_run_stand_side_by_side() -> None:
    sources = [
        made.submission([made.run()], day=f"2026-01-0{day}", without_method={"mujoco": {made.CONTACT: why}})
        for day, why in ((1, "has no contact"), (2, "is not worth it"))
    ]
    assert made.catalogued(sources[0]).without_method["mujoco", made.CONTACT] == "has no contact"
    both = f"has no contact ({sources[0].named}); is not worth it ({sources[1].named})"
    assert made.catalogued(*sources).without_method["mujoco", made.CONTACT] == both
