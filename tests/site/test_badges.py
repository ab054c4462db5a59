"""Badges: counts of the newest release with runs, a name for readers, and text of the width that is drawn."""

import json
from xml.etree import ElementTree

import pytest

from bodycheck.site import links
from bodycheck.site.catalogue import Catalogue
from bodycheck.site.pages import badges
from tests.site import submissions as make
from tests.site import upgrades as example

SVG = "{http://www.w3.org/2000/svg}"


def read(catalogue: Catalogue, engine: str = "mujoco") -> ElementTree.Element:
    """The badge of an engine."""
    made = {one.path: one.content for one in badges.pages(catalogue)}
    return ElementTree.fromstring(made[links.badge(engine)])


def test_a_badge_has_the_counts_of_the_newest_release() -> None:
    root = read(example.catalogue())
    (title,) = root.findall(f"{SVG}title")
    assert title.text == root.attrib["aria-label"] == "bodycheck | mujoco 4.0.0: 3 ran, 0 failed, 0 refused, 0 unsupported"
    assert root.attrib["role"] == "img"


def test_scenes_that_were_not_run_are_counted_apart() -> None:
    other = make.submission([make.run(case="dumbbell", engine="dart", version="1.0")], day="2026-01-05")
    assert read(example.catalogue(other)).attrib["aria-label"].endswith("0 unsupported, 1 not run")


def test_an_engine_without_runs_is_not_measured() -> None:
    catalogue = make.catalogued(make.submission({"audit.csv": [make.audit()]}))
    assert read(catalogue).attrib["aria-label"] == "bodycheck | mujoco: not measured"


def test_texts_fit_their_fields() -> None:
    root = read(example.catalogue())
    fields = [(float(one.attrib.get("x", "0")), float(one.attrib["width"])) for one in root.findall(f"{SVG}rect")]
    texts = [(float(one.attrib["x"]), float(one.attrib["textLength"])) for one in root.iter(f"{SVG}text")]
    for (left, width), (start, length) in zip(fields, texts, strict=True):
        assert left < start
        assert start + length < left + width
    assert fields[1][0] + fields[1][1] == float(root.attrib["width"])


@pytest.mark.parametrize("message", ['a < b & "c"', "ж" * 5])
def test_any_message_is_well_formed(message: str) -> None:
    root = ElementTree.fromstring(badges.badge(message))
    assert root.attrib["aria-label"] == f"bodycheck | {message}"


def test_services_of_badges_read_the_same_counts_of_every_release() -> None:
    """By the endpoint of Shields: four keys, of which the version of the schema is 1."""
    written = {one.path: json.loads(one.content) for one in badges.pages(example.catalogue()) if one.path.endswith(".json")}
    assert set(written) > {"badges/mujoco.json", "badges/mujoco-4.0.0.json"}
    newest = written["badges/mujoco.json"]
    assert newest == written["badges/mujoco-4.0.0.json"]
    assert newest == {
        "schemaVersion": 1,
        "label": "bodycheck",
        "message": "mujoco 4.0.0: 3 ran, 0 failed, 0 refused, 0 unsupported",
        "color": "#0b5cad",
    }
    assert len({one["message"] for path, one in written.items() if path != "badges/mujoco.json"}) == len(written) - 1
