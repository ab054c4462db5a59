"""The shipped cases of stacks, of a box pushed under balls and of falling bricks, from the file to the truth."""

import numpy as np
import pytest

from bodycheck import load
from bodycheck.reference.truth import truth
from bodycheck.reference.truths import Truth
from tests.support.commands import bodycheck


def truth_of(name: str) -> Truth:
    case = load(name)
    return truth(case.scene, case.instants)


def test_simbenchmark_has_the_accelerations_of_its_formula() -> None:
    found = truth_of("simbenchmark-rolling")
    speeds = np.linalg.norm(found.trajectory.velocity[:, -1], axis=-1)
    assert speeds / found.trajectory.t[-1] == pytest.approx([0.7385, *25 * [0.211]], abs=1e-15)
    assert found.bounds.position_error.max() < 1e-14
    assert (found.trajectory.position[1:, :, 2] == 1.1).all()


@pytest.mark.parametrize("name", ["stack-of-ten", "stack-mass-ratio"])
def test_stacks_stay_where_they_are(name: str) -> None:
    found = truth_of(name)
    assert np.ptp(found.trajectory.position, axis=1).max() == 0
    assert len(found.interfaces) == len(found.trajectory.position)
    assert found.bounds.velocity_error.max() == 0


@pytest.mark.parametrize("name", ["dropped-brick-corner", "dropped-brick-edge"])
def test_bricks_fall_until_they_hit_the_plane(name: str) -> None:
    found = truth_of(name)
    (event,) = found.events
    after = found.trajectory.t > event.time
    for values in (*vars(found.bounds).values(), found.trajectory.position[:, 2]):
        assert np.array_equal(np.isnan(values), after)


def test_a_motion_that_ends_is_printed(calls_here: None) -> None:
    done = bodycheck("truth", "dropped-brick-corner")
    assert (done.returncode, done.stderr.count("Traceback")) == (0, 0)
    assert "velocity error at most" in done.stdout
