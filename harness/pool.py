"""Calls in processes of their own, so that one that crashes or hangs takes nothing with it."""

import concurrent.futures
import multiprocessing
import os
from collections.abc import Callable, Iterator, Sequence
from typing import Any, TypeVar

from pebble import ProcessExpired, ProcessPool

from bodycheck.outcome import Crashed, TimedOut

Argument = TypeVar("Argument")
Result = TypeVar("Result")


def call_all(
    function: Callable[[Argument], Result], arguments: Sequence[Argument], jobs: int, limit: float
) -> Iterator[tuple[Argument, Result | Crashed | TimedOut]]:
    """function(argument) for every argument, as they finish, in `jobs` processes; a call over `limit` seconds is killed.

    The function must be importable by name, arguments and results picklable. An error that it raises, or the death of its
    process, is its result.
    """
    context: Any = multiprocessing.get_context("spawn")
    pool: Any = ProcessPool(max_workers=jobs, context=context, initializer=_keep_stdout_clean)
    with pool:
        futures: dict[concurrent.futures.Future[Any], Argument] = {
            pool.schedule(function, args=(argument,), timeout=limit): argument for argument in arguments
        }
        try:
            for future in concurrent.futures.as_completed(futures):
                yield futures[future], _result(future, limit)
        except BaseException:
            pool.stop()
            raise


def _result(future: "concurrent.futures.Future[Any]", limit: float) -> Any:
    try:
        return future.result()
    except TimeoutError:
        return TimedOut(limit)
    except ProcessExpired as error:
        return Crashed(f"its process died with exit code {error.exitcode}")
    except Exception as error:
        return Crashed(f"{type(error).__name__}: {error}")


def _keep_stdout_clean() -> None:
    """What an engine prints goes to stderr: stdout is for results."""
    os.dup2(2, 1)
