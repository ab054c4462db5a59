"""The colours of pages, read from their style: text that can be read, a scale that does not need hues, one hue an adapter."""

import re
from importlib import resources
from itertools import pairwise

import pytest

from bodycheck.reports.lines import DASHES, FURTHER_HUES, HUES, assign
from bodycheck.results.key import RunKey

TEMPLATES = resources.files("bodycheck.reports") / "templates"
STYLE = "".join((TEMPLATES / name).read_text("utf-8") for name in ("colours.css", "common.css", "report.css"))
DARK = "@media screen and (prefers-color-scheme: dark) {"
#: Contrasts that WCAG 2 asks of text (1.4.3, AA) and of graphics (1.4.11).
READABLE, VISIBLE = 4.5, 3.0

TEXT = [
    *((ink, ground) for ink in ("ink", "faint", "link") for ground in ("ground", "panel")),
    *((ink, "bad-ground") for ink in ("ink", "link", "bad")),
    *((ink, "warn-ground") for ink in ("ink", "link")),
    ("bad", "ground"),
]


def luminance(colour: str) -> float:
    """Relative luminance as WCAG 2 defines it."""
    shares = [int(colour[place : place + 2], 16) / 255 for place in (1, 3, 5)]
    red, green, blue = (share / 12.92 if share <= 0.04045 else ((share + 0.055) / 1.055) ** 2.4 for share in shares)
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


def contrast(one: str, other: str) -> float:
    dark, light = sorted((luminance(one), luminance(other)))
    return (light + 0.05) / (dark + 0.05)


def lightness(colour: str) -> float:
    """CIE L*, in which equal steps look equal."""
    return 116 * luminance(colour) ** (1 / 3) - 16


def blocks(scheme: str) -> str:
    """The rules that hold in a scheme: those of the dark one alone, or all others."""
    dark = re.findall(re.escape(DARK) + r"(.*?)\n}", STYLE, re.DOTALL)
    assert len(dark) == 2
    return "\n".join(dark) if scheme == "dark" else re.sub(re.escape(DARK) + r".*?\n}", "", STYLE, flags=re.DOTALL)


def variables(scheme: str) -> dict[str, str]:
    return dict(re.findall(r"--([a-z-]+): (#[0-9a-f]{6});", blocks(scheme)))


def heat(scheme: str) -> list[tuple[str, str]]:
    """Ground and ink of each decade, from the smallest errors to the largest."""
    found = {int(decade): (ground, ink) for decade, ground, ink in re.findall(HEAT, blocks(scheme))}
    return [found[decade] for decade in range(12, -1, -1)]


HEAT = r"\.d(\d+) \{ background: (#[0-9a-f]{6}); color: (#[0-9a-f]{6}); \}"


def test_the_dark_scheme_has_every_colour() -> None:
    assert set(variables("dark")) == set(variables("light"))


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize(("ink", "ground"), TEXT)
def test_text_can_be_read(scheme: str, ink: str, ground: str) -> None:
    colours = variables(scheme)
    assert contrast(colours[ink], colours[ground]) >= READABLE


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_what_is_no_text_can_be_seen(scheme: str) -> None:
    colours = variables(scheme)
    for name in ("edge", "link", "bad", "good"):
        assert contrast(colours[name], colours["ground"]) >= VISIBLE, name


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_figures_on_the_heat_scale_can_be_read(scheme: str) -> None:
    for ground, ink in heat(scheme):
        assert contrast(ground, ink) >= READABLE, ground


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_the_heat_scale_goes_by_lightness(scheme: str) -> None:
    """Who sees no hues still sees the order; of neighbours, differences of 4 can be told, a step being some 6.5."""
    steps = [one - other for one, other in pairwise(lightness(ground) for ground, _ in heat(scheme))]
    assert all(step * (1 if scheme == "light" else -1) > 4 for step in steps)


def test_lines_can_be_seen_on_both_grounds() -> None:
    for pair in (*HUES.values(), *FURTHER_HUES):
        for colour in pair:
            for scheme in ("light", "dark"):
                assert contrast(colour, variables(scheme)["ground"]) >= VISIBLE, (colour, scheme)


def test_no_two_engines_share_a_colour() -> None:
    colours = [colour for pair in (*HUES.values(), *FURTHER_HUES) for colour in pair]
    assert len(set(colours)) == len(colours)


def test_an_engine_has_one_hue() -> None:
    """Whatever it is run with; the second shade of a pair tells integrators apart."""
    own = {name: colours_of(name) for name in (*HUES, "zeta")}
    together = assign(method(name, place) for name in reversed(own) for place in range(20)).values()
    for name, pair in own.items():
        assert pair == {line.colour for line in together if line.engine == name}
        assert pair in ([set(HUES[name])] if name in HUES else map(set, FURTHER_HUES))


def test_the_hues_of_other_engines_follow_from_their_names_in_every_process() -> None:
    """Python's own hash of a text differs from process to process, so that the colours are written here."""
    assert {name: colours_of(name) for name in ("zeta", "miniature")} == {
        "zeta": {"#a781b8", "#7b578b"},
        "miniature": {"#f233b4", "#be048a"},
    }


def test_the_releases_of_an_engine_share_its_hue_and_differ_in_their_lines() -> None:
    """As many methods in two releases as there are different dashes in two shades."""
    names = ("mujoco", "mujoco@3.17.0")
    lines = assign(method(name, place) for name in names for place in range(len(DASHES))).values()
    assert {line.colour for line in lines} == set(HUES["mujoco"])
    assert len({(line.colour, line.dash) for line in lines}) == len(lines)


def method(engine: str, place: int) -> RunKey:
    return RunKey.of_method(engine, f"i{place}", 0.002)


def colours_of(engine: str) -> set[str]:
    return {line.colour for line in assign(method(engine, place) for place in range(20)).values()}
