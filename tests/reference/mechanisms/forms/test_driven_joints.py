"""Controllers and stops of one joint, against sixty digits by code of its own (`tests.support.driven_joint`), and by their laws."""

from dataclasses import replace

import numpy as np
import pytest

from bodycheck.reference.exact.numbers import MP
from bodycheck.reference.mechanisms.control import Controller, Samples, Sine, Stops
from bodycheck.reference.mechanisms.driven import form
from bodycheck.reference.mechanisms.forms.motion import JointForm
from bodycheck.reference.mechanisms.forms.oscillator import Oscillator
from tests.support.driven_joint import CTX, Joint, states

PD = Controller(0, kp=20.0, kd=0.4, target=1.0)
HINGE = Joint(inertia=0.01, controller=PD)
SINE = Sine(0.7, 9.0, 0.3, 0.1)
RAMP = Samples((-0.1, 0.05, 0.21, 0.3), (0.0, 0.4, -0.3, 0.9), "linear")
HELD = Samples((0.05, 0.2, 0.301), (0.5, -0.4, 1.0))

#: One joint of each kind, and the length (s) of steps of the judge.
JOINTS: dict[str, tuple[Joint, float]] = {
    "step": (HINGE, 0.004),
    "every signal": (replace(HINGE, controller=replace(PD, target=SINE, target_velocity=RAMP, effort=HELD)), 0.004),
    "integral": (replace(HINGE, controller=replace(PD, ki=90.0, target=HELD), damping=0.02, stiffness=1.0, rest=0.2), 0.003),
    "effort": (Joint(damping=0.3, stiffness=2.0, controller=Controller(0, "effort", effort=SINE)), 0.02),
    "unstable": (Joint(controller=Controller(0, kp=3.0, ki=40.0, target=0.5)), 0.02),
    "sampled": (replace(HINGE, controller=replace(PD, rate=500.0)), 0.01),
    "sampled signals": (
        replace(HINGE, controller=replace(PD, rate=130.0, target=RAMP, target_velocity=SINE, effort=HELD, ki=30.0)),
        0.02,
    ),
    "delayed": (replace(HINGE, controller=replace(PD, rate=400.0, delay=3, target=SINE), damping=0.1, stiffness=0.5), 0.01),
    "sampled, cut": (replace(HINGE, controller=replace(PD, rate=300.0, effort_limit=2.0, target=HELD, effort=0.7)), 0.01),
    "sampled line": (
        replace(HINGE, controller=replace(PD, rate=300.0, effort_limit=5.0, no_load_speed=6.0, target=HELD, ki=50.0)),
        0.01,
    ),
    "cut": (replace(HINGE, controller=replace(PD, effort_limit=2.0, target=SINE, effort=0.3)), 0.004),
    "line": (replace(HINGE, controller=replace(PD, effort_limit=4.0, no_load_speed=8.0, target=HELD, ki=20.0)), 0.003),
    "beyond the line": (replace(HINGE, velocity=15.0, controller=replace(PD, effort_limit=4.0, no_load_speed=8.0)), 0.004),
    "friction": (replace(HINGE, friction=0.5, controller=replace(PD, kd=0.1, target=SINE)), 0.004),
    "sampled, friction": (replace(HINGE, friction=0.5, controller=replace(PD, kd=0.1, target=HELD, rate=200.0)), 0.006),
    "sticks": (replace(HINGE, friction=2.0, controller=replace(PD, kd=0.1, ki=60.0, target=0.2)), 0.003),
    "rigid stop": (replace(HINGE, controller=replace(PD, target=Sine(1.5, 20.0)), stops=Stops(-0.5, 0.4, 0.0)), 0.004),
    "rebounds": (replace(HINGE, controller=replace(PD, kd=0.1, target=SINE), stops=Stops(-0.3, 0.4, 0.6)), 0.004),
    "sampled rebounds": (
        replace(HINGE, controller=replace(PD, kd=0.1, target=HELD, rate=100.0), stops=Stops(-0.3, 0.4, 0.5)),
        0.006,
    ),
    "falling": (Joint(force=-9.0, start=0.1, stops=Stops(0.0, None, 0.5)), 0.05),
    "falling with friction": (Joint(force=-9.0, friction=2.0, start=0.1, stops=Stops(0.0, None, 0.7)), 0.05),
    "elastic": (replace(HINGE, controller=replace(PD, kd=0.1), stops=Stops(-0.3, 0.6, None, 400.0, 0.5)), 0.0008),
    "elastic, sampled": (
        replace(HINGE, friction=0.1, controller=replace(PD, kd=0.1, rate=200.0), stops=Stops(-0.3, 0.6, None, 400.0, 0.5)),
        0.0008,
    ),
    "starts beyond an elastic stop": (Joint(start=0.7, velocity=-1.0, stops=Stops(-0.3, 0.6, None, 400.0, 30.0)), 0.004),
}

TIMES = (0.003, 0.1, 0.2, 0.35)


def follow(joint: Joint, times: tuple[float, ...] | np.ndarray = TIMES) -> JointForm:
    """The motion of a joint by its closed form."""
    names = ("inertia", "damping", "stiffness", "rest", "force", "friction", "start", "velocity")
    plant = Oscillator(**{name: MP.mpf(getattr(joint, name)) for name in names})
    return form.follow(plant, joint.controller, joint.stops, np.asarray(times, dtype=float))


def excess(joint: Joint, step: float, of_form: Joint | None = None) -> float:
    """Return the largest error of the form, in units of its bound."""
    motion = follow(of_form or joint)
    largest = 0.0
    for row, exact in enumerate(states(joint, TIMES, step)):
        for values, bounds, number in zip(
            (motion.position, motion.velocity), (motion.error, motion.velocity_error), exact, strict=True
        ):
            high = float(values[row, 0])
            error = abs(CTX.mpf(high) + CTX.mpf(float(values[row, 0] - np.longdouble(high))) - number)
            # An exact zero, as of a joint that sticks, has the bound zero.
            largest = max(largest, float(error / (bounds[row] or 1e-30)))
    return largest


@pytest.mark.parametrize("name", JOINTS)
def test_the_motion_keeps_its_bound(name: str) -> None:
    joint, step = JOINTS[name]
    assert excess(joint, step) <= 1
    motion = follow(joint)
    for values, bounds in ((motion.position, motion.error), (motion.velocity, motion.velocity_error)):
        # 1e-14 of the largest value of the motion.
        assert bounds.max() <= 1e-14 * float(np.abs(values).max())
