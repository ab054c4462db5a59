"""Tables of reports in a real browser: readers sort them, filter them, and go from them to curves."""

import re
from pathlib import Path
from typing import Any

from tests.support.browser import Visit, shown_cases, visiting
from tests.support.report_cases import FLIGHT, FLIP, SLIDE, TABLE


def rows(page: Any, table: str, column: str) -> list[list[str]]:
    """Of each row that is shown, the cell under a heading: its data-value, empty where it has none, and its text."""
    found: list[list[str]] = page.locator(table).evaluate(
        """(table, column) => {
          const place = [...table.tHead.rows[0].cells].findIndex((cell) => cell.textContent.startsWith(column));
          const cells = [...table.tBodies[0].rows].filter((row) => row.checkVisibility()).map((row) => row.cells[place]);
          return cells.map((cell) => [cell.dataset.value ?? "", cell.textContent.trim()]);
        }""",
        column,
    )
    return found


def head(page: Any, table: str, column: str) -> Any:
    """The button in a heading."""
    return page.locator(table).locator("thead button", has_text=re.compile(f"^{re.escape(column)}")).first


def test_a_table_sorts_by_its_numbers(visit: Visit) -> None:
    page, button = visit.page, head(visit.page, TABLE, "Attitude error")
    before = [float(text) for _, text in rows(page, TABLE, "Attitude error") if text != "–"]
    assert before != sorted(before)
    for direction in ("ascending", "descending"):
        button.click()
        assert page.locator(TABLE).locator("[aria-sort]").count() == 1
        assert button.locator("..").get_attribute("aria-sort") == direction
        cells = rows(page, TABLE, "Attitude error")
        assert [float(text) for _, text in cells[:-1]] == sorted(before, reverse=direction == "descending")
        assert cells[-1] == ["", "–"]  # of the run that crashed


def test_sorting_keeps_the_order_of_what_is_alike(visit: Visit) -> None:
    page = visit.page
    head(page, TABLE, "Attitude error").click()
    by_error = [text for _, text in rows(page, TABLE, "Integrator")]
    head(page, TABLE, "Engine").click()
    engines = [text for _, text in rows(page, TABLE, "Engine")]
    assert engines == sorted(engines)
    own = [text for engine in dict.fromkeys(engines) for text in by_error if text in integrators(page, engine)]
    assert [text for _, text in rows(page, TABLE, "Integrator")] == own


def integrators(page: Any, engine: str) -> set[str]:
    pairs = zip(rows(page, TABLE, "Engine"), rows(page, TABLE, "Integrator"), strict=True)
    return {integrator for (_, own), (_, integrator) in pairs if own == engine}


def test_time_steps_sort_as_numbers(visit: Visit) -> None:
    table = f"#case-{SLIDE} table.sortable >> nth=0"
    head(visit.page, table, "Time step").click()
    assert [text for _, text in rows(visit.page, table, "Time step")] == ["1 ms"] * 2 + ["2 ms"] * 2


def test_a_table_sorts_by_the_keyboard(visit: Visit) -> None:
    page, button = visit.page, head(visit.page, TABLE, "Integrator")
    head(page, TABLE, "Engine").focus()
    page.keyboard.press("Tab")
    assert button.evaluate("button => button === document.activeElement")
    assert button.evaluate("button => getComputedStyle(button).outlineStyle") == "solid"
    before = [text for _, text in rows(page, TABLE, "Integrator")]
    page.keyboard.press("Enter")
    after = [text for _, text in rows(page, TABLE, "Integrator")]
    assert after != before
    assert after == sorted(after, key=str.lower)


def test_rows_are_filtered(visit: Visit) -> None:
    page = visit.page
    field = page.locator("#case-intermediate-axis-flip").get_by_label("Filter rows").first
    total = len(rows(page, TABLE, "Integrator"))
    field.fill("PINOCCHIO rk4")
    assert [text for _, text in rows(page, TABLE, "Integrator")] == ["rk4", "rk4-naive (demonstration)"]
    assert page.locator("output", has_text=f"2 of {total}").count() == 1
    field.fill("")
    assert len(rows(page, TABLE, "Integrator")) == total


def test_cases_of_the_matrix_are_filtered_by_name_and_tag(visit: Visit) -> None:
    page = visit.page
    field = page.get_by_label("Filter cases by name or tag")
    assert shown_cases(page) == [FLIP, FLIGHT, SLIDE]
    field.fill("tumbl")
    assert shown_cases(page) == [FLIP]
    assert page.locator("#matrix h3:visible").count() == 1
    assert page.locator("#matrix .cards li:visible b").all_inner_texts() == [FLIP]
    assert page.locator("#matrix td:visible a").count() > 1
    field.fill("slid")
    assert shown_cases(page) == [SLIDE]
    field.fill("projec")
    assert shown_cases(page) == [FLIGHT]
    field.fill("nothing of that kind")
    assert shown_cases(page) == []
    assert page.locator("#matrix td:visible").count() == 0
    assert page.locator("output", has_text="0 of 3").count() == 1


def test_an_engine_shows_its_default_and_best_method_until_the_reader_wants_all(visit: Visit) -> None:
    page = visit.page
    table = page.locator("#matrix table:has(.more)").first
    engine = table.locator("thead tr:first-child th", has_text="mujoco")
    button = engine.locator("button")
    shown = """table => [...table.rows].slice(1).map(
      (row) => [...row.querySelectorAll('thead th, td')].filter((cell) => cell.checkVisibility()).length)"""
    everything = table.locator("thead tr + tr th").count()
    few = table.evaluate(shown)
    assert set(few) == {few[0]}
    assert button.inner_text() == "3 more methods, 1 failed run"
    assert (engine.get_attribute("colspan"), button.get_attribute("aria-expanded")) == ("2", "false")
    page.emulate_media(media="print")
    assert (set(table.evaluate(shown)), button.is_visible()) == ({everything}, False)
    page.emulate_media(media="screen")
    button.press("Enter")
    assert (engine.get_attribute("colspan"), button.get_attribute("aria-expanded")) == ("5", "true")
    assert table.evaluate(shown) == [few[0] + 3] * len(few)
    button.click()
    assert table.evaluate(shown) == few


def test_columns_of_a_matrix_are_equally_wide_and_rows_have_one_line(browser: Any, report: Path) -> None:
    """So no number is broken."""
    for width in (1280, 390):
        with visiting(browser, report, width=width, height=844) as visit:
            cells = visit.page.locator("#matrix td:visible")
            boxes = cells.evaluate_all(
                "cells => cells.map((cell) => [cell.getBoundingClientRect().width, cell.scrollWidth <= cell.clientWidth])"
            )
            assert len({round(size) for size, _ in boxes}) == 1
            assert all(fits for _, fits in boxes)
            links = visit.page.locator("#matrix td:visible a").evaluate_all(
                "links => links.map((link) => link.getClientRects()[0].height)"
            )
            assert max(links) - min(links) < 1


def test_a_cell_leads_to_its_curve_and_its_command(visit: Visit) -> None:
    """The curve stands out from the others until the reader wants them alike."""
    page, curve = visit.page, f"#curve-{SLIDE}-position_error"
    faded = page.locator(
        f"{curve} .mark-line.role-mark path[stroke-opacity='0.2'], {curve} .mark-line.role-mark path[opacity='0.2']"
    )
    page.locator(f'#matrix td a[href="{curve}"]').first.click()
    page.wait_for_function("curve => Math.abs(document.querySelector(curve).getBoundingClientRect().top) < 100", arg=curve)
    command = page.locator(f"{curve} .how code")
    assert command.inner_text() == f"bodycheck run {SLIDE} --engine mujoco --integrator Euler --timestep 0.002"
    faded.first.wait_for(state="attached")
    assert faded.count() == page.locator(f"{curve} .mark-line.role-mark path").count() - 1
    page.locator(f"{curve} .how button").click()
    faded.first.wait_for(state="detached")
    assert command.count() == 0


def test_a_study_sorts_and_filters(browser: Any, study: Path) -> None:
    with visiting(browser, study) as visit:
        table = "table.sortable:has(tbody tr + tr) >> nth=0"
        texts = [text for _, text in rows(visit.page, table, "Time step")]
        assert len(set(texts)) > 1
        button = head(visit.page, table, "Time step")
        button.click()
        ascending = [text for _, text in rows(visit.page, table, "Time step")]
        button.click()
        assert [text for _, text in rows(visit.page, table, "Time step")] == ascending[::-1]
