"""The content of a case file that is read and checked: the scene, the duration and samples of a run, and expectations.

Worker processes get cases without reading files. The modules that read and check files take long to import, and are not
imported here.
"""

from dataclasses import dataclass
from pathlib import Path as FilePath

import numpy as np

from bodycheck.casefile.distributions import Ensemble
from bodycheck.casefile.expectation import Expectation
from bodycheck.casefile.robot_notes import RobotNotes
from bodycheck.reference.mechanisms.mechanism import AnyScene
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.trajectory import Array

#: Most steps of a run.
MAX_STEPS = 1e9


@dataclass(frozen=True)
class Case:
    """A validated case.

    Parameters
    ----------
    name, title, source, tags
        As in the file.
    scene
        The body, its initial state and its surroundings, or the bodies and joints of a mechanism.
    duration
        The duration of a run (s).
    samples
        The number of sampling times, with both ends included.
    expectations
        The requirements for runs of methods.
    extremes
        The names of axes, each with the values at which a study of extremes tries the case.
    text
        The text of the file, and the text of the robot model that it names.
    ensemble
        The number of members that are drawn from the case, and their distributions; None if the file has no ensemble.
    timestep
        The time step (s) in the file of the robot model that the case names; None if there is none.
    robot
        Notes on the robot model that the case names; None if it names none.
    sensors
        What is read of the motion.
    """

    name: str
    title: str
    source: str
    tags: tuple[str, ...]
    scene: AnyScene
    duration: float
    samples: int
    expectations: tuple[Expectation, ...]
    extremes: tuple[tuple[str, tuple[float, ...]], ...]
    text: str
    ensemble: Ensemble | None = None
    timestep: float | None = None
    robot: RobotNotes | None = None
    sensors: tuple[Sensor, ...] = ()

    @property
    def instants(self) -> Array:
        """Return the sampling times (samples,) of the case, in s."""
        return np.linspace(0.0, self.duration, self.samples)


def check_case(case: object) -> None:
    """Raise `TypeError` for anything that is not a case, for example the name of a case."""
    if not isinstance(case, Case):
        from bodycheck.casefile.raw_values import quote

        meant = f"; did you mean bodycheck.load({case!r})?" if isinstance(case, str | FilePath) else ""
        raise TypeError(f"read {quote(case)} as the case; allowed: what bodycheck.load returns{meant}")
