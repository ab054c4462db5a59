"""Convert bodies that touch a plane and each other to the forms that engines take."""

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal, Protocol, runtime_checkable

import numpy as np

from bodycheck.adapters.contract import Method, SceneUnsupported, Simulation
from bodycheck.reference.errors import NotFlat
from bodycheck.reference.mechanisms import kinematics
from bodycheck.reference.mechanisms.exact import nearest_inertia
from bodycheck.reference.mechanisms.mechanism import WORLD, AnyScene, Mechanism, shape_of
from bodycheck.reference.planar import describe_shape, planar_state
from bodycheck.reference.scene import Body, Brick, Cylinder, Plane, Push, Scene, Shape, State, Vector

#: How an engine combines the coefficients of two bodies.
Combination = Literal["product", "mean"]

#: The largest relative difference of two coefficients that count as equal. It is rounding in the solution of a few equations.
ROUNDING = 1e-9

#: Pairs of bodies by their indices, the lower one first, which may be `WORLD`, with their coefficients.
Pairs = Mapping[tuple[int, int], float]


@dataclass(frozen=True)
class TouchingBody:
    """A free body, its shape, and its state at t = 0.

    Its frame has the axes of the frame in the case, and its origin is the centre of mass.
    """

    name: str
    body: Body
    shape: Shape
    start: State


@runtime_checkable
class Boxes(Protocol):
    """An adapter that can give its engine free boxes that touch, though its record offers no bodies that touch.

    It is for `bodycheck audit`, which needs no truth of these scenes. An adapter whose record models contacts prepares them by
    `Adapter.prepare` instead.
    """

    def prepare_boxes(self, scene: Mechanism, method: Method) -> Simulation:
        """Return a simulation of free bricks that touch the level plane of the scene and each other, at t = 0.

        The friction and the restitution of the plane are the coefficients of all pairs. There are no joints, pushes or other
        pairs. Raises `SceneUnsupported`.
        """
        ...


@dataclass(frozen=True)
class Law:
    """The contact law of a pair of bodies: their indices, the lower one first, which may be `WORLD`, and the coefficients."""

    bodies: tuple[int, int]
    friction: float
    restitution: float


def touching_bodies(scene: AnyScene) -> tuple[TouchingBody, ...]:
    """Return the bodies of a scene in their order, with the doubles that are nearest to the numbers of the case.

    Raises `SceneUnsupported` for a body without a shape, and for a body with products of inertia.
    """
    if not isinstance(scene, Mechanism):
        return (TouchingBody("body", scene.body, _shaped(scene.body.shape), scene.initial),)
    start, bodies = kinematics.initial(scene), []
    for index, body in enumerate(scene.bodies):
        inertia, motion = nearest_inertia(body), start.body(index)
        xx, yy, zz, *products = inertia.tensor
        if any(products):
            raise SceneUnsupported(f"the body {body.name}, whose frame is not along its principal axes, touches others")
        parts = (motion.position, motion.quaternion, motion.velocity, motion.angular_velocity)
        state = State(*(tuple(part[0].tolist()) for part in parts))
        shape = _shaped(shape_of(body))
        bodies.append(TouchingBody(body.name, Body(inertia.mass, (xx, yy, zz), shape), shape, state))
    return tuple(bodies)


def half_lengths(body: TouchingBody) -> Vector:
    """Return half the lengths of a brick (m). Raises `SceneUnsupported` for a body of another shape."""
    if not isinstance(body.shape, Brick):
        raise SceneUnsupported(f"{describe_shape(body.shape)} among boxes that touch")
    return body.shape.semi_axes


def plane_of(scene: AnyScene) -> Plane:
    """Return the plane of a scene whose bodies touch a plane."""
    assert scene.plane is not None  # `requirements.touches` has said so
    return scene.plane


def laws(scene: AnyScene) -> tuple[Law, ...]:
    """Return the law of the plane, which is the default for all pairs, then the laws of the pairs with other coefficients.

    Both indices of the first law are `WORLD`.
    """
    plane = plane_of(scene)
    pairs = scene.contacts if isinstance(scene, Mechanism) else ()
    usual = Law((WORLD, WORLD), plane.friction, plane.restitution)
    return usual, *(Law(pair.bodies, pair.friction, pair.restitution) for pair in pairs)


def switches(pushes: Sequence[Push], timestep: float) -> dict[int, tuple[Push, ...]]:
    """Return the pushes that act from each step on at which a push begins or ends, keyed by the number of the step.

    The steps are in ascending order and include step 0. A push begins and ends at the starts of the steps that are nearest to
    its instants. `timestep` is in s.
    """
    spans = [(_nearest(push.start, timestep), _nearest(push.end, timestep), push) for push in pushes]
    steps = sorted({0.0, *(edge for first, end, _ in spans for edge in (first, end) if np.isfinite(edge))})
    return {int(step): tuple(push for first, end, push in spans if first <= step < end) for step in steps}


def acting(pushes: Sequence[Push], timestep: float) -> Iterator[tuple[Push, ...]]:
    """Yield the pushes that act in each step from step 0 on, without end. `timestep` is in s."""
    changes = switches(pushes, timestep)
    now: tuple[Push, ...] = ()
    for step in itertools.count():
        now = changes.get(step, now)
        yield now


def _nearest(instant: float, timestep: float) -> float:
    return float(np.rint(instant / timestep))


def _shaped(shape: Shape | None) -> Shape:
    if shape is None:
        raise SceneUnsupported(f"{describe_shape(shape)} touches others")
    return shape


def not_flat(scene: Scene) -> str | None:
    """Return, as a noun phrase, why no adapter can model a body as one that lies flat on its plane; None if it can."""
    if scene.drag:
        return "drag together with contact"
    try:
        planar_state(scene)
    except NotFlat as error:
        return f"this contact: {error}"
    return None


def corners(scene: Scene, method: Method) -> Plane | None:
    """Return the friction law of rigid contacts at the corners of a body, as `ContactLaw.contact_law` does."""
    return scene.plane and replace(scene.plane, law="corners", pressure="balanced")


def corners_of_brick(scene: Scene, method: Method) -> Plane | None:
    """Return the friction law of rigid contacts at the corners of a brick, as `ContactLaw.contact_law` does.

    Return None for a body that is not a brick.
    """
    return corners(scene, method) if isinstance(scene.body.shape, Brick) else None


def lying_shape(scene: Scene) -> Brick | Cylinder:
    """Return the shape of a body that lies flat on the plane z = 0. Raises `SceneUnsupported` for all other scenes."""
    if (reason := not_flat(scene)) is not None:
        raise SceneUnsupported(reason)
    shape = scene.body.shape
    if not isinstance(shape, Brick | Cylinder):
        raise SceneUnsupported(f"{describe_shape(shape)} has no face to lie on")
    return shape


@dataclass(frozen=True)
class Coefficients:
    """The coefficients of friction and of restitution of a body, or of the plane."""

    friction: float
    restitution: float


def coefficients(scene: AnyScene, count: int, rule: Combination) -> dict[int, Coefficients]:
    """Return the coefficients of the plane, with the index `WORLD`, and of each of the `count` bodies of a scene.

    They are for engines that combine the coefficients of two bodies to that of their pair. Scenes state those of pairs, which
    products or means cannot always give. The pairs of `[[scene.contacts]]` come first, then those of the plane and a body, then
    all others; a pair whose coefficient contradicts those before it gets another one, which `differences` tells.
    """
    friction, restitution = (_shared(pairs, rule) for pairs in _wanted(scene, count))
    return {index: Coefficients(friction[index], restitution[index]) for index in (WORLD, *range(count))}


def differences(scene: AnyScene, bodies: Sequence[TouchingBody], rule: Combination, largest: float = np.inf) -> list[str]:
    """Return, as noun phrases, the coefficients of pairs that differ from those of the scene. largest: friction of a pair."""
    given = coefficients(scene, len(bodies), rule)
    groups: dict[str, list[tuple[int, int]]] = {}
    for kind, wanted in zip(("friction", "restitution"), _wanted(scene, len(bodies)), strict=True):
        most = largest if kind == "friction" else np.inf
        for pair, value in wanted.items():
            one, other = (float(getattr(given[index], kind)) for index in pair)
            arrived = min(one * other if rule == "product" else (one + other) / 2, most)
            if not np.isclose(arrived, value, rtol=ROUNDING, atol=0):
                groups.setdefault(f"{kind} {arrived:.3g} instead of {value:.3g}", []).append(pair)
    return [f"{phrase} of {_named(pairs, bodies)}" for phrase, pairs in groups.items()]


def _named(pairs: Sequence[tuple[int, int]], bodies: Sequence[TouchingBody]) -> str:
    """Return the names of the first of some pairs, and the number of the others."""
    first, second = ("the plane" if index == WORLD else bodies[index].name for index in pairs[0])
    others = len(pairs) - 1
    return f"{first} and {second}" + (f" and of {others} other pair{'s' if others > 1 else ''}" if others else "")


def _wanted(scene: AnyScene, count: int) -> tuple[Pairs, Pairs]:
    """Return the friction and the restitution of all pairs, those first that have coefficients of their own."""
    usual, *others = laws(scene)
    special = {law.bodies: law for law in others}
    with_plane = [(WORLD, index) for index in range(count)]
    order = dict.fromkeys([*special, *with_plane, *itertools.combinations(range(count), 2)])
    chosen = {pair: special.get(pair, usual) for pair in order}
    return {pair: law.friction for pair, law in chosen.items()}, {pair: law.restitution for pair, law in chosen.items()}


def _shared(pairs: Pairs, rule: Combination) -> dict[int, float]:
    """Return the coefficients of the plane and of bodies whose combinations give the first pairs that do not contradict.

    The logarithms of factors are summands, so that both rules are linear equations. A body whose pairs all have the coefficient
    zero has itself the factor zero; other pairs with the coefficient zero have no logarithm and are left out.
    """
    indices = sorted({index for pair in pairs for index in pair})
    values = set(pairs.values())
    if len(values) == 1:
        (value,) = values
        return dict.fromkeys(indices, value**0.5 if rule == "product" else value)
    if rule == "mean":
        summands = _solved({pair: 2 * value for pair, value in pairs.items()})
        return {index: max(summand, 0.0) for index, summand in summands.items()}
    zero = {index for index in indices if not any(value for pair, value in pairs.items() if index in pair)}
    logarithms = _solved({pair: float(np.log(value)) for pair, value in pairs.items() if value})
    return {index: 0.0 if index in zero else float(np.exp(logarithms[index])) for index in indices}


def _solved(sums: Pairs) -> dict[int, float]:
    """Return numbers of bodies, the nearest to zero, whose sums are those of the first pairs that do not contradict."""
    indices = sorted({index for pair in sums for index in pair})
    column = {index: number for number, index in enumerate(indices)}
    rows, right = np.zeros((0, len(indices))), np.zeros(0)
    solution = np.zeros(len(indices))
    for pair, value in sums.items():
        row = np.zeros(len(indices))
        row[[column[index] for index in pair]] = 1
        tried, wanted = np.vstack([rows, row]), np.append(right, value)
        candidate = np.linalg.lstsq(tried, wanted, rcond=None)[0]
        if np.allclose(tried @ candidate, wanted, rtol=0, atol=ROUNDING):
            solution = candidate
            if np.linalg.matrix_rank(tried) > len(rows):
                rows, right = tried, wanted
    return dict(zip(indices, solution.tolist(), strict=True))
