"""Steps of miniature robots whose joints do not affect each other: each has an inertia of 1 kg m^2.

What a joint tells and what it does are two arguments, so that a miniature engine may have the fault of not doing what it tells.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from bodycheck.adapters.contract import Adapter
from bodycheck.adapters.robot_reading import (
    Behaviour,
    JointStates,
    ReadJoint,
    RobotFile,
    RobotModels,
    RobotReading,
    RobotSteps,
)
from bodycheck.reference.robots.model import Mimic, RobotJoint, RobotLink, RobotModel
from bodycheck.reference.robots.state import RobotState
from bodycheck.reference.robots.states import seeded_states
from bodycheck.reference.robots.terms import Terms
from bodycheck.robots import urdf
from bodycheck.running.robot_trials import TIMESTEP_S, behaviours

#: The file's joints, which are siblings: the second follows the first where `RULE` says so.
NAMES = ("first", "second")
RULE = Mimic("first", 2.0, 0.1)


@dataclass(frozen=True)
class Does:
    """What the joints of a miniature engine do: limits, rules, damping and friction, by the names of the joints.

    springs: limits that are springs of 50 N m/rad.
    """

    limits: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    springs: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    rules: Mapping[str, Mimic] = field(default_factory=dict)
    damping: Mapping[str, float] = field(default_factory=dict)
    friction: Mapping[str, float] = field(default_factory=dict)

    def step(self, starts: Sequence[JointStates], steps: int) -> list[JointStates]:
        """Return the states after steps, as `running.robot_trials.Step` says."""
        return [self._moved(start, steps) for start in starts]

    def _moved(self, start: JointStates, steps: int) -> JointStates:
        positions, velocities = dict(start.positions), dict(start.velocities)
        for _ in range(steps):
            for name in positions:
                low, high = self.springs.get(name, (-np.inf, np.inf))
                velocities[name] -= TIMESTEP_S * 50.0 * (positions[name] - min(max(positions[name], low), high))
                velocities[name] -= TIMESTEP_S * self.damping.get(name, 0.0) * velocities[name]
                braking = min(TIMESTEP_S * self.friction.get(name, 0.0), abs(velocities[name]))
                velocities[name] -= braking * np.sign(velocities[name])
            for follower, rule in self.rules.items():  # the velocities of least change that obey the rule
                along = (velocities[rule.joint] + rule.multiplier * velocities[follower]) / (1 + rule.multiplier**2)
                velocities[rule.joint], velocities[follower] = along, rule.multiplier * along
            for name in positions:
                lower, upper = self.limits.get(name, (-np.inf, np.inf))
                positions[name] = min(max(positions[name] + TIMESTEP_S * velocities[name], lower), upper)
            for follower, rule in self.rules.items():
                positions[follower] = rule.multiplier * positions[rule.joint] + rule.offset
        return JointStates(positions, velocities)


def file_model(**numbers: Mapping[str, object]) -> RobotModel:
    """The model of a file with the two joints. numbers: attributes of `RobotJoint`, each by the names of the joints."""
    zero, identity = np.zeros(3, np.longdouble), np.eye(3, dtype=np.longdouble)
    axis = np.array([0, 0, 1], np.longdouble)
    links = tuple(RobotLink(name, 1.0, zero, identity) for name in ("base", *NAMES))
    joints = tuple(
        RobotJoint(
            name, "revolute", 0, place + 1, zero, identity, axis, **{key: of[name] for key, of in numbers.items() if name in of}
        )
        for place, name in enumerate(NAMES)
    )
    return RobotModel("siblings", links, joints)


def told(model: RobotModel) -> RobotReading:
    """The reading of an engine whose records are those of the file."""
    joints = tuple(
        ReadJoint(
            *(one.name, one.type, one.name, place, 1),
            damping=one.damping,
            friction=one.friction,
            lower=one.lower,
            upper=one.upper,
            mimic=one.mimic,
        )
        for place, one in enumerate(model.joints)
    )
    return RobotReading((), joints, (), 2, None, (Terms(mass_matrix=np.eye(2)),))


def in_engine(adapter: Adapter, file: RobotFile) -> dict[str, Behaviour]:
    """What the motions of an engine show of the joints of a URDF."""
    assert isinstance(adapter, RobotModels)
    assert isinstance(adapter, RobotSteps)
    model = urdf.read(Path(file.path).read_bytes(), "robot").model
    states = seeded_states(model, 1, 0)
    reading = adapter.read_robot(file, states, (0.0, 0.0, -9.81))
    rounding = float(np.finfo(adapter.engine.precision).eps)
    return behaviours(
        lambda starts, steps: adapter.step_robot(file, starts, TIMESTEP_S, steps), reading, model, states[0], rounding
    )


#: A state of both joints that obeys `RULE`.
STATE = RobotState(*({"first": (first,), "second": (second,)} for first, second in ((0.3, 0.7), (1, 2), (0, 0), (0, 0))))
