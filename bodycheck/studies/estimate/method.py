"""Refine the time step of one method of an engine on a scene until its errors can be estimated, and search the largest step.

The runs are made by a function that the caller gives, so that this module knows neither engines nor processes.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations, pairwise

import numpy as np

from bodycheck.adapters.contract import Method
from bodycheck.reference.mechanisms.mechanism import AnyScene
from bodycheck.reference.trajectory import Array
from bodycheck.running.refining import Ended, Motion
from bodycheck.studies.estimate import refinement
from bodycheck.studies.estimate.factors import Kind, factors
from bodycheck.studies.estimate.levels import Level, Levels, instants_of, sampled_steps
from bodycheck.studies.estimate.quantities import ANGLES, NAMED, OF_ONE_RUN, PLACES
from bodycheck.studies.estimate.refinement import Interval, Reference

#: The error (rad or m) that is allowed if none is named, and from which on the difference that one rounding makes is chaos.
ERROR = 1e-3

#: The largest number of coarser levels, and the fewest steps of the coarsest one.
COARSER, FEWEST_STEPS = 6, 10

#: The number of finer levels that every method gets, and the largest number of them if the differences fall evenly or not.
FINER, MOST_FINER, MOST_UNEVEN = 3, 9, 6

#: The angle (rad) between the two finest runs from which on no difference between runs shows an order.
FAR = 0.3

#: The part of the allowed error below which differences between all runs do not matter to a search.
NEGLIGIBLE = 0.1

#: The largest number of instants that are tried as the end of the time until which there is an estimate.
MOST_INSTANTS = 200

#: The part of the own error to which that of the finest run must fall before the refinement ends, and the ratio of that error
#: to the allowed one up to which further levels are run, so that one of them keeps the allowed error.
RESOLVED, NEAR_ALLOWED = 0.03, 6.0

#: The ratio of the smallest step that breaks the error to the largest that keeps it at which a search ends, the largest number
#: of steps that a search tries, and the ratio of the error of a step to that of the finer run with which it is compared.
NEAR, MOST_TRIES, PARTNER = 1.04, 6, 16.0


class NoTime(Exception):
    """There is no time left for a run; the text says what was measured."""


#: A function that makes a run: with a method, sampled at instants (n,), s, nudged or not. Raises `NoTime`.
Run = Callable[[Method, Array, bool], Motion | Ended]


@dataclass(frozen=True, eq=False)
class Subject:
    """The scene that is run.

    Attributes
    ----------
    instants
        The instants (n,), s, at which errors are compared.
    scene
        The scene of a case; None for a file.
    error
        The error that is allowed, in the unit of the quantities.
    compared
        The quantities that are compared with it.
    kind
        A function from the finest motion to the class of the scene.
    held
        The instants at which controls change (k,), s: all time steps must reach them.
    coarser, most_finer
        The largest numbers of coarser and of finer levels.
    wanted
        The quantities of a case whose differences are computed.
    """

    instants: Array
    scene: AnyScene | None
    error: float
    compared: tuple[str, ...]
    kind: Callable[[Motion], Kind]
    held: Array = field(default_factory=lambda: np.empty(0))
    coarser: int = COARSER
    most_finer: int = MOST_FINER
    wanted: tuple[str, ...] = NAMED


@dataclass(frozen=True, eq=False)
class Refined:
    """The runs of one method.

    Attributes
    ----------
    method
        The method with the time step of the file (s).
    levels
        The runs that completed.
    ended
        The runs that did not, by their time steps (s).
    pairs
        For each step that the search tried: the run, the finer run with which it is compared, and its own error relative to
        the reference's.
    chaos
        The first instant (s) at which one rounding makes a difference above the allowed error; None if never.
    out_of_time
        What was measured when the time was used up; empty if it was not.
    kind
        The class of the scene.
    stray
        The runs that completed although one with a smaller time step did not, so that they cannot be compared.
    order
        The order that the engine claims for the method; infinite if it claims none.
    """

    method: Method
    levels: Levels
    ended: dict[float, Ended]
    kind: Kind = "smooth"
    chaos: float | None = None
    out_of_time: str = ""
    pairs: tuple[Levels, ...] = ()
    stray: tuple[Level, ...] = ()
    order: float = math.inf

    @property
    def factor(self) -> float:
        """The safety factor of the class."""
        return factors()[self.kind].factor

    def apart(self, quantity: str, until: float, at_end: bool = False) -> dict[tuple[int, int], float]:
        """Return the differences between all levels until an instant (s)."""
        pairs = combinations(range(len(self.levels.levels)), 2)
        return {(one, other): self.levels.value(quantity, one, other, until, at_end) for one, other in pairs}

    def assessed(self, quantity: str, until: float, at_end: bool = False) -> Reference | str:
        """Return the reference of a quantity until an instant (s), or why there is none."""
        count = len(self.levels.levels)
        steps = self.levels.levels[-1].motion.steps if count else 0
        nudge = self.levels.nudge(quantity, until)
        if count > 1 and (far := self._far(until)) > FAR:
            return f"the finest runs still differ by {far:.2g} rad"
        return refinement.reference(self.apart(quantity, until, at_end), count, nudge, steps, self.factor, self.order)

    def _far(self, until: float) -> float:
        """Return the largest angle (rad) between the two finest runs until an instant (s)."""
        last = len(self.levels.levels) - 1
        angles = [name for name in ANGLES if name in self.levels.quantities]
        return max((self.levels.value(name, last - 1, last, until) for name in angles), default=0.0)

    def intervals(self, quantity: str, until: float, known: Reference, at_end: bool = False) -> list[Interval | None]:
        """Return the estimate of the error of each level until an instant (s); None for a level without one."""
        nudge, count = self.levels.nudge(quantity, until), len(self.levels.levels)
        roundings = [refinement.accumulated(nudge, level.motion.steps) for level in self.levels.levels]
        if quantity in OF_ONE_RUN:
            drifts = [self.levels.value(quantity, level, count - 1, until, at_end) for level in range(count)]
            if known.kind == "uneven":
                return [None] * count
            return [refinement.around(one, 0.0, rounding, self.factor) for one, rounding in zip(drifts, roundings, strict=True)]
        apart = self.apart(quantity, until, at_end)
        return [refinement.interval(known, apart, count, level, roundings[level], self.factor) for level in range(count)]

    def of_pair(self, pair: Levels, quantity: str, known: Reference, at_end: bool = False) -> tuple[Interval, Interval]:
        """Return the estimates of the errors of a step that the search tried, and of its finer run, over the whole time.

        Nothing is finer than the second run: its error is between those of the levels beside it, or the reference's, scaled.
        """
        end = float(pair.instants[-1])
        nudge = refinement.accumulated(self.levels.nudge(quantity, end), pair.levels[1].motion.steps)
        if quantity in OF_ONE_RUN:
            drifts = [pair.value(quantity, index, 1, end, at_end) for index in range(2)]
            coarse, fine = (refinement.around(value, 0.0, nudge, self.factor) for value in drifts)
            return coarse, fine
        apart = pair.value(quantity, 0, 1, end, at_end)
        if known.kind == "rounding":
            size = max(apart, nudge)
            return refinement.around(0.0, 0.0, size, self.factor), refinement.around(0.0, 0.0, size, self.factor)
        factor = self.factor * known.loose
        beside = () if known.borrowed else self.intervals(quantity, end, known, at_end)
        error = self._on_power_law(pair.levels[1].timestep, beside, known)
        around = refinement.either_way if known.borrowed else refinement.around
        return around(apart, error, nudge, factor), around(0.0, error, nudge, factor)

    def _on_power_law(self, timestep: float, intervals: Sequence[Interval | None], known: Reference) -> float:
        """Return the error at a time step (s), on the power law through the estimates of the levels beside it.

        Where the levels beside it have none, the error is that of the reference, scaled by its order.
        """
        for one, other, (coarse, fine) in zip(intervals, intervals[1:], pairwise(self.levels.levels), strict=False):
            inside = fine.timestep <= timestep <= coarse.timestep
            if inside and one is not None and other is not None and one.estimate > 0 and other.estimate > 0:
                slope = refinement.order(one.estimate, other.estimate, coarse.timestep / fine.timestep)
                return float(other.estimate * (timestep / fine.timestep) ** slope)
        return float(known.error * (timestep / self.levels.levels[known.level].timestep) ** known.order)


def refined(subject: Subject, method: Method, run: Run, order: float = math.inf) -> Refined | Ended:
    """Return the runs of a method with the time step of the file and with coarser and finer ones.

    Return how the run with the own step ended if the engine cannot make it. order: that which the engine claims.
    """
    duration = float(subject.instants[-1])
    coarser = max(0, min(subject.coarser, math.floor(math.log2(duration / FEWEST_STEPS / method.timestep) + 1e-9)))
    done: dict[int, Level] = {}
    ended: dict[float, Ended] = {}
    out_of_time = ""

    def go(exponent: int) -> None:
        timestep = method.timestep * 2.0**exponent
        if exponent > 0 and not _reaches(subject.held, timestep):
            return
        steps = sampled_steps(subject.instants, timestep, coarser - exponent)
        outcome = run(method.at(timestep), instants_of(steps, timestep), False)
        if isinstance(outcome, Motion):
            done[exponent] = Level(timestep, steps, outcome)
        else:
            ended[timestep] = outcome

    known = Refined(method, Levels(subject.instants, subject.scene, (), wanted=subject.wanted), ended, order=order)
    try:
        go(0)
        if 0 not in done and next(iter(ended.values())).status not in ("diverged", "reset"):
            return ended[method.timestep]
        for exponent in range(-1, -FINER - 1, -1):
            go(exponent)
        for exponent in range(1, coarser + 1):
            go(exponent)
        known = _with_nudge(subject, _so_far(subject, known, done), run)
        for exponent in range(-FINER - 1, -subject.most_finer - 1, -1):
            if known.chaos is not None or _resolved(subject, known) or (-exponent > MOST_UNEVEN and _uneven(subject, known)):
                break
            go(exponent)
            known = _so_far(subject, known, done)
    except NoTime as error:
        out_of_time = str(error)
    return replace(_so_far(subject, known, done), ended=ended, out_of_time=out_of_time)


def _reaches(held: Array, timestep: float) -> bool:
    """Return whether steps of a size (s) end at all instants (k,), s."""
    return bool(np.all(np.abs(held / timestep - np.rint(held / timestep)) < 1e-6))


def _so_far(subject: Subject, known: Refined, done: dict[int, Level]) -> Refined:
    """Return the runs so far: the completed levels from the finest on that follow one another."""
    exponents = sorted(done)
    consecutive = [exponent for index, exponent in enumerate(exponents) if exponent == exponents[0] + index]
    levels = tuple(done[exponent] for exponent in reversed(consecutive))
    kind = subject.kind(levels[-1].motion) if levels else known.kind
    stray = tuple(done[exponent] for exponent in reversed(exponents) if exponent not in consecutive)
    runs = replace(known.levels, levels=levels, known={})
    return replace(known, levels=runs, kind=kind, stray=stray)


def _resolved(subject: Subject, known: Refined) -> bool:
    """Return whether the error of each compared quantity is known, and small beside that of the own step or the allowed one."""
    present = next((index for index, one in enumerate(known.levels.levels) if one.timestep == known.method.timestep), None)
    for quantity in (name for name in known.levels.quantities if name in subject.compared):
        seen = known.assessed(quantity, float(subject.instants[-1]))
        if isinstance(seen, str) or present is None:
            return False
        intervals = known.intervals(quantity, float(subject.instants[-1]), seen)
        first, finest = intervals[present], intervals[-1]
        if first is None or finest is None:
            return False
        if finest.low > 0 and (finest.high if seen.loose > 1 else finest.estimate) > RESOLVED * first.estimate:
            return False
        if subject.error < finest.high <= NEAR_ALLOWED * subject.error:
            return False
    return True


def _uneven(subject: Subject, known: Refined) -> bool:
    """Return whether the differences of a compared quantity do not fall evenly."""
    seen = (known.assessed(name, float(subject.instants[-1])) for name in known.levels.quantities if name in subject.compared)
    return any(isinstance(one, str) or one.kind == "uneven" for one in seen)


def _with_nudge(subject: Subject, known: Refined, run: Run) -> Refined:
    """Return the runs with the instant from which on one rounding makes a difference above the allowed error.

    Raises `NoTime`.
    """
    if not known.levels.levels:
        return known
    finest = known.levels.levels[-1]
    nudged = run(known.method.at(finest.timestep), instants_of(finest.steps, finest.timestep), True)
    if isinstance(nudged, Ended):
        return known
    levels = replace(known.levels, nudged=(finest, nudged))
    places = tuple(name for name in subject.compared if name in PLACES) or PLACES
    return replace(
        known, levels=levels, chaos=levels.divergence(places, subject.error if subject.compared[0] in PLACES else ERROR)
    )


def searched(subject: Subject, known: Refined, run: Run) -> Refined:
    """Return the runs with those of a search for the largest time step that keeps the error.

    Every step that is tried divides the duration, and is compared with a run whose step is smaller by a power of two. There is
    no search where the differences do not fall evenly.
    """
    end = float(subject.instants[-1])
    last = len(known.levels.levels) - 1
    names = [name for name in known.levels.quantities if name in subject.compared]
    relevant = [name for name in names if known.levels.value(name, 0, last, end) > NEGLIGIBLE * subject.error]
    seen = {name: known.assessed(name, end) for name in names}
    references = {name: one for name, one in seen.items() if isinstance(one, Reference) and one.kind != "uneven"}
    if known.chaos is not None or len(subject.held) or not references or not references.keys() >= set(relevant):
        return known
    bracket = _bracket(_highs(known, references, end), subject.error, end / FEWEST_STEPS)
    pairs: list[Levels] = []
    try:
        for _ in range(MOST_TRIES):
            if bracket is None or bracket[1][0] / bracket[0][0] <= NEAR:
                break
            step = end / _between(bracket, subject.error, end)
            if not bracket[0][0] * (1 + 1e-9) < step < bracket[1][0] * (1 - 1e-9):
                break
            pair = _pair(subject, known, step, references, run)
            high = math.inf
            if pair is not None:
                pairs.append(pair)
                high = max(known.of_pair(pair, name, each)[0].high for name, each in references.items())
            bracket = ((step, high), bracket[1]) if high <= subject.error else (bracket[0], (step, high))
    except NoTime:
        pass
    return replace(known, pairs=tuple(pairs))


def _highs(known: Refined, references: Mapping[str, Reference], end: float) -> list[tuple[float, float]]:
    """Return the time step (s) of each level, and the largest upper end of its errors."""
    columns = [known.intervals(name, end, each) for name, each in references.items()]
    highs = [max(math.inf if one is None else one.high for one in row) for row in zip(*columns, strict=True)]
    return [(level.timestep, high) for level, high in zip(known.levels.levels, highs, strict=True)]


#: A time step (s) and the upper end of its error.
_Tried = tuple[float, float]


def _bracket(highs: Sequence[_Tried], error: float, largest: float) -> tuple[_Tried, _Tried] | None:
    """Return the largest step that keeps an error with all smaller ones, and the next larger one; None if there is no such.

    largest: the largest step (s) that is of use, which counts as one that breaks the error if all steps keep it.
    """
    kept: _Tried | None = None
    for step, high in (*reversed(highs), (largest, math.inf)):
        if high > error:
            return None if kept is None else (kept, (step, high))
        kept = step, high
    return None


def _between(bracket: tuple[_Tried, _Tried], error: float, duration: float) -> int:
    """Return the number of steps of the run that a search tries next: where the error is expected, or in the middle."""
    (small, below), (large, above) = bracket
    middle = math.sqrt(small * large)
    if math.isfinite(above) and 0 < below < above:
        share = math.log(error / below) / math.log(above / below)
        middle = small * (large / small) ** min(0.95, max(0.05, share))
    return max(1, math.ceil(duration / middle))


def _pair(subject: Subject, known: Refined, timestep: float, references: dict[str, Reference], run: Run) -> Levels | None:
    """Return a run with a time step and a finer one; None if one of them does not complete. Raises `NoTime`."""
    orders = [each.order for each in references.values() if each.kind == "even"] or [1.0]
    halvings = max(2, min(5, math.ceil(math.log2(PARTNER) / max(refinement.LEAST_ORDER, min(orders)))))
    levels = []
    for coarser, step in ((0, timestep), (1, timestep / 2**halvings)):
        steps = sampled_steps(subject.instants, step, coarser, 2**halvings)
        outcome = run(known.method.at(step), instants_of(steps, step), False)
        if isinstance(outcome, Ended):
            return None
        levels.append(Level(step, steps, outcome))
    return Levels(subject.instants, subject.scene, tuple(levels), wanted=subject.wanted)


def horizons(subject: Subject, known: Refined, quantity: str) -> list[tuple[float, Interval, Reference] | None]:
    """Return for each level the last instant (s) until which its largest error is estimated, with the estimate.

    None for a level that has no estimate at any of the instants, at most `MOST_INSTANTS` of which are tried.
    """
    end = float(subject.instants[-1]) if known.chaos is None else known.chaos
    allowed = subject.instants[(subject.instants > 0) & ((subject.instants < end) | (known.chaos is None))]
    tried = allowed[:: -max(1, math.ceil(len(allowed) / MOST_INSTANTS))]
    last: list[tuple[float, Interval, Reference] | None] = [None] * len(known.levels.levels)
    for until in tried.tolist():
        seen = known.assessed(quantity, until)
        if isinstance(seen, Reference):
            for index, interval in enumerate(known.intervals(quantity, until, seen)):
                if last[index] is None and interval is not None:
                    last[index] = until, interval, seen
        if all(one is not None for one in last):
            break
    return last
