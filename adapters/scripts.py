"""The parts that are the same in the scripts of all adapters: see `bodycheck.adapters.contract.Scripts`."""

import inspect
from collections.abc import Callable, Iterable
from typing import Any

#: The names of the columns that a script prints: time (s), then the columns of `Simulation.advance`.
COLUMNS = "t,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz"

#: Those of the script of a mechanism, which has a row for each body.
MECHANISM_COLUMNS = COLUMNS.replace("t,", "t,body,", 1)

#: The sampling of a script, and its loop. A sample is taken at the end of the step that is nearest to each instant.
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
        An expression for the list of the 13 numbers of the present state.
    """
    return LOOP.format(columns=COLUMNS, advance=indented(advance), state=state)


def mechanism_loop(advance: str, states: str) -> str:
    """Return the loop over the samples of a mechanism, whose names of bodies are the list BODIES.

    advance: as in `loop`. states: an expression for the array (bodies, 13) of the present states.
    """
    return MECHANISM_LOOP.format(columns=MECHANISM_COLUMNS, advance=indented(advance), states=states)


def indented(lines: str) -> str:
    """Return lines that are moved to the right by one level."""
    return "\n".join(f"    {line}" for line in lines.splitlines())


def written(numbers: Iterable[float]) -> str:
    """Return numbers as a list with all digits of a float."""
    return f"[{', '.join(repr(float(number)) for number in numbers)}]"


def source(*functions: Callable[..., Any]) -> str:
    """Return the source of functions and classes that the adapter itself calls, so that a script does what the adapter does.

    Their annotations are not evaluated in a script that begins with `FUTURE`.
    """
    return "\n\n".join(inspect.getsource(function) for function in functions)


#: The first statement of a script.
FUTURE = "from __future__ import annotations\n"
