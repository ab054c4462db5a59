"""Measure how often intervals are right: the coverage and the width of the intervals of each class of scenes.

A member of a class is a shipped case whose initial velocities, gravity and duration are drawn, with a method and a time step
that are drawn too. Its time step is refined three times, and one of the four runs and one quantity are drawn. In smooth and
driven classes the error of this run is its distance from the truth. In the other classes, whose engines have limits of their
own, it is the distance from a run with a time step 64 times smaller, whose own error is some ten times smaller.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from statistics import median

import numpy as np

from bodycheck.adapters import registry
from bodycheck.adapters.contract import Engine, Method
from bodycheck.adapters.engine_name import in_words
from bodycheck.adapters.offers import integrator_of, offered
from bodycheck.casefile.case import load
from bodycheck.casefile.content import Case
from bodycheck.console import terminal
from bodycheck.console.arguments import load_engines
from bodycheck.console.output import say
from bodycheck.console.progress import progress
from bodycheck.errors import BadInput
from bodycheck.processes import pool
from bodycheck.reference.errors import NotModelled, OutOfReach
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array
from bodycheck.running import engines, truths
from bodycheck.running.refining import Ended, Motion, RunCase, run_case
from bodycheck.studies.estimate import factors, refinement
from bodycheck.studies.estimate.distances import differences
from bodycheck.studies.estimate.factors import KINDS, Factor, Kind
from bodycheck.studies.estimate.levels import instants_of, own_steps
from bodycheck.studies.estimate.method import ERROR, FINER, Refined, Run, Subject, refined
from bodycheck.studies.estimate.quantities import PLACES
from bodycheck.studies.estimate.refinement import Reference

#: The shipped cases whose members are drawn, by classes.
CASES: dict[Kind, tuple[str, ...]] = {
    "smooth": ("free-brick", "intermediate-axis-flip", "football-wobble", "pendulum-large", "hinge-spring"),
    "driven": ("driven-hinge-continuous", "driven-hinge-sine", "driven-hinge-sampled", "driven-wheel-effort"),
    "dry friction": ("hinge-friction", "slider-friction"),
    "soft contact": ("sliding-brick", "rolling-ball", "ball-slips-rolls-rests", "block-slides-on-ramp"),
    "impacts": ("dropped-ball", "thrown-ball-with-spin", "spheres-head-on"),
}

#: The classes whose error is the distance from the truth.
WITH_TRUTH = ("smooth", "driven")

#: The number of members of each class with a truth, and of each other class, whose runs take longer.
MEMBERS, MEMBERS_BY_REFINEMENT = 5000, 500

#: The seed of the members with which the shipped factors were set; `--calibrate` draws others.
SEED_OF_FACTORS = 1

#: The ratio of the time step of a run to that of the run whose distance is its error.
FINER_BY = 64

#: The longest duration (s) of a member, and the time step (s) about which its own is drawn.
LONGEST, TIMESTEP = 2.0, 2e-3

#: The number of members that one call measures, and the time limit (s) of a call.
IN_PORTION, LIMIT = 25, 1200.0

#: The share of intervals that factors are set for, in classes with a truth and in others, and the factors that are tried.
SHARE, SHARE_BY_REFINEMENT = 0.97, 0.93
TRIED = tuple(1 + 0.05 * step for step in range(2, 61))


@dataclass(frozen=True)
class Member:
    """A member of a class: the engine, the class, the seed, and its number."""

    engine: str
    kind: Kind
    seed: int
    number: int


@dataclass(frozen=True)
class Portion:
    """Consecutive members of a class, which one call measures: the class, the seed, and the numbers of the members."""

    engine: str
    kind: Kind
    seed: int
    numbers: range


@dataclass(frozen=True)
class Measured:
    """The interval of a member for each factor of `TRIED`, and its error; empty if there is no estimate."""

    low: tuple[float, ...] = ()
    high: tuple[float, ...] = ()
    error: float = math.nan


def portion(asked: Portion) -> list[Measured]:
    """Return what was measured of the members of a portion; those that cannot be run are left out."""
    members = (Member(asked.engine, asked.kind, asked.seed, number) for number in asked.numbers)
    return [one for one in map(measured, members) if one is not None]


def measured(member: Member) -> Measured | None:
    """Return the intervals and the error of a member; None if the scene cannot be run, or has no truth."""
    rng = np.random.default_rng([member.seed, KINDS.index(member.kind), member.number])
    engine = registry.load(member.engine).engine
    case = drawn(load(str(rng.choice(CASES[member.kind]))), rng)
    method = _method(engine, case.scene, rng)
    if method is None:
        return None
    subject = Subject(case.instants, case.scene, ERROR, PLACES, lambda _: 1.5, coarser=0, most_finer=FINER)

    def run(one: Method, times: Array, nudged: bool) -> Motion | Ended:
        return run_case(RunCase(member.engine, case, one, times, nudged))

    integrator = integrator_of(engine, method)
    known = refined(subject, method, run, float(integrator.order or math.inf) if integrator is not None else math.inf)
    if isinstance(known, Ended) or len(known.levels.levels) <= FINER:
        return None
    if known.chaos is not None:
        return Measured()
    quantity = str(rng.choice([name for name in known.levels.quantities if name in PLACES]))
    index = int(rng.integers(FINER + 1))
    intervals = list(_intervals(known, quantity, index))
    if not intervals:
        return Measured()
    error = _error(member, case, known, quantity, index, run)
    low, high = zip(*intervals, strict=True)
    return None if error is None else Measured(tuple(low), tuple(high), error)


def drawn(case: Case, rng: np.random.Generator) -> Case:
    """Return a case with initial velocities, gravity and duration that are drawn."""
    scale = float(rng.uniform(0.5, 1.5))
    gravity = case.scene.gravity * float(rng.uniform(0.8, 1.2))
    duration = min(case.duration, LONGEST) * float(rng.uniform(0.5, 1.0))
    scene: AnyScene
    if isinstance(case.scene, Mechanism):
        joints = tuple(
            replace(joint, start_velocity=tuple(scale * value for value in joint.start_velocity)) for joint in case.scene.joints
        )
        bodies = tuple(
            body
            if body.start is None
            else replace(body, start=replace(body.start, velocity=_scaled(body.start.velocity, scale)))
            for body in case.scene.bodies
        )
        scene = replace(case.scene, joints=joints, bodies=bodies, gravity=gravity)
    else:
        assert isinstance(case.scene, Scene)
        state = case.scene.initial
        moved = replace(state, velocity=_scaled(state.velocity, scale), angular_velocity=_scaled(state.angular_velocity, scale))
        scene = replace(case.scene, initial=moved, gravity=gravity)
    return replace(case, scene=scene, duration=duration, samples=51)


def _scaled(vector: tuple[float, float, float], scale: float) -> tuple[float, float, float]:
    x, y, z = vector
    return scale * x, scale * y, scale * z


def _method(engine: Engine, scene: AnyScene, rng: np.random.Generator) -> Method | None:
    """Return a method with a time step (s), drawn from those of the engine without options; None if there is none."""
    names = [name for name in offered(engine, scene) if ":" not in name]
    step = TIMESTEP * 2.0 ** float(rng.uniform(-1, 2))
    return Method.parse(str(rng.choice(names)), 0.0).at(step) if names else None


def _intervals(known: Refined, quantity: str, index: int) -> Iterator[tuple[float, float]]:
    """Yield the ends of the interval of a run with each factor; nothing if it has no estimate with the smallest one."""
    end, count = float(known.levels.instants[-1]), len(known.levels.levels)
    if isinstance(known.assessed(quantity, end), str):
        return
    apart, nudge = known.apart(quantity, end), known.levels.nudge(quantity, end)
    for factor in TRIED:
        seen = refinement.reference(apart, count, nudge, known.levels.levels[-1].motion.steps, factor, known.order)
        rounding = refinement.accumulated(nudge, known.levels.levels[index].motion.steps)
        interval = refinement.interval(seen, apart, count, index, rounding, factor) if isinstance(seen, Reference) else None
        if interval is None and factor == TRIED[0]:
            return
        yield (0.0, math.inf) if interval is None else (interval.low, interval.high)


def _error(member: Member, case: Case, known: Refined, quantity: str, index: int, run: Run) -> float | None:
    """Return the error of a run; None if it is not known."""
    level = known.levels.levels[index]
    steps = own_steps(case.instants, level.timestep)
    motion = level.motion.part(np.searchsorted(level.steps, steps))
    assert motion.trajectory is not None
    if member.kind in WITH_TRUTH:
        try:
            exact = truths.truth(case, tuple(motion.t.tolist())).trajectory
        except (NotModelled, OutOfReach):
            return None
        finer = replace(motion, trajectory=exact)
    else:
        step = level.timestep / FINER_BY
        outcome = run(known.method.at(step), instants_of(steps * FINER_BY, step), False)
        if isinstance(outcome, Ended) or outcome.trajectory is None:
            return None
        finer = replace(outcome, t=motion.t, trajectory=replace(outcome.trajectory, t=motion.t))
    return float(np.nanmax(differences(case.scene, motion, finer)[quantity]))


def factor_of(engine: str, members: Sequence[Measured], index: int) -> Factor:
    """Return a factor of `TRIED` with the coverage and the width of its intervals."""
    known = [one for one in members if one.low]
    inside = [one.low[index] <= one.error <= one.high[index] for one in known]
    widths = [(one.high[index] - one.low[index]) / one.error for one in known if one.error > 0]
    width = median(widths) if widths else 0.0
    return Factor(TRIED[index], sum(inside) / max(1, len(known)), width, len(known), len(members) - len(known), engine)


def smallest(kind: Kind, engine: str, members: Sequence[Measured]) -> Factor:
    """Return the smallest factor whose intervals have the share of coverage that is wanted; the largest if none has."""
    share = SHARE if kind in WITH_TRUTH else SHARE_BY_REFINEMENT
    tried = (factor_of(engine, members, index) for index in range(len(TRIED)))
    return next((one for one in tried if one.coverage >= share), factor_of(engine, members, len(TRIED) - 1))


def samples(engine: str, kind: Kind, seed: int, count: int, jobs: int, quiet: bool) -> list[Measured]:
    """Return what was measured of the members of a class."""
    portions = [
        Portion(engine, kind, seed, range(first, min(count, first + IN_PORTION))) for first in range(0, count, IN_PORTION)
    ]
    done = []
    with (
        pool.Workers(portion, jobs, LIMIT, group=_engine, home=engines.home) as workers,
        progress(kind, count, quiet) as advance,
    ):
        for asked, answer in workers.map(portions):
            done += answer if isinstance(answer, list) else []
            advance(kind, len(asked.numbers))
    return done


def _engine(asked: Portion) -> str:
    return asked.engine


def printed(names: tuple[str, ...], members: int | None, seed: int, jobs: int, *, json: bool, quiet: bool) -> int:
    """Measure and print the coverage of the shipped factors, and the factors that the drawn members need.

    members: the number of members of each class; None for those of the documentation. Return the exit code: 1 if the coverage
    of a class is less than it should be.
    """
    if seed == SEED_OF_FACTORS:
        raise BadInput(f"--seed {seed}: is that of the scenes with which the factors were set; allowed: another one")
    (engine, record), *_ = load_engines(names or ("mujoco",)).records.items()
    rows = []
    for kind in KINDS:
        count = members or (MEMBERS if kind in WITH_TRUTH else MEMBERS_BY_REFINEMENT)
        seen = samples(engine, kind, seed, count, jobs, quiet)
        shipped = factors.factors()[kind].factor
        index = min(range(len(TRIED)), key=lambda index: abs(TRIED[index] - shipped))
        named = in_words(engine, record.version)
        rows.append((kind, factor_of(named, seen, index), smallest(kind, named, seen)))
        if not quiet and not json:
            say(f"{kind}: the shipped factor {shipped:g} {rows[-1][1].told}; {rows[-1][1].refused} runs have no estimate")
    if json:
        terminal.print_json([{"kind": kind, "shipped": asdict(one), "smallest": asdict(other)} for kind, one, other in rows])
    needed = {kind: 0.95 if kind in WITH_TRUTH else 0.9 for kind in KINDS}
    return int(any(one.sample and one.coverage < needed[kind] for kind, one, _ in rows))
