"""Taylor's method in 80-bit, 128-bit and multiprecision arithmetic, with heyoka (Linux only).

heyoka caches compiled code in memory and, for other processes, on disk: in the folder `bodycheck` in heyoka's cache folder
(`$XDG_CACHE_HOME/heyoka` or `$HEYOKA_CACHE_DIR`).
"""

import functools
import math
import os
import stat
import sys
import threading
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import heyoka as hy
import numpy as np

from bodycheck.reference.errors import Stopped
from bodycheck.reference.integration.dop853 import MAX_STEPS
from bodycheck.reference.integration.rotation import WideArray
from bodycheck.reference.trajectory import Array

#: The 128-bit type. heyoka has no separate type where `long double` already has 128 bits (64-bit ARM).
QUADRUPLE = getattr(hy, "real128", np.longdouble)

#: Tolerance for the remainder of the series in a step, for each type: a few roundings, in which a smaller remainder would be
#: lost.
STEP_TOLERANCES = {np.float64: 2.0**-50, np.longdouble: 2.0**-60, QUADRUPLE: 2.0**-109}

#: The same few roundings in bits, for multiprecision arithmetic.
TOLERANCE_BITS = 4

#: Size of a floating-point type in bits, by the number of bits of its mantissa.
BITS_BY_MANTISSA = {52: 64, 63: 80, 112: 128}

#: Name of the solver with NumPy's widest type, in results.
EXTENDED_NAME = f"heyoka-{BITS_BY_MANTISSA[np.finfo(np.longdouble).nmant]}-bit"

#: The level at which LLVM optimises code: higher levels compile a third longer, and the code is not faster.
OPTIMISATION = 1

#: Size limit of the cache of compiled code on disk (bytes). heyoka reads the whole cache in each process that uses it, in 0.3 s
#: for each gigabyte, and would let it grow to 20 GiB. The code of a free body has 1 MB, and that of a large robot up to 25 MB.
DISK_CACHE_BYTES = 512 << 20

#: First-order equations in heyoka's form: pairs of a variable and the expression for its derivative.
Equations = list[tuple[Any, Any]]

#: Held while an integrator runs: a compiled integrator contains its state and is shared by all threads of the process.
integrator_lock = threading.Lock()


@functools.cache
def prepare_heyoka() -> None:
    """Let heyoka cache compiled code on disk only where no other user can write, since cached code is executed.

    heyoka continues without a cache folder that is full, but reports this on standard output, which is reserved for results; so
    its log is limited to critical messages.
    """
    hy.set_logger_level_critical()
    shared = hy.llvm_state.get_diskcache_path()
    folder = shared / "bodycheck"  # so that the limit is not that of other programs
    try:
        private = _is_made_private(shared) and _is_made_private(folder) and all(map(is_private, folder.glob("cache.db*")))
        if private:
            hy.llvm_state.set_diskcache_path(folder)
            hy.llvm_state.set_diskcache_limit(DISK_CACHE_BYTES)
    except (OSError, RuntimeError):  # the cache cannot be made, or is corrupt
        private = False
    hy.llvm_state.set_diskcache_enabled(private)


def _is_made_private(folder: Path) -> bool:
    """Make a folder if it is missing, and return whether it is private."""
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    return is_private(folder)


def is_private(path: Path) -> bool:
    """Return whether a file or folder belongs to this user and no other user may write to it."""
    status = path.stat()
    return sys.platform != "win32" and status.st_uid == os.getuid() and not status.st_mode & (stat.S_IWGRP | stat.S_IWOTH)


@functools.cache
def integrator(equations: Callable[[], Equations], dtype: Any, bits: int | None = None, *, large: bool = False) -> Any:
    """heyoka's integrator of the given equations in a floating-point type, compiled or taken from heyoka's cache.

    bits: the length of the mantissa where the type is heyoka's multiprecision `real`, and None for any other type. large:
    whether the equations are so many that optimising their code would take minutes; it is then not optimised and runs half as
    fast.
    """
    return compiled(equations(), dtype, bits, large=large)


def compiled(system: Equations, dtype: Any, bits: int | None, *, large: bool = False, events: Sequence[Any] = ()) -> Any:
    """Return a new integrator, like `integrator` but without a cache. events: heyoka's events that do not stop it."""
    prepare_heyoka()
    options: dict[str, Any] = {} if bits is None else {"prec": bits}
    zero = dtype(0) if bits is None else hy.real(0, bits)
    return hy.taylor_adaptive(
        system,
        np.full(len(system), zero, dtype=dtype),
        tol=dtype(step_tolerance(dtype, bits)),
        fp_type=dtype,
        # Code that is not compact runs 10 % faster and takes ten times as long to compile.
        compact_mode=True,
        opt_level=0 if large else OPTIMISATION,
        nt_events=list(events),
        **options,
    )


@functools.cache
def vectorised(equations: Callable[[], Equations], lanes: int) -> Any:
    """heyoka's integrator of several motions at once in double precision, with code that is not optimised.

    Vectors of doubles make it almost as fast as an integrator of one motion.
    """
    prepare_heyoka()
    system = equations()
    return hy.taylor_adaptive_batch(
        system,
        np.zeros((len(system), lanes)),
        tol=step_tolerance(np.float64),
        compact_mode=True,
        opt_level=0,
    )


def step_tolerance(dtype: Any, bits: int | None = None) -> float:
    """The tolerance for the remainder of the series in a step, such that the order of the series is no multiple of four.

    heyoka's series have the order 1 - log(tolerance) / 2, rounded up, and a step is as long as their last two coefficients
    allow. If a motion begins at rest where its acceleration does not change to first order, such as the motion of a horizontal
    pendulum, the series of its coordinates have only the powers 2, 6, 10, ... of time, and those of its velocities only the
    powers 1, 5, 9, ...: in a series whose order is a multiple of four, the last two coefficients are zero, and the first step
    would be infinitely long.
    """
    tolerance = STEP_TOLERANCES[dtype] if bits is None else 2.0 ** (TOLERANCE_BITS - bits)
    order = math.ceil(1 - math.log(tolerance) / 2)
    return tolerance if order % 4 else math.exp(1 - 2 * order)  # in the middle of the range that gives one order more


def dense(solver: Any, start: WideArray, parameters: WideArray, end: Any, most: int, limit: int) -> Any:
    """Return the solution of an integrator's equations from t = 0 to `end` as a function of times (n,) with states (n, k).

    The states are those of `solve`. Returns None if the solution has more than `limit` bytes. most, start, parameters: as in
    `solve`, which raises the same exceptions.
    """
    size = (solver.order + 1) * len(start) * start.itemsize
    with integrator_lock:
        solver.time = start.dtype.type(0)
        solver.state[:] = start
        solver.pars[:] = parameters[: len(solver.pars)]
        steps_kept = min(most, limit // size)
        outcome, _, _, steps, solution, _ = solver.propagate_until(end, max_steps=steps_kept, c_output=True)
    if outcome == hy.taylor_outcome.step_limit and steps_kept < most:
        return None
    if outcome != hy.taylor_outcome.time_limit:
        raise _stopped(outcome, steps, solver)
    return solution


def solve(
    solver: Any,
    start: WideArray,
    parameters: WideArray,
    times: Array,
    angles: tuple[str, ...] = (),
    most: int | None = None,
) -> WideArray:
    """Solve the equations of an integrator.

    Parameters
    ----------
    solver
        The integrator, from `integrator`.
    start
        (k,) state at t = 0.
    parameters
        Parameters of the equations; those after the last one that the equations contain are not needed.
    times
        (n,) times >= 0 in any order, in the unit of time of the equations.
    angles
        Names of variables that are reduced to [0, 2 pi), since they would lose digits as they grow.
    most
        The number of steps after which the integration is given up; None for `MAX_STEPS`.

    Returns
    -------
    array
        (n, k) states at the times, in the type of `start`.

    Raises
    ------
    Stopped
        If the integration fails or takes too many steps.
    """
    instants, rows = np.unique(np.append(times[:0].dtype.type(0), times), return_inverse=True)
    reducer = hy.callback.angle_reducer(hy.make_vars(*angles)) if angles else None
    with integrator_lock:
        solver.time = instants.astype(start.dtype)[0]
        solver.state[:] = start
        solver.pars[:] = parameters[: len(solver.pars)]
        grid = instants.astype(start.dtype)
        outcome, _, _, steps, _, solution = solver.propagate_grid(grid, max_steps=most or MAX_STEPS, callback=reducer)
    if outcome != hy.taylor_outcome.time_limit:
        raise _stopped(outcome, steps, solver)
    return np.asarray(solution[rows[1:]])


def _stopped(outcome: Any, steps: int, solver: Any) -> Stopped:
    return Stopped(f"Taylor's method stopped after {steps} steps: {outcome.name}", float(solver.time))
