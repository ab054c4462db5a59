"""The page of contact: errors of all engines in all scenes of contact, their laws, properties and settings."""

import re
from html import unescape

from bodycheck.site import links
from bodycheck.site.pages import contact
from tests.site import submissions as made
from tests.site.submissions import CONTACT, catalogued, submission

ENGINES = ("mujoco", "drake", "dart")


def words(page: str) -> str:
    return " ".join(unescape(re.sub(r"<[^>]+>", " ", page)).split())


def test_every_cell_has_its_error_or_its_reason() -> None:
    told = {"figure": "position_error", "unit": "m"}
    rows = [
        made.contact(**told, value=0.2),
        made.contact(**told, value=0.01, setting="best", integrator="RK4"),
        made.contact(engine="drake", version="1.51.1", **told, value=0.3, setting="best"),
        made.contact(engine="dart", version="6.20.0", figure="", value=None, truth=None, unit="", status="unsupported"),
    ]
    properties = [made.contact_property(), made.contact_property(setting="best", integrator="RK4")]
    tables = {"contact.csv": rows, "contact_properties.csv": properties, "contact_settings.csv": [made.contact_setting()]}
    source = submission(
        tables,
        without_method={"mujoco": {}, "drake": {}, "dart": {CONTACT: "dart has no friction of this kind"}},
    )
    (file,) = contact.pages(catalogued(source))
    page = file.content.decode()
    assert file.path == links.CONTACT
    dart, drake, mujoco = re.findall(r"<td class[^>]*>.*?</td>", page)[:3]
    assert words(mujoco) == "0.2 ▸ 0.01"
    assert words(drake) == "0.3"
    assert words(dart) == "no : unsupported: dart has no friction of this kind"
    assert f"dart: {CONTACT}" in words(page)
    assert "at defaults, best found" in words(page)  # settings of which the same is to be said share a line
    assert "soft friction" in words(page)


def test_there_is_no_page_without_a_sheet() -> None:
    assert not list(contact.pages(catalogued(submission([made.run()]))))
