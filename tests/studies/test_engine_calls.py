"""The time of an engine's own calls is told from that of the loop in Python around them."""

import time
from types import SimpleNamespace
from typing import Any

import pytest

from bodycheck import load
from bodycheck.adapters.contract import Method
from bodycheck.studies import cost, engine_calls
from bodycheck.studies.engine_calls import share, watched
from tests.support.processes import calls_here


def spend(seconds: float) -> None:
    """Work for some seconds of the processor, however busy the machine."""
    end = time.thread_time() + seconds
    while time.thread_time() < end:
        pass


def adapter(engine: Any) -> Any:
    return SimpleNamespace(engine=None, prepare=None, calls=((engine, "step"),))


@pytest.fixture(autouse=True)
def processor_time(monkeypatch: pytest.MonkeyPatch) -> None:
    """Seconds of the processor are measured, which do not go by while it does other things."""
    clock = SimpleNamespace(perf_counter=time.thread_time, process_time=time.process_time)
    monkeypatch.setattr(engine_calls, "time", clock)
    monkeypatch.setattr(cost, "time", clock)


@pytest.mark.parametrize("part", [0.1, 0.5, 0.9])
def test_a_known_share_is_found(part: float) -> None:
    engine = SimpleNamespace(step=lambda: spend(part * 2e-3))

    def seconds() -> float:
        start = time.thread_time()
        for _ in range(20):
            engine.step()
            spend((1 - part) * 2e-3)
        return time.thread_time() - start

    found = share(adapter(engine), seconds)
    assert found == pytest.approx(part, abs=0.05)  # a thousandth of what is spent is lost at each call


def test_watched_functions_are_themselves_again() -> None:
    engine = SimpleNamespace(step=print)
    with watched(((engine, "step"),)) as watch:
        engine.step()
    assert (engine.step, watch.calls) == (print, 1)


def test_mujoco_steps_in_c_and_pinocchio_from_python() -> None:
    scene = load("osrf-boxes-complex").scene
    stretches = [
        cost.Stretch(scene, "mujoco", Method.parse("RK4", 0.001), 2000),
        cost.Stretch(scene, "pinocchio", Method.parse("semi-implicit-euler", 0.001), 2000),
    ]
    shares = []  # other work on the machine delays what is outside the engine, so the largest of several shares counts
    for _ in range(5):
        with calls_here():
            mujoco, pinocchio = cost.measure(stretches, limit=60.0, rounds=1)
        assert isinstance(mujoco, cost.Measured)
        assert isinstance(pinocchio, cost.Measured)
        assert mujoco.engine_share is not None
        assert pinocchio.engine_share is not None
        shares.append((mujoco.engine_share, pinocchio.engine_share))
    assert max(share for share, _ in shares) > 0.9 > max(share for _, share in shares) > 0.1
    assert mujoco.setup > 0
