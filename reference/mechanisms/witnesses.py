"""The witnesses of the motions of mechanisms: second ways to motions, which share no formula with the first ones.

The witness of a closed form is the recursion, and that of the recursion is the Lagrangian. A thread compiles and solves the
equations of the Lagrangian beside those of the recursion.
"""

from collections.abc import Callable
from concurrent.futures import Executor, Future, ThreadPoolExecutor, wait
from dataclasses import replace
from typing import Any

import numpy as np

from bodycheck.reference.errors import NotModelled, OutOfReach
from bodycheck.reference.exact.numbers import FloatType
from bodycheck.reference.mechanisms.followed import (
    Followed,
    arithmetic,
    by_recursion,
    followed,
    growth_instants,
    measurement,
    motion_of,
    stops_explained,
)
from bodycheck.reference.mechanisms.forms.choice import form_of
from bodycheck.reference.mechanisms.growth import FEWEST_ROUNDINGS, Growth, rounding_errors, roundings
from bodycheck.reference.mechanisms.kinematics import gaps
from bodycheck.reference.mechanisms.lagrangian import solution
from bodycheck.reference.mechanisms.lagrangian.poses import WideMotion
from bodycheck.reference.mechanisms.loops import ways as loops
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.mechanisms.modelled import require_drivable, require_independent, require_modelled, sudden
from bodycheck.reference.mechanisms.tree import forest
from bodycheck.reference.mechanisms.ways import Way, reach
from bodycheck.reference.trajectory import Array
from bodycheck.reference.witnesses import DOP853_ROUNDINGS

#: The largest gap of a loop, as a fraction of the length of the mechanism, in a motion by the Lagrangian.
OPEN = 1e-9


def followed_with_witness(mechanism: Mechanism, times: Array) -> tuple[Followed, Way | None]:
    """The motion of `followed` and its witness, which threads compute side by side where heyoka follows a tree.

    The witness may end earlier than the motion: where errors may be as large as the motion, it has nothing to say.
    """
    if arithmetic()[0] is np.float64 or mechanism.loops or sudden(mechanism) or form_of(mechanism) is not None:
        course = followed(mechanism, times)
        return course, witness_of(mechanism, times, course)
    require_independent(mechanism)
    require_drivable(mechanism)
    require_modelled(mechanism)
    with ThreadPoolExecutor(1) as threads:
        compiled = _recursion_compiled(mechanism, threads)
        begin = _lagrangian_beside(mechanism, threads)
        with stops_explained(mechanism):
            measured = measurement(mechanism, times)
        of_any = measured.growth.until(times).of_any
        known = times[: max(1, int(np.searchsorted(of_any, 1 / float(np.finfo(arithmetic()[0]).eps))))]
        witness = begin(known)
        wait(compiled)
        return by_recursion(mechanism, times, measured), witness()


def witness_of(mechanism: Mechanism, times: Array, course: Followed) -> Way | None:
    """The witness of a motion: the recursion for a closed form, else the Lagrangian; None if it cannot follow the motion.

    The witness of a mechanism with loops is another one: see `_loops_witness`. The Lagrangian has no bounds of its errors: see
    `errors_of_witness`.
    """
    if mechanism.loops:
        return _loops_witness(mechanism, times, course)
    if not course.form:
        return lagrangian(mechanism, times)
    try:
        return by_recursion(mechanism, times, course.measured).way
    except (NotModelled, OutOfReach):
        return None


def lagrangian(mechanism: Mechanism, times: Array, dtype: Any = None) -> Way | None:
    """The motion by the Lagrangian at times (n,), s; None if the Lagrangian cannot follow the motion.

    dtype: the floating-point type where heyoka is installed, by default the widest of NumPy.
    """
    widest = arithmetic()[0]
    if widest is np.float64:
        return _unless_out_of_reach(lambda: solution.follow_in_doubles(mechanism, times), times)
    return _unless_out_of_reach(lambda: solution.follow(mechanism, times, dtype or widest), times)


def _recursion_compiled(mechanism: Mechanism, threads: Executor) -> list[Future[Any]]:
    """The compilations, by a thread, of the equations without dry friction by which `by_recursion` follows trees."""
    from bodycheck.reference.mechanisms.tree_equations import first_integrator, shape_of  # it needs heyoka

    kind = FloatType(arithmetic()[0])
    smooth = [tree for tree in forest(mechanism).trees if not any(link.friction for link in tree.links)]
    return [threads.submit(first_integrator, shape_of(tree), kind) for tree in smooth]


def _lagrangian_beside(mechanism: Mechanism, threads: Executor) -> Callable[[Array], Callable[[], Way | None]]:
    """A function that begins the motion of `lagrangian` at times (n,), s, and returns what waits for it.

    A thread compiles the equations and solves them meanwhile.
    """
    try:
        begin = solution.begun(mechanism, threads, arithmetic()[0])
    except (NotModelled, OutOfReach):
        return lambda times: lambda: None

    def beside(times: Array) -> Callable[[], Way | None]:
        waiting = begin(times)
        return lambda: _unless_out_of_reach(waiting, times)

    return beside


def _unless_out_of_reach(follow: Callable[[], WideMotion], times: Array) -> Way | None:
    """The way of a motion by the Lagrangian at times (n,), s; None if the Lagrangian cannot follow it."""
    _, name, digits = arithmetic()
    try:
        return Way(f"{solution.NAME}, {name}", motion_of(follow(), times), {}, digits)
    except (NotModelled, OutOfReach):
        return None


def _loops_witness(mechanism: Mechanism, times: Array, course: Followed) -> Way | None:
    """The witness of a mechanism with loops: for a closed form the multipliers, else the Lagrangian or the equations of bodies.

    The Lagrangian cannot pass positions in which a mechanism can change to another mode of motion, and does not model loops
    with free bodies. Returns None if no witness can follow the motion.
    """
    if not course.form and (way := _closed_lagrangian(mechanism, times)) is not None:
        return way
    try:
        return loops.way(mechanism, times) if course.form else loops.witness(mechanism, times)
    except (NotModelled, OutOfReach):
        return None


def _closed_lagrangian(mechanism: Mechanism, times: Array) -> Way | None:
    """The motion by the Lagrangian with multipliers; None without heyoka, if it cannot follow the motion, or if loops open."""
    way = None if arithmetic()[0] is np.float64 else lagrangian(mechanism, times)
    if way is None or float(np.max(gaps(mechanism, way.motion.bodies), initial=0.0)) > OPEN * reach(mechanism):
        return None
    return replace(way, name=way.name.replace(solution.NAME, f"{solution.NAME} with multipliers"))


def errors_of_witness(mechanism: Mechanism, times: Array, course: Followed, witness: Way) -> dict[str, Array]:
    """Bounds (n,) of the errors of a witness at times (n,), s; empty if they are not known.

    Those of the Lagrangian are rounding errors, whose number is measured and whose growth is that of the recursion.
    """
    if witness.errors or course.growth is None or course.measured is None:
        return witness.errors
    count = roundings_of_lagrangian(mechanism, times, course.measured.growth)
    return rounding_errors(mechanism, witness.motion, course.growth, count, float(np.finfo(arithmetic()[0]).eps))


def roundings_of_lagrangian(mechanism: Mechanism, times: Array, grown: Growth) -> float:
    """Return the number of roundings of the Lagrangian, measured as for the recursion.

    grown: the growth of an error at the `growth_instants` of the times (n,), s.
    """
    dtype, _, _ = arithmetic()
    if dtype is np.float64:
        return DOP853_ROUNDINGS
    measured = growth_instants(times)
    ways = [lagrangian(mechanism, measured, each) for each in (dtype, np.float64)]
    motions = [way.motion for way in ways if way is not None]
    return roundings(mechanism, motions[1], motions[0], grown) if len(motions) == 2 else FEWEST_ROUNDINGS
