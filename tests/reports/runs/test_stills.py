"""Small pictures of motions: all bodies are within them, and what does not change is drawn alike."""

import re
from dataclasses import replace

import numpy as np
import pytest

import bodycheck
from bodycheck.reports.runs.motions.stills import HEIGHT, INSTANTS, WIDTH, still


def corners(svg: str) -> np.ndarray:
    """All points (k, 2) of a picture."""
    points = " ".join(re.findall(r'points="([^"]*)"', svg)).split()
    return np.array([[float(number) for number in point.split(",")] for point in points])


@pytest.mark.parametrize(
    "name", ["free-brick", "projectile", "sliding-brick", "double-pendulum", "cart-pole", "block-slides-on-ramp"]
)
def test_a_picture_holds_the_whole_motion(name: str) -> None:
    case = bodycheck.load(name)
    svg = still(case.scene, bodycheck.truth(case).trajectory)
    points = corners(svg)
    assert (points >= 0).all()
    assert (points <= (WIDTH, HEIGHT)).all()
    assert np.ptp(points, axis=0).max() > HEIGHT / 2
    assert svg.count("<polygon") + svg.count("<circle") >= INSTANTS


def test_a_motion_that_is_not_known_has_no_picture() -> None:
    case = bodycheck.load("free-brick")
    motion = bodycheck.truth(case).trajectory
    assert still(case.scene, replace(motion, position=motion.position * np.nan)) == ""


def test_a_pendulum_of_a_link_is_as_long_in_every_outline() -> None:
    """The stick of the only link keeps its length, which is drawn at right angles to the axis of its hinge."""
    case = bodycheck.load("pendulum-large")
    svg = still(case.scene, bodycheck.truth(case).trajectory)
    sticks = [np.ptp(corners(f'points="{one}"'), axis=0) for one in re.findall(r'<polygon points="([^"]*)"', svg)]
    lengths = [float(np.hypot(*stick)) for stick in sticks]
    assert lengths == pytest.approx([lengths[0]] * INSTANTS, abs=0.2)  # coordinates have one decimal
