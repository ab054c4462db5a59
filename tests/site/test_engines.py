"""Pages of engines: every table appears, what no submission has is not measured, and verdicts stay apart."""

import re
from html import unescape
from itertools import pairwise
from xml.etree import ElementTree

from bodycheck.site import links
from bodycheck.site.catalogue import Catalogue
from bodycheck.site.pages import engines
from bodycheck.site.trend import Line, chart
from tests.site import submissions as make
from tests.site import upgrades as example


def raw(catalogue: Catalogue, engine: str = "mujoco") -> str:
    """The page of an engine."""
    return {one.path: one.content.decode() for one in engines.pages(catalogue)}[links.engine(engine)]


def section(page: str, name: str) -> str:
    """The text of a section of a page."""
    (found,) = re.findall(rf'<h2 id="{name}">(.*?)(?=<h2|</main>)', page, re.DOTALL)
    return " ".join(unescape(re.sub("<[^>]+>", " ", found)).split())


def test_every_study_appears_with_its_numbers() -> None:
    page = raw(example.catalogue(make.submission(example.STUDIES, day="2026-01-04")))
    assert "intermediate-axis-flip : attitude 1.01" in section(page, "methods")
    assert "semi-implicit Euler" in section(page, "methods")
    assert "Stop time error, s 0.4077 0.001 Euler at 2 ms 1e-5 Euler at 2 ms" in section(page, "contact")
    assert "linear-damping Euler at 2 ms 0.001 1/s 0 deviates" in section(page, "audit")
    assert "0 properties of a method by the engine's own settings, 1 without a switch for it, 1 as mechanics has it" in page
    assert "1000 1 % (0.5 to 1.8) Attitude error 0.01 0.1 1.5" in section(page, "ensembles")
    assert "panda 4.0.0 1 1 0 0 0 damping-ignored" in section(page, "robots")
    assert "integrator Euler" in section(page, "defaults")


def test_what_no_submission_has_is_not_measured() -> None:
    page = raw(make.catalogued(make.submission([make.run()], defaults={})))
    for name in ("defaults", "audit", "contact", "ensembles", "robots"):
        assert "Not measured." in section(page, name)
    assert section(page, "methods").endswith("not measured not measured not measured")


def test_an_engine_with_studies_alone_has_a_page() -> None:
    page = raw(make.catalogued(make.submission(example.STUDIES)))
    assert "No submission has runs of this engine." in page
    assert "linear-damping" in section(page, "audit")


def test_failed_refused_unsupported_and_not_run_stay_apart() -> None:
    rows = [
        make.exact(case="free-brick"),
        make.run(),
        make.broken(case="short-axis-spin"),
        make.ended("diverged", "energy", case="dumbbell"),
        make.ended("unsupported", "MuJoCo refuses the model: mass", case="iftomm-a01"),
        make.ended("unsupported", case=make.CONTACT),
    ]
    others = [make.run(case="projectile", engine="dart", version="1.0")]
    page = raw(make.catalogued(make.submission(rows), make.submission(others, day="2026-01-02")))
    lead = "3 ran (1 exact) (1 with a broken expectation), 1 failed, 1 refused, 1 unsupported, 1 not run."
    assert lead in " ".join(page.split())
    listed = re.findall(r"<summary>(.*?: 1 scene)</summary>", page)
    assert listed == [f"{name}: 1 scene" for name in ("Expectation broken", "Failed", "Refused", "Unsupported", "Not run")]


def test_a_trend_is_drawn_for_a_scene_that_changed_with_a_table_of_the_same_numbers() -> None:
    page = raw(example.catalogue())
    (drawn,) = re.findall(r'<svg class="trend".*?</svg>', page.partition(f"{make.FREE}</h3>")[2].partition("</figure>")[0])
    tree = ElementTree.fromstring(drawn)
    assert "the table has the numbers" in tree.attrib["aria-label"]
    assert len([one for one in tree if one.tag == "circle"]) == 4, "Euler and RK4 in two releases; discrete has one alone"
    assert "RK4 at 2 ms 0.0001 5e-9" in section(page, "releases")


def test_larger_errors_are_higher_and_names_do_not_overlap() -> None:
    lines = [Line("one", (1e-3, 1e-6)), Line("two", (1e-3, 1.1e-6)), Line("three", (None, 1e-6)), Line("zero", (0.0, 1e-6))]
    tree = ElementTree.fromstring(chart("<title>", "error, rad", ["1.0", "2.0"], lines))
    dots = [(one.attrib["class"], float(one.attrib["cy"])) for one in tree if one.tag == "circle"]
    assert [name for name, _ in dots] == ["line0", "line0", "line1", "line1", "line2", "line3", "line3"]
    assert dots[0][1] < dots[1][1]
    names = sorted(float(one.attrib["y"]) for one in tree if one.tag == "text" and "class" in one.attrib)
    assert min(second - first for first, second in pairwise(names)) >= 13.9


def test_no_name_of_a_stranger_becomes_markup() -> None:
    row = make.audit(probe="a < b & c", integrator="Euler:x=<b>")
    issues = section(raw(make.catalogued(make.submission([make.run()]))), "issues")
    assert "<origin rpy>" in issues
    assert "a &lt; b &amp; c" in raw(make.catalogued(make.submission({"audit.csv": [row | {"integrator": "Euler"}]})))


def test_names_of_many_releases_are_thinned_out_and_the_last_one_stays() -> None:
    versions = [f"3.{place}.10" for place in range(32)]
    drawn = ElementTree.fromstring(chart("title", "error", versions, [Line("one", (1e-3,) * 32)]))
    named = [one.text for one in drawn if one.tag == "text" and one.text in versions]
    assert 3 < len(named) < 8
    assert named[-1] == versions[-1]
