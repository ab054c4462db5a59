"""Try by motion what an engine does with the joints of a robot: limits, rules of following, damping and dry friction.

An engine may tell a number of its records and not use it. Here the engine steps the robot from chosen states, and the numbers
are compared with the motions that follow. A part of a joint for which the motions decide nothing is not tried: a joint that
hardly moves, or a force that is lost in the rounding of the engine.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from bodycheck.adapters.robot_reading import Behaviour, JointStates, Part, ReadJoint, RobotReading
from bodycheck.reference.robots.dynamics import terms, velocity_labels
from bodycheck.reference.robots.model import Mimic, RobotJoint, RobotModel
from bodycheck.reference.robots.state import RobotState
from bodycheck.reference.trajectory import Array

#: The time step (s), the steps of a motion to a limit, the steps in which a soft limit pushes a joint back, and the steps of a
#: motion that shows whether joints follow each other, in which soft constraints with time constants of 20 ms come to rest.
TIMESTEP_S, TO_LIMIT, PUSHED_BACK, FOLLOWING = 1e-3, 60, 500, 300

#: The largest speed of a joint (rad/s or m/s), and the part of its range that a motion may cross.
SPEED, PART_OF_RANGE = 1.0, 0.25

#: The size from which on a limit counts as none.
NO_LIMIT = 1e9

#: The relative difference of a measured number from the records up to which the motion confirms it: steps are of first order.
CONFIRMED = 0.03

#: The part of a free way by which the ways of two motions of a joint from different positions may differ.
SAME_MOTION = 0.15

#: The part of the way without resistance that a joint must move at least for its limits to be tried.
LEAST_WAY = 0.1

#: The size of a force, in roundings of the change of momentum in a step, from which on the force can be measured.
ROUNDINGS = 100

#: The inertia of a joint, relative to the largest one, below which it counts as none.
LEAST = 1e-12

#: A function that steps the robot from several states, as `RobotSteps.step_robot` does, by a number of steps.
Step = Callable[[Sequence[JointStates], int], Sequence[JointStates]]


@dataclass(frozen=True, eq=False)
class Trial:
    """A robot to be tried.

    Attributes
    ----------
    step
        The function that steps it.
    joints
        The engine's revolute and prismatic joints that the file names too.
    of_file
        The same joints in the file.
    base
        The positions of all joints where motions start.
    rules
        The rules by which joints really follow others, by the names of the followers.
    """

    step: Step
    joints: Mapping[str, ReadJoint]
    of_file: Mapping[str, RobotJoint]
    base: Mapping[str, float]
    rules: Mapping[str, Mimic] = field(default_factory=dict)

    def start(self, positions: Mapping[str, float], velocities: Mapping[str, float]) -> JointStates:
        """Return a state with some positions that differ from those of `base`, and with some velocities; all others are 0."""
        return JointStates({**self.base, **positions}, {**dict.fromkeys(self.base, 0.0), **velocities})

    def together(self, name: str, position: float, velocity: float) -> tuple[dict[str, float], dict[str, float]]:
        """Return positions and velocities of a joint, of the joint that it follows, and of the joints that follow it."""
        positions, velocities = {name: position}, {name: velocity}
        rule = self.rules.get(name)
        leader = name
        if rule is not None and rule.multiplier:
            leader = rule.joint
            positions[leader], velocities[leader] = (position - rule.offset) / rule.multiplier, velocity / rule.multiplier
        for follower, other in self.rules.items():
            if other.joint == leader and follower != name:
                positions[follower] = other.multiplier * positions[leader] + other.offset
                velocities[follower] = other.multiplier * velocities[leader]
        return positions, velocities

    def allows(self, name: str, position: float) -> bool:
        """Return whether the joints that move with a joint are inside their limits when it is at a position."""
        positions, _ = self.together(name, position, 0.0)
        return all(
            (limits.lower is None or limits.lower <= at) and (limits.upper is None or at <= limits.upper)
            for other, at in positions.items()
            if other != name and (limits := self.of_file[other])
        )


def behaviours(
    step: Step, reading: RobotReading, model: RobotModel, state: RobotState, rounding: float
) -> dict[str, Behaviour]:
    """Return the behaviour of the joints of a robot in the steps of an engine, by the names of the joints.

    Parameters
    ----------
    step
        The function that steps the robot.
    reading
        The engine's reading, whose first terms are those at `state`.
    model
        The model of the file.
    state
        A state at which the mass matrix is known.
    rounding
        The relative rounding of the engine's numbers.
    """
    in_file = {joint.name: joint for joint in model.joints if joint.type in ("revolute", "prismatic")}
    known = in_file.keys() - massless(model, state)
    joints = {joint.name: joint for joint in reading.joints if joint.count == 1 and joint.name in known}
    of_file = {name: in_file[name] for name in joints}
    trial = Trial(step, joints, of_file, {name: middle(joint) for name, joint in of_file.items()})
    by_joint = {name: Behaviour() for name in joints}
    mimics = mimics_of(trial)
    for name, mimic in mimics.items():
        by_joint[name] = _with(by_joint[name], "mimic", mimic=mimic)
    followed = replace(trial, rules={name: mimic for name, mimic in mimics.items() if mimic is not None})
    for name, limits in limits_of(followed).items():
        by_joint[name] = _with(by_joint[name], "limits", lower=limits[0], upper=limits[1])
    at_state = replace(trial, base={name: state.positions[name][0] for name in joints})
    for part, numbers in resistances_of(at_state, reading, model, state, rounding).items():
        for name, number in numbers.items():
            by_joint[name] = _with(by_joint[name], part, **{part: number})
    return {name: behaviour for name, behaviour in by_joint.items() if behaviour.tried}


def massless(model: RobotModel, state: RobotState) -> set[str]:
    """Return the names of the joints that move no mass in the model of a file, so that no motion of theirs is determined."""
    matrix = terms(model, state, (0.0, 0.0, 0.0)).mass_matrix
    inertias = np.diagonal(matrix) if matrix is not None else np.ones(0)
    names = [name for name, _ in velocity_labels(model)]
    return {name for name, inertia in zip(names, inertias, strict=bool(len(inertias))) if not inertia > LEAST * max(inertias)}


def _with(behaviour: Behaviour, part: Part, **numbers: float | Mimic | None) -> Behaviour:
    return replace(behaviour, tried=behaviour.tried | {part}, **numbers)  # type: ignore[arg-type]


def limits_of(trial: Trial) -> dict[str, tuple[float | None, float | None]]:
    """Return the limits at which joints stop, for the joints whose limits can be tried.

    A joint moves freely first, from the middle of its range, and then from a quarter of this distance before each limit
    that the engine tells or the file states.
    """
    limited = {name: bounds for name in trial.joints if any(bounds := candidates(trial, name))}
    if not limited:
        return {}
    speeds = {name: speed(trial.of_file[name], TO_LIMIT) for name in limited}
    ways = [(name, sign) for name in limited for sign in (-1.0, 1.0)]
    starts = [trial.start(*trial.together(name, trial.base[name], sign * speeds[name])) for name, sign in ways]
    free = {
        (name, sign): sign * (_position(end, name, speeds[name]) - trial.base[name])
        for (name, sign), end in zip(ways, trial.step(starts, TO_LIMIT), strict=True)
    }
    tries = [(name, sign, limit) for name, bounds in limited.items() for sign, limit in bounds]
    towards = {
        (name, sign, limit): trial.start(*trial.together(name, limit - sign * free[name, sign] / 4, sign * speeds[name]))
        for name, sign, limit in tries
    }
    beyond = _beyond(trial, towards, speeds, TO_LIMIT)
    stopping = {one: _stops(way, free[one[:2]]) for one, way in beyond.items()}
    passing = {one: towards[one] for one, stops in stopping.items() if stops is False}
    for one, way in _beyond(trial, passing, speeds, PUSHED_BACK).items():
        if not way > free[one[:2]] / 2:  # a soft limit pushes the joint back, or the motion is not stable
            stopping[one] = None
    results: dict[str, tuple[float | None, float | None]] = {}
    for name, bounds in limited.items():
        reach = speeds[name] * TO_LIMIT * TIMESTEP_S
        if not all(LEAST_WAY * reach < free[name, sign] <= (1 + SAME_MOTION) * reach for sign in (-1.0, 1.0)):
            continue
        stops = {(sign, limit): stopping[name, sign, limit] if trial.allows(name, limit) else None for sign, limit in bounds}
        if None not in stops.values():
            lower = max((limit for (sign, limit), stop in stops.items() if stop and sign < 0), default=None)
            results[name] = lower, min((limit for (sign, limit), stop in stops.items() if stop and sign > 0), default=None)
    return results


#: A limit that is tried: the name of the joint, its side and its position.
_Tried = tuple[str, float, float]


def _beyond(trial: Trial, starts: Mapping[_Tried, JointStates], speeds: Mapping[str, float], steps: int) -> dict[_Tried, float]:
    """Return how far joints get beyond limits in a number of steps."""
    ends = trial.step(list(starts.values()), steps) if starts else []
    return {
        (name, sign, limit): sign * (_position(end, name, speeds[name]) - limit)
        for (name, sign, limit), end in zip(starts, ends, strict=True)
    }


def _position(end: JointStates, name: str, fastest: float) -> float:
    """Return the position of a joint at the end of a motion; nan if it has become faster than it can in a stable motion."""
    return end.positions[name] if abs(end.velocities[name]) <= (1 + SAME_MOTION) * fastest else math.nan


def _stops(beyond: float, free: float) -> bool | None:
    """Return whether a joint stops at a limit, from its way beyond the limit and its free way; None if neither is clear.

    A joint that does not stop gets as far as it does freely from the same distance before the limit.
    """
    if abs(beyond) <= free / 4:
        return True
    return False if abs(beyond - free * 3 / 4) <= SAME_MOTION * free else None


def middle(joint: RobotJoint) -> float:
    """Return the middle of the range of a joint, or the position nearest to 0 that its limits allow if it has no range."""
    if joint.lower is not None and joint.upper is not None:
        return (joint.lower + joint.upper) / 2
    return max(joint.lower or 0.0, 0.0) if joint.upper is None else min(joint.upper, 0.0)


def candidates(trial: Trial, name: str) -> list[tuple[float, float]]:
    """Return the limits of a joint that the engine tells or the file states, each with its side: -1 is below and 1 above."""
    recorded, stated = trial.joints[name], trial.of_file[name]
    pairs = [(-1.0, recorded.lower), (-1.0, stated.lower), (1.0, recorded.upper), (1.0, stated.upper)]
    distinct: list[tuple[float, float]] = []
    for sign, limit in pairs:
        known = [other for side, other in distinct if side == sign]
        if limit is not None and abs(limit) < NO_LIMIT and not np.any(np.isclose(limit, known, rtol=1e-6, atol=1e-9)):
            distinct.append((sign, limit))
    return distinct


def speed(joint: RobotJoint, steps: int) -> float:
    """Return the speed of a joint with which it crosses at most a part of its range in a number of steps."""
    span = np.inf if joint.lower is None or joint.upper is None else joint.upper - joint.lower
    return float(min(SPEED, PART_OF_RANGE * span / (steps * TIMESTEP_S))) if span > 0 else SPEED


def mimics_of(trial: Trial) -> dict[str, Mimic | None]:
    """Return the rules by which joints follow others, for the joints that the engine tells to follow another one.

    The two joints start at positions that obey the rule that the engine tells: twice with a moving leader, and once with a
    moving follower. Joints that follow each other have the same rule in all three motions. Without a rule, a joint that is
    moved moves alone. Damping and dry friction load a soft constraint, so that for joints with these a motion by another rule
    decides nothing.
    """
    rules = {
        name: joint.mimic
        for name, joint in trial.joints.items()
        if joint.mimic is not None and joint.mimic.joint in trial.joints
    }
    starts = []
    for name, mimic in rules.items():
        leader, start = trial.of_file[mimic.joint], trial.base[mimic.joint]
        at = {mimic.joint: start, name: mimic.multiplier * start + mimic.offset}
        quick = min(speed(leader, FOLLOWING), speed(trial.of_file[name], FOLLOWING) / max(1.0, abs(mimic.multiplier)))
        starts += [trial.start(at, {mimic.joint: quick}), trial.start(at, {mimic.joint: -quick})]
        starts.append(trial.start(at, {name: quick * mimic.multiplier}))
    ends = trial.step(starts, FOLLOWING) if starts else []
    results: dict[str, Mimic | None] = {}
    for index, (name, mimic) in enumerate(rules.items()):
        three = range(3 * index, 3 * index + 3)
        leaders, followers = (np.array([ends[at].positions[one] for at in three]) for one in (mimic.joint, name))
        before, moved = starts[3 * index], abs(leaders[0] - leaders[1])
        speeds = [abs(ends[at].velocities[one]) for at in three for one in (mimic.joint, name)]
        ratio = max(abs(mimic.multiplier), 1 / abs(mimic.multiplier)) if mimic.multiplier else 1.0
        calm = max(speeds) <= 2 * ratio * max(map(abs, before.velocities.values()))
        if calm and np.all(np.isfinite([leaders, followers])) and moved > 1e-4 * max(1.0, abs(before.positions[mimic.joint])):
            rule = _rule(mimic, leaders, followers)
            if rule == mimic or not any(_resisted(trial.joints[one]) for one in (name, mimic.joint)):
                results[name] = rule
    return results


def _resisted(joint: ReadJoint) -> bool:
    """Return whether the engine tells that damping or dry friction acts in a joint."""
    return bool(joint.damping or joint.friction)


def _rule(recorded: Mimic, leaders: Array, followers: Array) -> Mimic | None:
    """Return the rule that three pairs of positions obey; None if there is none. recorded: the rule that the engine tells."""
    multiplier = float((followers[0] - followers[1]) / (leaders[0] - leaders[1]))
    offset = float(followers[0] - multiplier * leaders[0])
    span = float(np.ptp(followers) + abs(multiplier) * np.ptp(leaders))
    if abs(followers[2] - multiplier * leaders[2] - offset) > 5 * CONFIRMED * span:
        return None
    if np.all(np.abs(followers - recorded.multiplier * leaders - recorded.offset) <= CONFIRMED * span):
        return recorded
    return Mimic(recorded.joint, float(f"{multiplier:.3g}"), float(f"{offset:.2f}"))


def resistances_of(
    trial: Trial, reading: RobotReading, model: RobotModel, state: RobotState, rounding: float
) -> dict[Part, dict[str, float]]:
    """Return the damping and the dry friction of joints, for joints of which the engine tells either.

    All joints move at once, for one step, with two speeds in both directions. The change of momentum is the force. Coriolis
    forces are equal in both directions, so that half of the difference has none. Forces of damping are those of the speed
    before or after the step. Joints that follow others, or lead them, also have the forces of their constraints: they are not
    tried. No joint is tried of a robot that has a joint with several velocities.
    """
    results: dict[Part, dict[str, float]] = {"damping": {}, "friction": {}}
    tied = {joint.mimic.joint for joint in trial.joints.values() if joint.mimic} | {
        name for name, joint in trial.joints.items() if joint.mimic
    }
    chosen = [name for name, joint in trial.joints.items() if (joint.damping or joint.friction) and name not in tied]
    mass = mass_matrix(trial, reading, model, state)
    if not chosen or mass is None:
        return results
    names, speeds = list(trial.joints), np.array([1.0, -1.0, 2.0, -2.0]) * SPEED
    ends = trial.step([trial.start({}, dict.fromkeys(names, float(one))) for one in speeds], 1)
    after = np.array([[end.velocities[name] for name in names] for end in ends])
    before = np.abs(speeds[::2])[:, None] * np.ones(len(names))
    after = (after[::2] - after[1::2]) / 2
    if not np.all(np.abs(after) <= 2 * before):  # the motion is not stable
        return results
    force = (before - after) @ mass.T / TIMESTEP_S
    stopping = before @ np.abs(mass).T / TIMESTEP_S
    for name in chosen:
        index, joint = names.index(name), trial.joints[name]
        of_joint = force[:, index], before[:, index], after[:, index], stopping[:, index]
        for part, number in _resistance(joint, *of_joint, ROUNDINGS * rounding).items():
            results[part][name] = number
    return results


def mass_matrix(trial: Trial, reading: RobotReading, model: RobotModel, state: RobotState) -> Array | None:
    """Return the mass matrix of the joints of a trial at a state: the engine's, or that of the file if the engine has none.

    Return None if the robot has a joint with several velocities, or a joint that is not tried.
    """
    if reading.velocities != len(trial.joints):
        return None
    matrix, order = reading.terms[0].mass_matrix, [joint.first for joint in trial.joints.values()]
    if matrix is None:
        labels = [name for name, _ in velocity_labels(model)]
        if set(labels) != set(trial.joints):
            return None
        matrix, order = terms(model, state, (0.0, 0.0, 0.0)).mass_matrix, [labels.index(name) for name in trial.joints]
    return None if matrix is None else np.asarray(matrix, np.float64)[np.ix_(order, order)]


def _resistance(joint: ReadJoint, force: Array, before: Array, after: Array, stopping: Array, lost: float) -> dict[Part, float]:
    """Return the damping and the friction of a joint, as far as forces (2,) decide whether they act as the engine tells.

    before, after: the speeds (2,) before and after a step. stopping: the forces (2,) that would stop all joints in a step, of
    which the part `lost` is lost in rounding. Nothing is decided if the speeds grow or change their sign, as with a damping for
    which the step is too long.
    """
    if np.any(after < -CONFIRMED * before) or np.any(after > (1 + CONFIRMED) * before):
        return {}
    damping, friction = joint.damping or 0.0, joint.friction or 0.0
    # A force that stops a light joint is small beside the damping and the friction, and yet it is not zero.
    tolerance = CONFIRMED * np.minimum(damping * before + friction, stopping) + lost * float(np.max(stopping))
    stopped = np.abs(after) <= CONFIRMED * before
    acting: list[dict[Part, float]] = []
    for with_damping in {damping, 0.0}:
        for with_friction in {friction, 0.0}:
            for speeds in (before, after):
                rest = force - with_damping * speeds - with_friction
                less = stopped & (rest < 0) if with_friction else False  # friction that stops a joint takes what is needed
                if np.all((np.abs(rest) <= tolerance) | less):
                    acting.append({"damping": with_damping, "friction": with_friction})
    parts: tuple[Part, ...] = ("damping", "friction")
    values = {part: {one[part] for one in acting} for part in parts}
    return {part: next(iter(known)) for part, known in values.items() if len(known) == 1 and getattr(joint, part)}
