"""Where discrepancies of contact come from: what is drawn of them adds up to what was measured."""

from collections import defaultdict
from typing import Any

import pytest
import vl_convert
from hypothesis import given
from hypothesis import strategies as st

from bodycheck.judging.attribution import Attribution
from bodycheck.reports.runs.origins import origins
from bodycheck.reports.study import Chart
from tests.support.wording import facts

FIGURE = st.floats(-1e3, 1e3).filter(lambda value: value == 0 or abs(value) > 1e-9)


def part(integrator: str = "Euler", timestep: float = 0.001, **figures: float | None) -> Attribution:
    known = [value for value in figures.values() if value is not None]
    own = {"model_form": None, "constraint": None, "time_step": None, **figures}
    return Attribution("slide", "mujoco", "4.0.0", integrator, timestep, "stop_yaw", sum(known), **own)


def layers(chart: Chart) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """What is drawn as bars, and as lines."""
    bars, lines = (layer["data"]["values"] for layer in chart.specification["layer"])
    return bars, lines


@given(st.lists(st.tuples(st.none() | FIGURE, FIGURE, FIGURE), min_size=1, max_size=5))
def test_bars_add_up_to_their_line(figures: list[tuple[float | None, float, float]]) -> None:
    methods = [part(f"method{n}", model_form=a, constraint=b, time_step=c) for n, (a, b, c) in enumerate(figures)]
    found = origins({"": methods})
    assert found is not None
    if all(abs(method.total) <= 1e-12 for method in methods):
        assert not found.charts
        return
    (chart,) = found.charts
    bars, lines = layers(chart)
    sums: dict[str, float] = defaultdict(float)
    for bar in bars:
        sums[bar["method"]] += bar["value"]
    assert len(lines) == len(methods)
    assert sums == pytest.approx({line["method"]: line["value"] for line in lines}, abs=1e-9)  # sums in another order


def test_drawn_is_the_smallest_step_of_what_is_known_whole() -> None:
    coarse, fine = (part(timestep=h, model_form=1.0, constraint=0.5, time_step=h) for h in (0.002, 0.001))
    found = origins({"": [coarse, fine, part("RK4", model_form=1.0)]})
    assert found is not None
    assert len(found.table.rows) == 3
    (chart,) = found.charts
    _, lines = layers(chart)
    assert lines == [{"method": "mujoco Euler 1 ms", "value": 1.501}]
    parts = ("model form", "constraint", "time step")
    told = facts(chart.alt, "largest", "mujoco Euler", *parts)
    assert told[told.index("largest") :] == [
        *("largest", "mujoco Euler", "1", "1.5"),
        *(parts[0], "1", parts[1], "0.5", parts[2], "0.001"),
    ]
    assert "mujoco Euler 1 ms" in vl_convert.vegalite_to_svg(chart.specification)


def test_without_contact_there_is_nothing_to_tell() -> None:
    assert origins({"": []}) is None
    assert origins({"a": [], "b": []}) is None
