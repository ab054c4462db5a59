"""In how many threads engines step."""

import pytest

from bodycheck.adapters.mujoco import worlds


@pytest.mark.parametrize(
    ("value", "expected"),
    [(None, 8), ("", 8), ("3", 3), (" 2 , 4", 2), ("100", 8), ("0", 8), ("-1", 8), ("two", 8), ("1.5", 8), ("²", 8)],
)
def test_processors_or_fewer_as_the_environment_says(value: str | None, expected: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("os.sched_getaffinity", lambda process: set(range(8)), raising=False)
    monkeypatch.delenv("OMP_NUM_THREADS", raising=False)
    if value is not None:
        monkeypatch.setenv("OMP_NUM_THREADS", value)
    assert worlds.threads() == expected
