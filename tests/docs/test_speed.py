"""Lines about bodycheck's own cost: ratios between lines of one machine, and a page that shows all."""

import json
from pathlib import Path
from typing import Any

import pytest

from benchmarks import speed


def line(day: str, seconds: dict[str, float], processor: str = "A", bodycheck: str = "0.2.0") -> dict[str, Any]:
    machine = {"system": "s", "processor": processor, "cores": "2", "python": "3.11.7"}
    return {"day": day, "versions": {"bodycheck": bodycheck}, "machine": machine, "seconds": seconds}


def test_a_line_is_compared_with_the_last_one_of_its_machine() -> None:
    earlier = [
        line("2026-01-01", {"run": 9.0}),
        line("2026-01-02", {"run": 1.0, "help": 0.5}, bodycheck="0.1.0"),
        line("2026-01-03", {"run": 5.0}, processor="B"),
    ]
    now = line("2026-01-04", {"run": 2.0, "help": 0.52, "new": 0.1})
    before = speed.last_of(earlier, now["machine"])
    assert [" ".join(text.split()) for text in speed.compared(now, before)] == [
        "compared with 2026-01-02: bodycheck 0.1.0 -> 0.2.0",
        "run 2000.0 ms 2.00 times",
        "help 520.0 ms unchanged",
        "new 100.0 ms",
    ]
    assert next(speed.compared(now, speed.last_of(earlier, {"processor": "C"}))) == "the first line of this machine"


def test_the_page_shows_the_machines_apart_and_the_newest_line_first(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    listed = [line("2026-01-01", {"run": 1.0}), line("2026-01-02", {"run": 5.0}, "B"), line("2026-01-03", {"run": 2.0})]
    (tmp_path / "speed.jsonl").write_text("".join(json.dumps(one) + "\n" for one in listed), "utf-8")
    monkeypatch.setattr(speed, "FILE", tmp_path / "speed.jsonl")
    page = speed.page()
    assert page.index("| 2026-01-03 | 0.2.0 | 2e+03 2.00 times |") < page.index("| 2026-01-01 | 0.2.0 | 1e+03 |")
    assert "B, 2 cores" in page


def test_the_lines_of_this_repository_have_what_the_page_explains() -> None:
    recorded = speed.lines(speed.FILE)
    assert recorded
    for one in recorded:
        assert set(one) == {"day", "versions", "machine", "seconds"}
        assert set(one["seconds"]) <= set(speed.MEANINGS)
        assert all(cost > 0 for cost in one["seconds"].values())
