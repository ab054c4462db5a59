"""The parts that the scripts of all adapters share: see `bodycheck.adapters.contract.Scripts`."""

import inspect
from collections.abc import Callable, Iterable
from typing import Any

from bodycheck.adapters import control_laws, driving
from bodycheck.adapters.contract import Method
from bodycheck.reference.mechanisms import control
from bodycheck.reference.mechanisms.mechanism import Mechanism

#: The names of the columns that a script prints: time (s), then the columns of `Simulation.advance`.
COLUMNS = "t,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz"

#: The names of the columns that the script of a mechanism prints, with a row for each body.
MECHANISM_COLUMNS = COLUMNS.replace("t,", "t,body,", 1)

#: The lines of a script that define its samples, which are at the ends of the steps nearest to the instants. Its loops follow.
SAMPLING = """\
TIMESTEP = {timestep!r}  # s
INSTANTS = np.linspace(0.0, {duration!r}, {samples!r})  # s
STEPS = np.unique(np.rint(INSTANTS / TIMESTEP).astype(np.int64))
"""

LOOP = """\
# Time (s), position (m, world), quaternion (w x y z, body to world), velocity (m/s, world), angular velocity (rad/s, body).
print({columns!r})
done = 0
for step in STEPS.tolist():
{advance}
    done = step
    print(step * TIMESTEP, *{state}, sep=",")
"""

MECHANISM_LOOP = """\
# Time (s), body, position of its centre of mass (m, world), quaternion (w x y z, body to world), velocity (m/s, world), angular
# velocity (rad/s, body).
print({columns!r})
done = 0
for step in STEPS.tolist():
{advance}
    done = step
    for name, row in zip(BODIES, {states}.tolist()):
        print(step * TIMESTEP, name, *row, sep=",")
"""


def sampling(timestep: float, duration: float, samples: int) -> str:
    """Return the lines that define the names TIMESTEP, INSTANTS and STEPS. `timestep` and `duration` are in s."""
    return SAMPLING.format(timestep=timestep, duration=duration, samples=samples)


def loop(advance: str, state: str) -> str:
    """Return the loop over the samples.

    Parameters
    ----------
    advance
        Lines that advance the simulation by `step - done` steps.
    state
        An expression for the list of the 13 numbers of the current state.
    """
    return LOOP.format(columns=COLUMNS, advance=indented(advance), state=state)


def mechanism_loop(advance: str, states: str) -> str:
    """Return the loop over the samples of a mechanism; the script must define the list BODIES of the names of the bodies.

    `advance` is as in `loop`, and `states` is an expression for the array (bodies, 13) of the current states.
    """
    return MECHANISM_LOOP.format(columns=MECHANISM_COLUMNS, advance=indented(advance), states=states)


def indented(lines: str) -> str:
    """Return lines indented by one level."""
    return "\n".join(f"    {line}" for line in lines.splitlines())


def embedded(text: str) -> str:
    """Return a text as it stands between three quotes in a script: names in it may have quotes and backslashes."""
    return text.replace("\\", r"\\").replace('"""', r"\"\"\"")


def written(numbers: Iterable[float]) -> str:
    """Return the source of a list of numbers, with all digits of a float."""
    return f"[{', '.join(repr(float(number)) for number in numbers)}]"


def source(*functions: Callable[..., Any]) -> str:
    """Return the source of functions and classes that the adapter itself calls, so that a script does the same as the adapter.

    A script that begins with `FUTURE` does not evaluate their annotations.
    """
    return "\n\n".join(inspect.getsource(function) for function in functions)


#: The lines of a script that define what drives the joints of a mechanism.
CONTROLS = """
import math
from bisect import bisect_right
from collections import deque
from dataclasses import dataclass, field
from fractions import Fraction

SLACK = {slack!r}


{source}


# Pairs of the number of a driven joint, and its controller or its elastic stops.
CONTROLLERS = {controllers}
STOPS = {stops}
controls = Controls({count}, CONTROLLERS, STOPS, True)
"""

#: The lines of a script that take the steps to the next sample of a driven mechanism.
DRIVEN_ADVANCE = """\
while done < step:
    controls.exert(done * Fraction(TIMESTEP), {state}, joints.apply)
    following = controls.following(done, step, TIMESTEP)
{advance}
    done = following"""


def controls_of(mechanism: Mechanism, method: Method) -> str:
    """Return the lines that define the object `controls` of a simulation that obeys laws at its stages; empty if none drive it.

    The lines of the engine need an object `joints` with the methods of `bodycheck.adapters.contract.Staged`.
    """
    controls = driving.controls_of(mechanism, method, staged=True)
    if not controls.samplers and not controls.continuous:
        return ""
    sampled = [(each.index, each.controller) for each in controls.samplers]
    controllers = [*sampled, *((each.index, each.controller) for each in controls.followers)]
    laws = (
        control_laws.value_of,
        control_laws.integral_of,
        control_laws.saturated,
        control_laws.effort_of,
        control_laws.push_of,
    )
    return CONTROLS.format(
        slack=control.SLACK,
        source=source(
            *(control.Sine, control.Samples, control.Controller, control.Stops),
            *(*laws, driving.Sampler, driving.Follower, driving.Controls),
        ),
        controllers=f"[{', '.join(map(repr, controllers))}]",
        stops=f"[{', '.join(map(repr, controls.stops))}]",
        count=controls.count,
    )


def driven_advance(advance: str, state: str = "joints.state") -> str:
    """Return the lines that take the steps of a driven mechanism to the next sample.

    Parameters
    ----------
    advance
        Lines that take `following - done` steps.
    state
        An expression for the function that returns the state of the driven joints.
    """
    return DRIVEN_ADVANCE.format(advance=indented(advance), state=state)


#: The first statement of a script.
FUTURE = "from __future__ import annotations\n"
