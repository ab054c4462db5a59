"""What the front page says of engines and scenes, and what it consists of."""

import re

import pytest

from bodycheck.results import verdicts
from bodycheck.site import links
from bodycheck.site.front import Front, Shown
from bodycheck.site.pages import index
from tests.site import submissions
from tests.site.large import ENGINES, SCENES, large
from tests.site.submissions import CONTACT, FREE, catalogued, ended, exact, run, submission


def shown(*rows: submissions.Row, best: bool = False) -> Shown:
    """The only cell of the front page of these runs."""
    (group,) = Front(catalogued(submission(rows))).groups
    (line,) = group.lines
    (cell,) = line.best if best else line.own
    return cell


def test_an_error_is_shown_with_its_bound_its_method_and_the_shade_of_its_exponent() -> None:
    cell = shown(run(attitude_error=2.5e-4, truth_error=1e-10))
    assert (cell.text, cell.style, cell.word) == ("0.00025", "error d4", "")
    assert cell.told == "error 0.00025, bound 1e-10 rad; Euler at 2 ms, role not known"


@pytest.mark.parametrize(
    ("row", "text", "word", "told"),
    [
        (exact(), "≤ 1e-10", "", "exact 1e-13, bound 1e-10 rad; Euler at 2 ms"),
        (ended("diverged", "not finite"), "✗", "failed", "failed; not finite; Euler at 2 ms"),
        (ended("timeout", "took 60 s"), "✗", "failed", "failed; took 60 s; Euler at 2 ms"),
        (ended("unsupported", "mujoco does not model drag"), "–", "unsupported", "mujoco does not model drag"),
        (ended("unsupported", "mujoco refuses the model: no"), "⊘", "refused", "mujoco refuses the model: no"),
        (submissions.broken(), "!2.1", "", "expectation broken 2.12, bound 1e-10 rad"),
    ],
)
def test_verdicts_are_told_apart_by_text_alone(row: submissions.Row, text: str, word: str, told: str) -> None:
    cell = shown(row)
    assert (cell.text, cell.word) == (text, word)
    assert told in cell.told


def test_nothing_is_known_where_there_is_no_run_and_unsupported_where_there_is_no_method() -> None:
    source = submission(
        [run(case=FREE), run(case=CONTACT), run(case=FREE, engine="drake", version="1.51.1")],
        without_method={"mujoco": {}, "drake": {CONTACT: "drake has no method for contact"}},
    )
    other = submission([run(case=FREE, engine="dart", version="6.1")], day="2026-01-02")
    front = Front(catalogued(source, other))
    cells = {line.scene.name: line.own for group in front.groups for line in group.lines}
    dart, drake, mujoco = cells[CONTACT]
    assert (dart.text, dart.word, dart.address) == ("·", "not run", "")
    assert (drake.text, drake.told) == ("–", "unsupported; drake has no method for contact")
    assert mujoco.address


def test_every_verdict_has_a_sign_of_its_own() -> None:
    marks = [word.mark for word in verdicts.SCENES.values()]
    assert len(set(marks)) == len(marks)


def test_the_best_method_is_the_completed_one_with_the_smallest_error() -> None:
    rows = [run(), run(integrator="RK4", attitude_error=1e-6), ended("diverged", "not finite", integrator="implicit")]
    assert shown(*rows).text == "2.1"
    assert shown(*rows, best=True).text == "1e-6"
    assert "RK4" in shown(*rows, best=True).told


def cells_of(*rows: submissions.Row) -> tuple[Shown, Shown]:
    """The cells of these runs on the front page: that of the default method, and that of the recommended method."""
    (group,) = Front(catalogued(submission(rows))).groups
    (line,) = group.lines
    return line.own[0], line.recommended[0]


def test_the_front_shows_the_default_and_the_recommended_method() -> None:
    rows = [
        run(attitude_error=1.0, role=None),
        run(integrator="RK4", timestep=0.005, attitude_error=0.25, role="default"),
        run(integrator="implicit", attitude_error=0.125, role="recommended"),
    ]
    default, recommended = cells_of(*rows)
    assert (default.text, recommended.text) == ("0.25", "0.12")
    assert default.told.endswith("RK4 at 5 ms, default method")
    assert recommended.told.endswith("implicit at 2 ms, recommended method")
    both, again = cells_of(run(attitude_error=0.5, role="default, recommended"))
    assert both == again
    assert both.told.endswith("Euler at 2 ms, default and recommended method")


def test_the_front_says_where_roles_are_not_known_or_an_engine_has_none() -> None:
    default, recommended = cells_of(run(integrator="RK4"), run())
    assert default.told.endswith("Euler at 2 ms, role not known")
    assert (recommended.word, recommended.told, recommended.address) == ("not run", "not run; role not known", "")
    default, recommended = cells_of(run(role=None))
    assert default.told.endswith("Euler at 2 ms, neither default nor recommended")
    assert recommended.told == "not run; no recommended method"


def test_a_cell_leads_to_its_raw_row() -> None:
    source = submission([run(integrator="RK4"), run()])
    (group,) = Front(catalogued(source)).groups
    assert group.lines[0].own[0].address == f"row.html#{source.key}/results.csv/1"


@pytest.mark.parametrize(
    ("then", "now", "mark"),
    [
        (run(attitude_error=1e-3), run(attitude_error=2e-3), "▲"),
        (run(attitude_error=2e-3), run(attitude_error=1e-3), "▼"),
        (ended("diverged"), run(), "▼"),
        (ended("diverged"), ended("crashed"), "◆"),
        (run(), run(), ""),
        (run(attitude_error=1e-3), run(attitude_error=1.001e-3), ""),
    ],
)
def test_a_change_of_the_own_method_is_marked(then: submissions.Row, now: submissions.Row, mark: str) -> None:
    before, after = submission([then], day="2026-01-01"), submission([now], day="2026-02-01")
    front = Front(catalogued(before, after))
    cell = front.groups[0].lines[0].own[0]
    assert cell.mark == mark
    assert ("changed" in cell.style.split()) == bool(mark)
    assert bool(front.news) == bool(mark)
    if mark:
        assert "changed since 4.0.0 of 2026-01-01: Euler at 2 ms" in cell.told
        assert front.news[0].since == "4.0.0 of 2026-01-01"


def test_news_tell_versions_and_the_largest_changes_first() -> None:
    errors = {"intermediate-axis-flip": (1e-3, 2e-3), "free-brick": (1e-3, 1e-6), "dumbbell": (1e-3, 1e-3)}
    old = [run(case=name, version="3.0", attitude_error=then) for name, (then, _) in errors.items()]
    new = [run(case=name, version="4.0", attitude_error=now) for name, (_, now) in errors.items()]
    changed = run(case="dumbbell", integrator="RK4", version="4.0", attitude_error=1e-5)
    older = run(case="dumbbell", integrator="RK4", version="3.0", attitude_error=1e-4)
    front = Front(catalogued(submission([*old, older]), submission([*new, changed], day="2026-01-02")))
    (news,) = front.news
    assert (news.version, news.since) == ("4.0", "3.0")
    assert (news.worse, news.better, news.other) == (1, 1, 1)
    assert [case for case, _, _ in news.largest] == ["free-brick", "dumbbell", "intermediate-axis-flip"]
    assert news.largest[0][1] == "Euler at 2 ms 0.001 → 1e-6"
    old_key, new_key = (source.key for source in front.catalogue.submissions)
    assert news.comparison == f"compare.html#engine=mujoco&left={old_key}:3.0:results.csv&right={new_key}:4.0:results.csv"


def test_the_page_of_a_large_site_is_small_enough_to_be_fast() -> None:
    # What a browser lays out decides how fast the page is: benchmarks/site.py measures 0.6 s for this one.
    catalogue = large()
    assert (len(catalogue.engines), len(catalogue.scenes)) == (ENGINES, SCENES)
    page, *_ = index.pages(catalogue)
    text = page.content.decode()
    assert page.path == links.INDEX
    assert len(page.content) < 1_200_000
    assert len(re.findall(r"<[a-z]", text)) < 4 * ENGINES * SCENES
    assert text.partition('<table id="matrix">')[2].count("<td ") == ENGINES * SCENES
    assert sorted(re.findall(r'<script[^>]* src="([^"]+)"', text)) == ["assets/index.js", "assets/site.js"]
    assert "<img" not in text
    assert "style=" not in text
