"""The number of threads in which an engine may step."""

import os


def count() -> int:
    """Return the number of processors that this process may use, or fewer if the variable OMP_NUM_THREADS says so.

    The variable is the one by which schedulers and parents of several workers share out processors. Its value may be a list of
    numbers for nested levels, of which the first counts; a value that is no positive integer counts as none.
    """
    there = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    asked = os.environ.get("OMP_NUM_THREADS", "").partition(",")[0].strip()
    return min(there, int(asked)) if asked.isascii() and asked.isdigit() and int(asked) else there
