"""Members of the classes of scenes, on which coverage is measured, and what is measured of one of them.

A member is a shipped case whose initial velocities, gravity and duration are drawn, with a method and a time step that are
drawn too. Its time step is refined three times, and one of the four runs and one quantity are drawn. In smooth and driven
classes the error of this run is its distance from the truth. In the other classes, whose engines have limits of their own, it
is the distance from a run with a time step 64 times smaller, whose own error is at most some ten times smaller.

What is measured of a member are the differences between its runs, from which the interval follows with any safety factor.
"""

import math
from dataclasses import dataclass, replace
from functools import cache
from itertools import combinations

import numpy as np

from bodycheck.adapters import registry
from bodycheck.adapters.contract import Engine, Method
from bodycheck.adapters.offers import integrator_of, offered
from bodycheck.casefile.case import load
from bodycheck.casefile.content import Case
from bodycheck.reference import truth
from bodycheck.reference.errors import NotModelled, OutOfReach
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array
from bodycheck.running.refining import Ended, Motion, RunCase, run_case
from bodycheck.studies.estimate.distances import differences
from bodycheck.studies.estimate.factors import KINDS, Kind
from bodycheck.studies.estimate.levels import instants_of, own_steps
from bodycheck.studies.estimate.method import ERROR, FAR, FINER, Refined, Run, Subject, refined
from bodycheck.studies.estimate.quantities import ANGLES, PLACES
from bodycheck.studies.timesteps import control_period

#: The shipped cases whose members are drawn, by classes.
CASES: dict[Kind, tuple[str, ...]] = {
    "smooth": ("free-brick", "intermediate-axis-flip", "football-wobble", "pendulum-large", "hinge-spring"),
    "driven": ("driven-hinge-continuous", "driven-hinge-sine", "driven-hinge-sampled", "driven-wheel-effort"),
    "dry friction": ("hinge-friction", "slider-friction"),
    "soft contact": ("sliding-brick", "rolling-ball", "ball-slips-rolls-rests", "block-slides-on-ramp"),
    "impacts": ("dropped-ball", "thrown-ball-with-spin", "spheres-head-on"),
}

#: The classes whose error is the distance from the truth.
WITH_TRUTH: tuple[Kind, ...] = ("smooth", "driven")

#: The ratio of the time step of a run to that of the run whose distance is its error.
FINER_BY = 64

#: The longest durations (s) of members, by classes. They are short so that many members can be run: a controller is called in
#: each step, and the error of a run with friction or contact needs a run with a time step that is 64 times smaller.
LONGEST: dict[Kind, float] = {"smooth": 1.0, "driven": 0.25, "dry friction": 0.5, "soft contact": 0.5, "impacts": 1.0}

#: The smallest and the largest time step (s) that are drawn, and the number of the instants of a member.
TIMESTEPS, SAMPLES = (2e-3, 8e-3), 26

#: The largest number of steps of the run from which an error is measured.
MOST_STEPS = 200_000


@dataclass(frozen=True)
class Member:
    """A member of a class: the engine, the class, the seed, and its number."""

    engine: str
    kind: Kind
    seed: int
    number: int


@dataclass(frozen=True)
class Measured:
    """The measurements of a member: one run of four, and one quantity.

    Attributes
    ----------
    case, method, timestep, quantity, level
        The case, the method, the time step of the run (s), the quantity, and the index of the run among the four.
    refused
        Why there is no estimate; empty if the differences decide.
    differences
        The differences between the runs, by pairs in the order of `PAIRS`.
    nudge
        The difference that one rounding at the start makes.
    steps
        The number of steps of each run.
    claimed
        The order that the engine claims for the method.
    error, bound
        The error of the run, and the bound of the truth's own error.
    """

    case: str
    method: str
    timestep: float
    quantity: str
    level: int
    refused: str = ""
    differences: tuple[float, ...] = ()
    nudge: float = 0.0
    steps: tuple[int, ...] = ()
    claimed: float | None = None
    error: float = 0.0
    bound: float = 0.0


#: The pairs of the four runs of a member, the coarser one first.
PAIRS = tuple(combinations(range(FINER + 1), 2))


def measured(member: Member) -> Measured | None:
    """Return what was measured of a member; None if the scene cannot be run, or has no truth."""
    rng = np.random.default_rng([member.seed, KINDS.index(member.kind), member.number])
    engine = registry.load(member.engine).engine
    case = drawn(_shipped(str(rng.choice(CASES[member.kind]))), LONGEST[member.kind], rng)
    method = _method(engine, case, rng)
    if method is None:
        return None
    places = tuple(name for name in PLACES if isinstance(case.scene, Mechanism) or name in PLACES[:2])
    quantity, level = str(rng.choice(places)), int(rng.integers(FINER + 1))
    subject = Subject(
        case.instants, case.scene, ERROR, places, lambda _: member.kind, coarser=0, most_finer=FINER, wanted=places
    )

    def run(one: Method, times: Array, nudged: bool) -> Motion | Ended:
        return run_case(RunCase(member.engine, case, one, times, nudged))

    integrator = integrator_of(engine, method)
    order = math.inf if integrator is None or integrator.order is None else float(integrator.order)
    known = refined(subject, method, run, order)
    if isinstance(known, Ended) or len(known.levels.levels) <= FINER or quantity not in known.levels.quantities:
        return None
    head = Measured(case.name, method.name, known.levels.levels[level].timestep, quantity, level)
    if why := _refused(known):
        return replace(head, refused=why)
    error = _error(member, case, known, quantity, level, run)
    end = float(known.levels.instants[-1])
    return (
        None
        if error is None
        else replace(
            head,
            differences=tuple(known.levels.value(quantity, one, other, end) for one, other in PAIRS),
            nudge=known.levels.nudge(quantity, end),
            steps=tuple(one.motion.steps for one in known.levels.levels),
            claimed=order if math.isfinite(order) else None,
            error=error[0],
            bound=error[1],
        )
    )


@cache
def _shipped(name: str) -> Case:
    return load(name)


def _refused(known: Refined) -> str:
    """Return why the runs of a member have no estimate, whatever their differences are; empty if they may have one."""
    if known.chaos is not None:
        return "chaotic"
    end = float(known.levels.instants[-1])
    angles = [known.levels.value(name, FINER - 1, FINER, end) for name in ANGLES if name in known.levels.quantities]
    return "far" if max(angles, default=0.0) > FAR else ""


def drawn(case: Case, longest: float, rng: np.random.Generator) -> Case:
    """Return a case with initial velocities, gravity and duration that are drawn. longest: the longest duration (s)."""
    scale = float(rng.uniform(0.5, 1.5))
    gravity = case.scene.gravity * float(rng.uniform(0.8, 1.2))
    duration = min(case.duration, longest) * float(rng.uniform(0.5, 1.0))
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
    return replace(case, scene=scene, duration=duration, samples=SAMPLES)


def _scaled(vector: tuple[float, float, float], scale: float) -> tuple[float, float, float]:
    x, y, z = vector
    return scale * x, scale * y, scale * z


def _method(engine: Engine, case: Case, rng: np.random.Generator) -> Method | None:
    """Return a method with a time step (s), drawn from those of the engine without options; None if there is none.

    Where a controller holds its output, steps end at its instants, as those of a study do.
    """
    names = [name for name in offered(engine, case.scene) if ":" not in name]
    smallest, largest = TIMESTEPS
    step = math.exp(float(rng.uniform(math.log(smallest), math.log(largest))))
    if (period := control_period(case.scene)) is not None:
        step = float(period) / max(1, round(float(period) / step))
    return Method.parse(str(rng.choice(names)), 0.0).at(step) if names else None


def _error(member: Member, case: Case, known: Refined, quantity: str, index: int, run: Run) -> tuple[float, float] | None:
    """Return the error of a run, and the bound of the truth's error; None if the error is not known."""
    level = known.levels.levels[index]
    steps = own_steps(case.instants, level.timestep)
    motion = level.motion.part(np.searchsorted(level.steps, steps))
    bound = 0.0
    if member.kind in WITH_TRUTH:
        try:
            exact = truth.truth(case.scene, motion.t, vouched=False)
        except (NotModelled, OutOfReach):
            return None
        finer = replace(motion, trajectory=exact.trajectory)
        angle = quantity in ANGLES
        bound = float(np.max(exact.bounds.error if angle else exact.bounds.position_error))
    else:
        step = level.timestep / FINER_BY
        if steps[-1] * FINER_BY > MOST_STEPS:
            return None
        outcome = run(known.method.at(step), instants_of(steps * FINER_BY, step), False)
        if isinstance(outcome, Ended) or outcome.trajectory is None:
            return None
        finer = replace(outcome, t=motion.t, trajectory=replace(outcome.trajectory, t=motion.t))
    return float(np.nanmax(differences(case.scene, motion, finer, (quantity,))[quantity])), bound
