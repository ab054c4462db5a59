"""Check the bounds of the truth's error against multiprecision arithmetic on random bodies of every regime.

The texts of random case files are read twice: by bodycheck, whose truth gives each figure with a bound, and by code of the
tests that shares nothing with it and computes with 120 digits (`tests/support/multiprecision`). A table says for each regime
how many bounds are broken, and how large the bound is as a multiple of the error, or of a rounding where the error is smaller.
The exit status is 1 if a bound is broken or a truth could not be computed.

Run: python benchmarks/truth_bounds.py [--cases 5000] [--seed 0] [--regime separatrix] [--closed-form] [--members]
[--processes 2]
"""

import argparse
import multiprocessing
import sys
import time
import traceback
from collections.abc import Iterable, Sequence
from functools import partial

import numpy as np

from tests.support.bound_checks import UNITS, Check, Figure, check
from tests.support.random_cases import REGIMES

#: Quantiles of bound over error that are printed (%).
QUANTILES = (5, 50, 95, 99, 100)

#: A case, and what was found of it: a check, or the last line of an exception.
Found = tuple[str, int, Check | str]


def main() -> int:
    parser = argparse.ArgumentParser(description="Check the bounds of the truth's error on random bodies.")
    parser.add_argument("--cases", type=int, default=320, help="number of cases, the same in every regime")
    parser.add_argument("--seed", type=int, default=0, help="seed of the first case of each regime")
    parser.add_argument("--regime", action="append", choices=list(REGIMES), help="a regime; by default all of them")
    parser.add_argument("--closed-form", action="store_true", help="leave out the witnesses, which add to the bounds")
    parser.add_argument("--members", action="store_true", help="truths as those of members of ensembles, where cases can be")
    parser.add_argument("--processes", type=int, default=2, help="number of processes")
    options = parser.parse_args()
    regimes = options.regime or list(REGIMES)
    count = -(-options.cases // len(regimes))
    tasks = [(regime, options.seed + n) for n in range(count) for regime in regimes]
    begun, found = time.perf_counter(), []
    examined = partial(examine, vouched=not options.closed_form, member=options.members)
    with multiprocessing.Pool(options.processes, warm_up) as pool:
        for each in pool.imap_unordered(examined, tasks):
            found.append(each)
            if sys.stderr.isatty():
                print(f"\r{len(found)} of {len(tasks)}", end="", file=sys.stderr)
    print(f"{len(tasks)} cases, seeds {options.seed} to {options.seed + count - 1}, {time.perf_counter() - begun:.0f} s")
    checks = [each for _, _, each in found if isinstance(each, Check)]
    print_ratios(regimes, checks)
    print_times(regimes, checks)
    print_broken(checks)
    failures = sorted((regime, seed, why) for regime, seed, why in found if isinstance(why, str))
    for regime, seed, why in failures:
        print(f"no truth of {regime} {seed}: {why}")
    return 1 if failures or any(figure.broken.size for each in checks for figure in each.figures.values()) else 0


def warm_up() -> None:
    """Compute the truth of one case, so that what is done once in a process is not timed."""
    check("turned-frame", 0, vouched=True)


def examine(task: tuple[str, int], vouched: bool, member: bool) -> Found:
    """Check one case of a regime and a seed; the other arguments are those of `check`."""
    try:
        return *task, check(*task, vouched=vouched, member=member)
    except Exception as error:
        return *task, traceback.format_exception_only(error)[-1].strip()


def print_ratios(regimes: Sequence[str], checks: Sequence[Check]) -> None:
    """Print the number of broken bounds and the quantiles of bound over error, by regime and figure."""
    heading = " ".join(f"{f'{quantile} %':>8}" for quantile in QUANTILES)
    print(f"\n{'regime':22} {'bound':23} cases broken  largest error  bound over error: {heading}")
    for regime in (*regimes, "all"):
        for name in UNITS:
            figures = [each.figures[name] for each in checks if regime in (each.regime, "all") and name in each.figures]
            if figures:
                print_row(regime, name, figures)


def print_row(regime: str, name: str, figures: Sequence[Figure]) -> None:
    """Print a row of the table of ratios."""
    broken = sum(figure.broken.size > 0 for figure in figures)
    largest = max(float(figure.error.max()) for figure in figures)
    ratios = np.array([figure.ratio for figure in figures])
    ratios = ratios[~np.isnan(ratios)]
    # Numbers of the sample itself: between infinite ones there is no interpolation.
    shown = np.percentile(ratios, QUANTILES, method="nearest") if ratios.size else [np.nan] * len(QUANTILES)
    parts = " ".join(f"{value:8.3g}" for value in shown)
    unit = UNITS[name] if regime != "all" or name == "error" else ""
    print(f"{regime:22} {name:23} {len(figures):5} {broken:6}  {largest:8.1e} {unit:8}                 {parts}")


def print_times(regimes: Sequence[str], checks: Sequence[Check]) -> None:
    """Print the CPU time of reading a case and of its truth, by regime."""
    print(f"\n{'regime':22} CPU time in ms: reading, median and largest; truth, median and largest")
    for regime in (*regimes, "all"):
        seconds = np.array([each.seconds for each in checks if regime in (each.regime, "all")])
        if len(seconds):
            (reading, truth), (slowest_reading, slowest) = np.median(seconds, axis=0) * 1e3, seconds.max(axis=0) * 1e3
            print(f"{regime:22} {reading:22.2f} {slowest_reading:11.1f} {truth:13.2f} {slowest:11.1f}")


def print_broken(checks: Iterable[Check]) -> None:
    """Print every broken bound, with the seed that draws the case again and the instant of the largest error."""
    for each in sorted(checks, key=lambda each: (each.regime, each.seed)):
        for name, figure in each.figures.items():
            if figure.broken.size:
                n = int(figure.broken[np.argmax(figure.error[figure.broken])])
                what = f"{each.regime} {each.seed}: {name} at t = {float(figure.t[n])!r} s"
                print(f"broken: {what}: error {figure.error[n]:.3e} {UNITS[name]}, bound {figure.bound[n]:.3e}")


if __name__ == "__main__":
    sys.exit(main())
