"""Say what concerns the robots' files of cases, before their runs."""

import sys
from collections.abc import Iterable, Mapping, Sequence

from bodycheck.casefile.content import Case
from bodycheck.running import robot_notices
from bodycheck.running.robot_notices import Robots


def noticed(
    cases: Sequence[Case], jobs: int, quiet: bool, samplings: Mapping[str, Iterable[float]] = robot_notices.NO_SAMPLINGS
) -> Robots:
    """Return what is said of cases with robots' files, after printing it to stderr unless `quiet`.

    jobs, samplings: as in `robot_notices.of`.
    """
    robots = robot_notices.of(cases, jobs, samplings)
    if not quiet:
        tell(robots)
    return robots


def tell(robots: Robots) -> None:
    """Print to stderr what is said of cases with robots' files."""
    for name, sentences in robots.sentences.items():
        for sentence in sentences:
            print(f"{name}: {sentence}", file=sys.stderr)
