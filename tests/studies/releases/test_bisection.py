"""The search for the release at which something changed: it finds one, looks at few, and steps around what cannot be told."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bodycheck.errors import BadInput
from bodycheck.studies.releases import bisection
from bodycheck.studies.releases.bisection import Look, NoChange, bisect
from bodycheck.studies.releases.rows import UNOBTAINABLE

told = st.sampled_from([True, False, None])


def row(size: int) -> tuple[str, ...]:
    return tuple(f"1.{place}" for place in range(size))


@given(st.integers(2, 200), st.data())
def test_one_change_is_found_with_as_few_looks_as_halving_takes(size: int, data: st.DataObject) -> None:
    first_bad = data.draw(st.integers(1, size - 1))
    releases = row(size)
    looked: list[str] = []

    def probe(release: str) -> bool:
        looked.append(release)
        return releases.index(release) < first_bad

    found = bisect(releases, probe)
    assert (found.last_good, found.first_bad, found.unknown) == (releases[first_bad - 1], releases[first_bad], ())
    assert len(looked) == len(set(looked)) <= 2 + math.ceil(math.log2(size - 1))
    assert found.probed == tuple(looked)


@given(st.lists(told, max_size=40), st.data())
def test_whatever_the_releases_are_a_change_between_neighbours_that_can_be_told_is_found(
    inner: list[bool | None], data: st.DataObject
) -> None:
    """Also where good and bad alternate, where some cannot be told, and whichever are cheap."""
    states = [True, *inner, False]
    releases = row(len(states))
    cheap = data.draw(st.sets(st.sampled_from(releases)))
    found = bisect(releases, lambda release: states[releases.index(release)], cheap)
    good, bad = releases.index(found.last_good), releases.index(found.first_bad)
    assert states[good] is True
    assert states[bad] is False
    assert good < bad
    assert found.unknown == releases[good + 1 : bad]
    assert all(states[place] is None for place in range(good + 1, bad))
    assert set(found.unknown) <= set(found.probed)


@given(st.integers(3, 100), st.data())
def test_what_is_cheap_is_looked_at_first(size: int, data: st.DataObject) -> None:
    """Of what is dear no more is looked at than halving takes between the two cheap ones around the change."""
    releases = row(size)
    first_bad = data.draw(st.integers(1, size - 1))
    cheap = data.draw(st.sets(st.integers(1, size - 2)))
    found = bisect(releases, lambda release: releases.index(release) < first_bad, {releases[place] for place in cheap})
    below = max([place for place in (0, *cheap) if place < first_bad])
    above = min([place for place in (*cheap, size - 1) if place >= first_bad])
    dear = [release for release in found.probed[2:] if releases.index(release) not in cheap]
    assert len(dear) <= math.ceil(math.log2(above - below))


@pytest.mark.parametrize("ends", [(False, True), (True, True), (False, False), (None, False), (True, None)])
def test_ends_that_are_not_good_and_bad_are_refused(ends: tuple[bool | None, bool | None]) -> None:
    states = dict(zip(("1", "2"), ends, strict=True))
    with pytest.raises(NoChange) as error:
        bisect(("1", "2"), states.__getitem__)
    assert error.value.ends == ends


@pytest.mark.parametrize(
    ("look", "good"),
    [
        (Look("1", "ok", 0.1), True),
        (Look("1", "ok", 0.1000001), False),
        (Look("1", "ok", math.nan), False),
        (Look("1", "diverged", reason="not a number"), False),
        (Look("1", "timeout", reason="stopped"), False),
        (Look("1", "unsupported", reason="it has no integrator"), None),
        (Look("1", UNOBTAINABLE, reason="no wheel"), None),
    ],
)
def test_a_run_that_fails_breaks_a_limit_and_what_cannot_be_run_tells_nothing(look: Look, good: bool | None) -> None:
    assert look.is_good(0.1) is good


def test_a_release_is_not_good_and_bad_at_once() -> None:
    with pytest.raises(BadInput, match=r"1\.0 cannot be both"):
        bisection.between("mujoco", "1.0", "1.0")
