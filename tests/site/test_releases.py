"""Pages of releases: what they say of an upgrade follows from the runs and studies."""

import re
from html import unescape

from bodycheck.site import build, links, telling
from bodycheck.site.catalogue import Catalogue
from bodycheck.site.pages import releases as pages
from bodycheck.site.releases import measured_changes, releases, upgrades
from tests.site import submissions as make
from tests.site import upgrades as example
from tests.support.wording import facts

#: What a sentence on an order may name.
ORDERS = ("From", "In", "RK4", "second", "fourth", "fifth", "attitude", "angular momentum", "energy")


def text(catalogue: Catalogue, version: str) -> str:
    """The page of a release of MuJoCo as text."""
    made = {one.path: one.content.decode() for one in pages.pages(catalogue)}
    page = made[links.release("mujoco", version)]
    return " ".join(unescape(re.sub("<[^>]+>", " ", page.partition("<main")[2])).split())


def test_an_upgrade_counts_what_became_better_worse_and_otherwise() -> None:
    known = releases(example.catalogue(), "mujoco")
    (upgrade,) = upgrades(known).values()
    assert (upgrade.before.version, upgrade.after.version) == (example.OLD, example.NEW)
    assert [scene.name for scene, _ in upgrade.errors(worse=False)] == [make.FREE]
    assert [scene.name for scene, _ in upgrade.errors(worse=True)] == [make.CONTACT]
    assert [scene.name for scene, _ in upgrade.statuses] == [make.MECHANISM]
    assert [(one.scene.name, one.before, one.after) for one in upgrade.verdicts] == [(make.MECHANISM, "failed", "error")]
    assert (upgrade.new_methods, upgrade.gone_methods) == (("discrete",), ())
    told = [telling.plain(one) for one in telling.of_upgrade(upgrade)]
    kinds = ("smaller error", "larger one", "another way", "without a change")
    assert facts(told[0], *kinds) == ["4", "3.17.0", "1", kinds[0], "1", kinds[1], "1", kinds[2], "1", kinds[3]]
    assert facts(told[1], "attitude error", "smaller")[-5:] == ["attitude error", "0.0001", "5e-9", "2e4", "smaller"]
    assert facts(told[-1], "Only", "discrete") == ["Only", "4.0.0", "discrete"]


def test_the_order_of_a_method_is_told_as_a_study_observed_it() -> None:
    catalogue = example.catalogue()
    (told,) = telling.orders(catalogue, measured_changes(catalogue, "mujoco", example.NEW))
    order = ["From", "4.0.0", "RK4", "fourth", "attitude"]
    assert facts(telling.plain(told), *ORDERS, "intermediate-axis-flip", "A", "B") == [
        *(*order, "4", "intermediate-axis-flip"),
        *("3.17.0", "second", "2", "B", "A"),
    ]
    assert telling.plain(told).partition(" (")[0] in text(catalogue, example.NEW)


def test_quantities_that_changed_alike_are_told_in_one_sentence() -> None:
    alike = make.change(quantity="angular_momentum_drift", order_after=3.98)
    other = make.change(quantity="energy_drift", order_before=3.0, order_after=5.0)
    changes = [make.change(), alike, other]
    catalogue = example.catalogue(make.submission({"changes.csv": changes}, day="2026-01-04"))
    told = [telling.plain(one) for one in telling.orders(catalogue, measured_changes(catalogue, "mujoco", example.NEW))]
    assert len(told) == 2
    assert facts(told[0], *ORDERS)[3:8] == ["fourth", "attitude", "angular momentum", "4", "3.98"]
    assert facts(told[1], *ORDERS)[3:5] == ["fifth", "energy"]


def test_without_a_study_nothing_is_said_of_orders() -> None:
    assert "order in attitude" not in text(example.catalogue(order=False), example.NEW)


def test_an_order_that_a_later_release_changes_again_holds_in_its_release_alone() -> None:
    back = make.change(from_version="4.0.0", to_version="4.1.0", order_before=4.0, order_after=2.0)
    catalogue = example.catalogue(make.submission({"changes.csv": [back]}, day="2026-01-04"))
    first, second = (
        telling.plain(next(telling.orders(catalogue, measured_changes(catalogue, "mujoco", version))))
        for version in ("4.0.0", "4.1.0")
    )
    assert facts(first, *ORDERS)[:4] == ["In", "4.0.0", "RK4", "fourth"]
    assert facts(second, *ORDERS)[:4] == ["From", "4.1.0", "RK4", "second"]


def test_orders_are_whole_only_where_they_are_close_to_it() -> None:
    assert [telling.ordinal(order) for order in (0.98, 2.1, 4.07, 2.45, 9.9)] == [
        "first",
        "second",
        "fourth",
        "2.45-th",
        "9.90-th",
    ]


def test_exact_and_not_exact_is_another_verdict_only_beyond_rounding() -> None:
    def verdicts(error: float) -> int:
        rows = [make.exact(version="1.0", attitude_error=9e-11), make.run(version="2.0", attitude_error=error)]
        sent = [make.submission([row], day=f"2026-01-0{day}") for day, row in enumerate(rows, start=1)]
        (upgrade,) = upgrades(releases(make.catalogued(*sent), "mujoco")).values()
        return len(upgrade.verdicts)

    assert verdicts(1.05e-10) == 0, "the truth's bound is 1e-10, and the difference is one of rounding"
    assert verdicts(1e-3) == 1


def test_a_page_has_its_neighbours_its_environment_and_what_was_run() -> None:
    old = text(example.catalogue(), example.OLD)
    assert "Release after: 4.0.0" in old
    assert "Release before" not in old
    assert "mujoco==3.17.0" in old
    assert "There are no runs of a release before this one." in old
    assert "2026-01-01 bodycheck run" in old


def test_a_release_of_studies_alone_has_a_page() -> None:
    study = {"releases.csv": [make.release("3.9.0")]}
    told = text(example.catalogue(make.submission(study, day="2026-01-05")), "3.9.0")
    assert "No submission has runs of this release." in told


def test_a_release_that_could_not_be_installed_says_so() -> None:
    row = make.ended("unobtainable", "no wheel for this platform", version="3.9.0")
    told = text(example.catalogue(make.submission({"releases.csv": [row]}, day="2026-01-05")), "3.9.0")
    assert "A study of releases could not install this release: no wheel for this platform" in told


def test_links_of_engines_and_releases_lead_to_files_of_the_site() -> None:
    made = {one.path: one.content.decode() for one in build.files(example.catalogue())}
    for path, content in made.items():
        if path.startswith(("engines/", "releases/")):
            found = re.findall(r'href="\.\./((?:engines|releases|badges)/[^"#]*|feed\.atom|index\.html)"', content)
            assert found
            assert set(found) <= made.keys()
