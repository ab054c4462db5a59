"""Sentences on cases with robots' files: what was left out, what does not act, and from when on limits and contacts act.

Limits are roots of the truth. Contacts are looked for by MuJoCo's collision detection in the poses of the truth. Both need the
truth of the case, which worker processes compute.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from bodycheck.adapters.robot_reading import ModelRefused, Touch, Touches
from bodycheck.casefile.content import Case
from bodycheck.casefile.robot_notes import RobotNotes
from bodycheck.errors import BadInput
from bodycheck.files.temporary import temporary_folder
from bodycheck.processes import pool
from bodycheck.processes.failures import Crashed, TimedOut
from bodycheck.reference.bodies import bodies
from bodycheck.reference.errors import NotModelled, OutOfReach
from bodycheck.reference.kinematics import multiply, rotate
from bodycheck.reference.mechanisms.coordinates import by_name
from bodycheck.reference.mechanisms.exact import nearest_turn
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, Mechanism
from bodycheck.reference.requirements import of_mechanism
from bodycheck.reference.robots.state import RobotState
from bodycheck.reference.trajectory import Array
from bodycheck.reference.truths import Truth
from bodycheck.robots.touching_copy import TouchingCopy, copied
from bodycheck.running.engines import home
from bodycheck.running.robot_readings import MJCF_ENGINE

if TYPE_CHECKING:
    from bodycheck.reference.mechanisms.hybrid.ranges import Passing

#: Time limit (s) of the truth of one robot, and of the search for its contacts.
TIME_LIMIT_S = 300.0

#: The sampling of runs that are sampled at the instants of the case (`Method.sampling`).
AT_INSTANTS = 0.0

#: The samplings where no runs are planned.
NO_SAMPLINGS: Mapping[str, Iterable[float]] = {}

#: What a robot is without, by the words of `ignore` that say something else.
WITHOUT = {"mimic": "mimic joints", "gravity_compensation": "gravity compensation"}

#: The most joints and pairs of bodies that a sentence names.
MOST_NAMED = 3


@dataclass(frozen=True)
class Robots:
    """Sentences on the cases with robots' files.

    Attributes
    ----------
    sentences
        Sentences by the name of the case, what was left out on purpose first.
    departures
        The last instant (s) at which neither limits nor contacts have acted that the case does not have, by the name of the
        case; cases in which they do not act are missing.
    truths
        Truths that were computed for these sentences, by the name of the case and by sampling (`Method.sampling`).
    """

    sentences: Mapping[str, Sequence[str]] = field(default_factory=dict)
    departures: Mapping[str, float] = field(default_factory=dict)
    truths: Mapping[str, Mapping[float, Truth]] = field(default_factory=dict)


#: The sentences where there are no robots.
NO_ROBOTS = Robots()


@dataclass(frozen=True, eq=False)
class Moved:
    """The motion of a robot: the limits that it passes, its states (None where they are not needed), and truths by sampling."""

    passings: "tuple[Passing, ...]"
    states: "States | None"
    truths: Mapping[float, Truth]


@dataclass(frozen=True, eq=False)
class States:
    """The states of a robot at n instants t (n,), s: positions of joints by name, and centres of mass (n, 3) of bodies (m).

    A free joint has the position and the attitude of its child in the world.
    """

    t: Array
    joints: Mapping[str, Array]
    centres: Mapping[str, Array]


@dataclass(frozen=True)
class Search:
    """A search for contacts: a copy of the file, and the states in which it looks for them."""

    case: str
    copy: TouchingCopy
    states: States


def as_loaded(cases: Sequence[Case]) -> Robots:
    """Return what is said of cases before anything is computed."""
    return Robots({case.name: _said(case.robot, ()) for case in cases if case.robot is not None})


def of(cases: Sequence[Case], jobs: int, samplings: Mapping[str, Iterable[float]] = NO_SAMPLINGS) -> Robots:
    """Return what is said of cases, and from when on limits and contacts would act in them.

    jobs: the number of processes. samplings: those of the runs of cases (`Method.sampling`), by the name of the case, whose
    truths are computed in the same process, since they share the integrations.
    """
    concerned = [case for case in cases if case.robot is not None and (case.robot.ranges or case.robot.touching)]
    if not concerned and all(_stops_until(case) is None for case in cases):
        return as_loaded(cases)
    moved: dict[str, Moved | str] = {}
    with pool.Workers(_moved, jobs, TIME_LIMIT_S, home=lambda _: home(None)) as workers:
        for (case, _), answer in workers.map([(case, tuple(samplings.get(case.name, ()))) for case in concerned]):
            moved[case.name] = answer.reason if isinstance(answer, Crashed | TimedOut) else answer
    touching = _touching(concerned, moved, jobs)
    sentences, departures = {}, {}
    for case in cases:
        if case.robot is None:
            continue
        acting = _Acting(case, moved.get(case.name), touching.get(case.name))
        sentences[case.name] = _said(case.robot, acting.sentences())
        if (instant := acting.departure()) is not None:
            departures[case.name] = instant
    return Robots(sentences, departures, {name: motion.truths for name, motion in moved.items() if isinstance(motion, Moved)})


def _stops_until(case: Case) -> float | None:
    return case.scene.stops_until if isinstance(case.scene, Mechanism) else None


def described(case: Case) -> str:
    """Return the numbers of bodies, joints and degrees of freedom of a robot, and its mass, in words."""
    scene = case.scene
    assert isinstance(scene, Mechanism)  # robots are mechanisms
    masses = [body.mass for body in bodies(scene) if body.mass]
    moving = sum(joint.type != "fixed" for joint in scene.joints)
    freedoms = of_mechanism(scene).degrees_of_freedom
    loops = f" without its loops, loops: {len(scene.loops)}" if scene.loops else ""
    counts = f"bodies with mass: {len(masses)}, joints that move: {moving}, degrees of freedom: {freedoms}{loops}"
    return f"{counts}, mass: {sum(masses):.6g} kg"


def _said(robot: RobotNotes, acting: Iterable[str]) -> list[str]:
    """Return the sentences on a robot, with all on parts that do not act in one text. acting: those on parts that act later."""
    return [*left_out(robot), *acting, *([" ".join(robot.notices)] if robot.notices else [])]


def left_out(robot: RobotNotes) -> Iterator[str]:
    """Yield a clause on what is left out of a robot on purpose, if anything is."""
    if robot.without:
        yield f"of the robot without its {_listed([WITHOUT.get(word, word) for word in robot.without])}"


def _listed(words: Sequence[str]) -> str:
    return " and ".join(filter(None, (", ".join(words[:-1]), words[-1])))


def _moved(asked: tuple[Case, tuple[float, ...]]) -> Moved | str:
    """Return the motion of a case and its truths for runs with some samplings, or why there is no truth of it."""
    from bodycheck.reference.mechanisms.hybrid.acting import with_acting_stops
    from bodycheck.reference.mechanisms.hybrid.ranges import passed
    from bodycheck.running import truths

    case, samplings = asked
    scene, robot = case.scene, case.robot
    assert isinstance(scene, Mechanism)
    assert robot is not None
    looked_at = robot.touching and robot.path is not None
    single = {joint.name for joint in scene.joints if joint.type in ("revolute", "prismatic")}
    try:
        # The truth comes first, since it compiles the equations of its two ways side by side, and the limits need one of these.
        batches = truths.batches(case, [*((AT_INSTANTS,) if looked_at else ()), *samplings])
        known = truths.of_runs(case, batches[0]) if batches else {}
        ranges = [each for each in robot.ranges if all(joint in single for joint, _ in each.terms)]
        passings = passed(with_acting_stops(scene, case.duration), ranges, case.duration) if ranges else ()
    except (NotModelled, OutOfReach) as error:
        return str(error)
    if not looked_at:
        return Moved(passings, None, known)
    truth = known[AT_INSTANTS]
    assert truth.joints is not None  # the truth of a mechanism has joints
    motions = by_name(scene, truth.joints)
    joints = {joint.name: _in_world(joint, motions[joint.name]["position"]) for joint in scene.joints if joint.type != "fixed"}
    massive = [(index, body.name) for index, body in enumerate(bodies(scene)) if body.mass]
    centres = {name: truth.trajectory.body(index).position for index, name in massive}
    return Moved(passings, States(truth.trajectory.t, joints, centres), known)


def _in_world(joint: Joint, positions: Array) -> Array:
    """Return the coordinates of a joint at n instants, with the pose in the world (n, 7) for a free joint."""
    if joint.type != "free" or joint.parent != WORLD:
        return positions
    turn = np.array(nearest_turn(joint.attitude))
    return np.hstack([np.array(joint.position) + rotate(turn, positions[:, :3]), multiply(turn, positions[:, 3:])])


def _touching(cases: Sequence[Case], moved: Mapping[str, Moved | str], jobs: int) -> dict[str, Touches | str]:
    """Return what was found of contacts in each case whose motion is known, or why they were not looked for."""
    answers: dict[str, Touches | str] = {}
    with temporary_folder() as folder, pool.Workers(_touches, jobs, TIME_LIMIT_S, group=_mujoco, home=home) as workers:
        searches = []
        for index, case in enumerate(cases):
            motion, robot = moved[case.name], case.robot
            assert robot is not None
            if not robot.touching or isinstance(motion, str):
                continue
            if robot.path is None or motion.states is None:
                answers[case.name] = "the file is not at hand"
                continue
            into = Path(folder) / str(index)
            into.mkdir()
            try:
                searches.append(Search(case.name, copied(robot.path, robot.packages, into, _base(case)), motion.states))
            except BadInput as error:
                answers[case.name] = str(error)
        for search, answer in workers.map(searches):
            answers[search.case] = answer.reason if isinstance(answer, Crashed | TimedOut) else answer
    return answers


def _base(case: Case) -> str | None:
    """Return the name of the joint by which the robot of a case floats; None if its base is fixed."""
    assert isinstance(case.scene, Mechanism)
    return next((joint.name for joint in case.scene.joints if joint.type == "free" and joint.parent == WORLD), None)


def _mujoco(_: Search) -> str:
    return MJCF_ENGINE


def _touches(search: Search) -> Touches | str:
    """Return what was found of contacts in the states of a search, or why MuJoCo has not looked for them."""
    # The adapter of MuJoCo is imported in the worker process of MuJoCo.
    from bodycheck.adapters.mujoco import collisions

    states = search.states
    at = [
        RobotState({name: tuple(np.atleast_1d(values[index]).tolist()) for name, values in states.joints.items()}, {}, {}, {})
        for index in range(len(states.t))
    ]
    try:
        touches: Touches = collisions.touches(search.copy.file, at, states.centres, search.copy.absent)
    except ModelRefused as error:
        return str(error)
    return touches


@dataclass(frozen=True)
class _Acting:
    """The limits and contacts that would act in a case.

    Attributes
    ----------
    case
        The case.
    moved
        Its motion, or why it has no truth; None if nothing can act in it.
    touches
        What was found of contacts, or why they were not looked for; None if nothing can touch.
    """

    case: Case
    moved: Moved | str | None
    touches: Touches | str | None

    @property
    def touch(self) -> Touch | None:
        """The first contact, as far as is known."""
        return self.touches.first if isinstance(self.touches, Touches) else None

    def departure(self) -> float | None:
        """Return the last instant (s) at which nothing has acted; None if nothing acts, as far as is known."""
        instants = []
        if isinstance(self.moved, Moved):
            instants += [passing.time - passing.error for passing in self.moved.passings[:1]]
        if self.touch is not None:
            instants.append(self.between(self.touch)[0])
        if (until := _stops_until(self.case)) is not None:
            instants.append(until)
        return max(min(instants), 0.0) if instants else None

    def between(self, touch: Touch) -> tuple[float, float]:
        """Return the instants (s) between which a contact begins; both are 0 at the start."""
        t = self.case.instants
        return (float(t[touch.index - 1]), float(t[touch.index])) if touch.index else (0.0, 0.0)

    def sentences(self) -> Iterator[str]:
        """Yield sentences on the limits and contacts that would act, or on why this is not known."""
        if isinstance(self.moved, str):
            yield f"From when on limits or contacts would act is not known: {self.moved}."
            return
        acting = []
        if self.moved is not None and self.moved.passings:
            acting.append((self.moved.passings[0].time, self._of_limits(self.moved.passings)))
        if self.touch is not None:
            acting.append((self.between(self.touch)[1], self._of_contacts(self.touch)))
        yield from (sentence for _, sentence in sorted(acting))
        if isinstance(self.touches, str):
            yield f"Contacts were not looked for: {self.touches}."
        elif self.touches is not None and self.touches.unseen:
            yield self._of_unseen(self.touches.unseen)

    def _of_unseen(self, unseen: Mapping[str, str]) -> str:
        names, reason = list(unseen), next(iter(unseen.values()))
        listed = _listed([*names[:MOST_NAMED], *([f"{more} more bodies"] if (more := len(names) - MOST_NAMED) > 0 else [])])
        return f"Contacts of {listed} were looked for without the shapes whose meshes cannot be read, such as {reason}."

    def _of_limits(self, passings: "Sequence[Passing]") -> str:
        first, names = passings[0], [passing.name for passing in passings]
        start = sum(passing.time == 0 for passing in passings)
        later = len(passings) - max(start, 1)
        more = f", and {later} more {'limits are' if later > 1 else 'limit is'} passed later" if later else ""
        if start:
            listed = _listed(
                [*names[: min(start, MOST_NAMED)], *([f"{start - MOST_NAMED} more"] if start > MOST_NAMED else [])]
            )
            begins = f"{listed} {'are beyond limits' if start > 1 else f'is beyond its {first.side} limit'} at the start{more}"
            return f"{begins}: this is the robot without its limits."
        begins = f"{names[0]} passes its {first.side} limit at {first.time:.4g} s{more}"
        return f"{begins}: from there on this is the robot without its limits."

    def _of_contacts(self, touch: Touch) -> str:
        pairs = [f"{one} touches {other}" for one, other in touch.pairs]
        if more := len(pairs) - MOST_NAMED:
            pairs = [*pairs[:MOST_NAMED], f"{more} more {'pairs touch' if more > 1 else 'pair touches'}"] if more > 0 else pairs
        after, before = self.between(touch)
        if not touch.index:
            return f"{_listed(pairs)} at the start: this is the robot without its contacts."
        when = f"between {after:.4g} and {before:.4g} s"
        return f"{_listed(pairs)} {when}: from there on this is the robot without its contacts."
