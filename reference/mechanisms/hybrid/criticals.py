"""Impacts, joints that turn back near stops, and joints that almost move: `deciding` asks whether errors change them."""

from collections.abc import Sequence

from bodycheck.reference.exact.numbers import MP, Real
from bodycheck.reference.mechanisms.hybrid.beginning import Begun, Hit, Problem
from bodycheck.reference.mechanisms.link_states import Critical, floating, places_of_rates, sizes
from bodycheck.reference.mechanisms.tree import Tree

#: The part of the forces below which a decision about joints at rest is kept, and the distance from a stop, in units of 1 or of
#: the place of the stop, below which a joint that turns back there is.
NEAR = 1e-3


def of_beginnings(problem: Problem, begun: Sequence[tuple[Real, Begun]]) -> list[Critical]:
    """The impacts at the beginnings of phases, at their times (s), and the joints at rest there that almost move."""
    tree, criticals = problem.tree, list[Critical]()
    times = [time for time, each in begun if each.hits]
    for time, each in begun:
        for hit in each.hits:
            link, others = tree.links[hit.link], [abs(time - other) for other in times if other != time]
            room = min([*others, *_to_instants(tree, time)], default=MP.inf)
            criticals.append(
                Critical(
                    float(time), link.joint, "impact", _turns(tree, hit.link), float(room), abs(hit.speed), _jumps(tree, hit)
                )
            )
        if each.room < NEAR:
            index = next(index for index, mode in each.phase.rest.items() if not mode or index in each.phase.begun)
            criticals.append(Critical(float(time), tree.links[index].joint, "rest", _turns(tree, index), each.room))
    return criticals


def _turns(tree: Tree, index: int) -> bool:
    return tree.links[index].kind == "revolute"


def _to_instants(tree: Tree, time: Real) -> list[Real]:
    """The times from a time to the nearest instants of the controllers that read velocities, and to the end of rigid stops."""
    rates = [
        MP.mpf(controller.rate)
        for link in tree.links
        if (controller := link.controller) and controller.rate and (controller.kd or controller.no_load_speed is not None)
    ]
    ends = [] if tree.stops_until is None else [abs(time - MP.mpf(tree.stops_until))]
    return [abs(time - MP.nint(time * rate) / rate) for rate in rates] + ends


def _jumps(tree: Tree, hit: Hit) -> tuple[float, float]:
    """The largest jumps of rates and of velocities at an impact, of all joints."""
    jumps = {True: 0.0, False: 0.0}
    for link, first in zip(tree.links, places_of_rates(tree.links), strict=True):
        for change in hit.change[first : first + sizes(link)[1]]:
            turns = link.kind != "prismatic"
            jumps[turns] = max(jumps[turns], abs(change))
    count = sum(sum(sizes(link)) for link in tree.links)
    for number, _ in enumerate(floating(tree.links)):
        first = count + 6 * number + 3
        jumps[False] = max(jumps[False], *(abs(change) for change in hit.change[first : first + 3]))
    return jumps[True], jumps[False]


def touch(problem: Problem, index: int, time: float, q: float) -> Critical | None:
    """Return that a joint turns back at a coordinate; None if it is not near a stop there."""
    gaps = [abs(q - float(stop)) / (1 + abs(float(stop))) for _, stop in problem.limits(index)]
    gap = min(gaps)
    if gap > NEAR:
        return None
    return Critical(time, problem.tree.links[index].joint, "touch", _turns(problem.tree, index), gap)
