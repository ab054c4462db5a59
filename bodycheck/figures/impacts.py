"""Figures of what bodies exchange in impacts, on a plane and on each other: energy and momentum.

Each impact of a run is compared with the impact of the same number in the truth, measured by the same formulas from the same
instants. Both are relative to the energy and the momentum before the impact, so that errors of earlier impacts do not count.
"""

import math
from collections.abc import Callable, Iterator

import numpy as np

from bodycheck.figures.definition import Comparison, Figure
from bodycheck.figures.touching import would_bounce
from bodycheck.reference.bodies import bodies
from bodycheck.reference.contact.impacts import Impact
from bodycheck.reference.contact.meetings import Exchange, Meeting, Partner, exchange
from bodycheck.reference.scene import Sphere
from bodycheck.reference.scenes import Scenes

#: The part of its radius up to which the height of a sphere above the plane is that of a sphere on the plane.
ON_PLANE = 1e-9


def exchanges(compared: Comparison) -> Iterator[tuple[Exchange, Exchange]]:
    """Yield what bodies exchange in each impact of the run and in the same impact of the truth.

    An impact that the run does not have exchanges nothing. Impacts on the plane are left out from the first on after which the
    samples do not show a flight.
    """
    for index, body in enumerate(compared.touching):
        if not any(event.ends_flight for event in compared.events if event.body == index):
            continue
        for seen, exact in zip(compared.impacts[index], compared.exact_impacts[index], strict=False):
            if not exact.seen or not (seen.seen or would_bounce(seen, body, compared)):
                break
            yield _exchanged(compared, (index,), seen, 0), _exchanged(compared, (index,), exact, 1)
    for pair, true in compared.exact_meetings.items():
        hits, none = compared.meetings[pair], Exchange(0.0, np.zeros((len(pair), 3)))
        for number, meeting in enumerate(true):
            run = _exchanged(compared, pair, hits[number], 0) if number < len(hits) else none
            yield run, _exchanged(compared, pair, meeting, 1)


def _exchanged(compared: Comparison, indices: tuple[int, ...], hit: Impact | Meeting, way: int) -> Exchange:
    """Return what bodies, given by their indices, exchange in an impact. way: 0 for the run, and 1 for the truth."""
    scene = compared.scene
    assert not isinstance(scene, Scenes)  # several scenes have no impacts
    falling, partners = np.array([0.0, 0.0, -scene.gravity]), []
    for index in indices:
        body, motion = bodies(scene)[index], compared.motions[index][way]
        borne = len(indices) > 1 and _on_plane(compared, index, hit.start)
        partners.append(Partner(body.mass, body.tensor, motion, 0 * falling if borne else falling))
    return exchange(partners, hit)


def _on_plane(compared: Comparison, index: int, time: float) -> bool:
    """Return whether the plane bears a sphere in the truth at an instant (s)."""
    if not compared.touching:
        return False
    body, exact = compared.touching[index], compared.motions[index][1]
    assert isinstance(body.shape, Sphere)  # others that hit each other have no truth
    height = float(exact.position[int(np.searchsorted(exact.t, time))] @ np.array(body.normal))
    return height - body.shape.radius <= ON_PLANE * body.shape.radius


def _largest(difference: Callable[[Exchange, Exchange], float]) -> Callable[[Comparison], float | None]:
    """Return a function that computes the largest difference of a run's and the truth's exchanges over all impacts."""

    def compute(compared: Comparison) -> float | None:
        differences = (difference(seen, exact) for seen, exact in exchanges(compared))
        return max((each for each in differences if not math.isnan(each)), default=None)

    return compute


FIGURES = (
    Figure(
        name="impact_energy_error",
        title="Impact energy error",
        meaning=(
            "difference between the change of the mechanical energy in an impact and the exact change, each relative to the "
            "kinetic energy before, the largest over all impacts"
        ),
        remark="of bodies that hit the plane or each other, from the samples before and after the contact",
        compute=_largest(lambda seen, exact: abs(seen.energy - exact.energy)),
    ),
    Figure(
        name="impact_momentum_error",
        title="Impact momentum error",
        meaning=(
            "difference between the impulse on a body in an impact and the exact impulse, each relative to the sum of the "
            "momenta of the bodies before, the largest over all impacts and bodies"
        ),
        remark="of bodies that hit the plane or each other, from the samples before and after the contact",
        compute=_largest(lambda seen, exact: float(np.linalg.norm(seen.momentum - exact.momentum, axis=-1).max())),
    ),
)
