"""Obtain the environments of several releases at once, each in a worker process."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from bodycheck.environments import environments, installation, making
from bodycheck.environments.environments import Environment, Unobtainable
from bodycheck.processes import pool
from bodycheck.processes.failures import Crashed, TimedOut

if TYPE_CHECKING:  # the processes that inspect releases need not import a campaign
    from bodycheck.running.campaign import Advance

#: Memory (bytes) that an installation may use: more than any machine has, because installers need no limit.
INSTALLATION_MEMORY_BYTES = 1 << 40


def obtain_all(engine: str, versions: Sequence[str], jobs: int, progress: "Advance") -> dict[str, Environment | Unobtainable]:
    """Obtain the environments of several releases at once.

    Parameters
    ----------
    engine
        The name of the engine.
    versions
        The releases; repeated releases count once.
    jobs
        The number of processes.
    progress
        A function that is called when a release is done.

    Returns
    -------
    dict
        The environment of each version, or the error that says why there is none.
    """
    tasks = [(engine, version) for version in dict.fromkeys(versions)]
    limit = len(making.ATTEMPTS) * installation.CALL_LIMIT_S
    obtained: dict[str, Environment | Unobtainable] = {}
    with pool.Workers(_try_to_obtain, jobs, limit, INSTALLATION_MEMORY_BYTES) as workers:
        for (_, version), result in workers.map(tasks):
            match result:
                case Crashed() | TimedOut():
                    obtained[version] = Unobtainable(f"{engine}@{version}: {result.reason}")
                case _:
                    obtained[version] = result
            progress(f"{engine}@{version}")
    return {version: obtained[version] for _, version in tasks}


def _try_to_obtain(task: tuple[str, str]) -> Environment | Unobtainable:
    try:
        return environments.obtain(*task)
    except Unobtainable as error:
        return error
