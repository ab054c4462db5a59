"""Convert bodies that touch a plane and each other to the forms that engines take."""

import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Generic, TypeVar

import numpy as np

from bodycheck.adapters.contract import EngineDiverged, Method, SceneUnsupported, Simulation, Strides
from bodycheck.reference.errors import NotFlat
from bodycheck.reference.mechanisms import kinematics
from bodycheck.reference.mechanisms.exact import nearest_inertia
from bodycheck.reference.mechanisms.mechanism import WORLD, AnyScene, Mechanism, PairContact, shape_of
from bodycheck.reference.planar import describe_shape, planar_state
from bodycheck.reference.scene import Body, Brick, Cone, Cylinder, Plane, Push, Scene, Shape, State, Vector
from bodycheck.reference.trajectory import Array


@dataclass(frozen=True)
class TouchingBody:
    """A free body, its shape, and its state at t = 0.

    Its frame has the axes of the frame in the case, and its origin is the centre of mass.
    """

    name: str
    body: Body
    shape: Shape
    start: State


@dataclass(frozen=True)
class Law:
    """The contact law of a pair of bodies: their indices, the lower one first, which may be `WORLD`, and the coefficients.

    `rolling_friction` and `torsional_friction` are in m, and `cone` is as in `scene.Plane`.
    """

    bodies: tuple[int, int]
    friction: float
    restitution: float
    rolling_friction: float = 0.0
    torsional_friction: float = 0.0
    cone: Cone = "product"

    @property
    def resists(self) -> bool:
        """Return whether the pair has rolling or torsional friction."""
        return self.rolling_friction > 0 or self.torsional_friction > 0


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

    Both indices of the first law are `WORLD`. Without a plane, which an adapter models only if its record has "contacts without
    a plane", the first law counts for no pair: only the pairs of the other laws touch.
    """
    pairs = scene.contacts if isinstance(scene, Mechanism) else ()
    usual = Plane() if scene.plane is None else scene.plane
    return _law((WORLD, WORLD), usual), *(_law(pair.bodies, pair) for pair in pairs)


def laws_of_pairs(scene: AnyScene, count: int) -> dict[tuple[int, int], Law]:
    """Return the law of each pair that may touch, of the plane with each of `count` bodies, and then of two bodies.

    The keys are as `Law.bodies`.
    """
    usual, *others = laws(scene)
    stated = {law.bodies: law for law in others}
    pairs = [*((WORLD, index) for index in range(count)), *itertools.combinations(range(count), 2)]
    if scene.plane is None:
        return {pair: stated[pair] for pair in pairs if pair in stated}
    return {pair: stated.get(pair, usual) for pair in pairs}


def _law(bodies: tuple[int, int], given: Plane | PairContact) -> Law:
    coefficients = given.friction, given.restitution, given.rolling_friction, given.torsional_friction
    return Law(bodies, *coefficients, given.cone)


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


Stepped = TypeVar("Stepped", bound=Simulation)


@dataclass
class Pushed(Generic[Stepped]):
    """A simulation of bodies whose pushes begin and end at the starts of steps.

    Parameters
    ----------
    simulation
        The simulation without changes of the pushes.
    pushes
        The pushes that act from certain steps on, as `switches` returns them.
    exert
        Makes pushes act from now on, in the place of those before.
    done
        The number of steps taken.
    """

    simulation: Stepped
    pushes: Mapping[int, tuple[Push, ...]]
    exert: Callable[[tuple[Push, ...]], None]
    done: int = 0

    def advance(self, strides: Strides) -> Array:
        """Return the states (1, n, bodies, 13) after each of n strides, as `Simulation.advance` does."""
        ends = self.done + np.cumsum(strides)
        cuts = np.array([step for step in self.pushes if self.done < step < ends[-1]], dtype=np.int64)
        stops = np.union1d(ends, cuts)
        parts: list[Array] = []
        for stretch in np.split(stops, np.searchsorted(stops, cuts, side="right")):
            self.switch()
            try:
                parts.append(self.simulation.advance(np.diff(stretch, prepend=self.done)))
            except EngineDiverged as signal:
                seen = np.concatenate([*parts, signal.states], axis=1)
                rows = np.searchsorted(stops, ends)
                signal.states = seen[:, [*rows[rows < seen.shape[1] - 1], seen.shape[1] - 1]][:, : len(ends)]
                raise
            self.done = int(stretch[-1])
        return np.concatenate(parts, axis=1)[:, np.searchsorted(stops, ends)]

    def loads(self, steps: int, step: Callable[[], Mapping[tuple[int, int], float]]) -> dict[tuple[int, int], Array]:
        """Return the normal forces (n,), in N, of the pairs that touch in any of n steps; see `InterfaceLoads`.

        `step` takes one step, and returns the normal forces (N) of the pairs that touch in it.
        """
        by_pair: dict[tuple[int, int], Array] = {}
        edges = [0, *(edge for edge in self.pushes if 0 < edge < steps), steps]
        for first, last in pairwise(edges):
            self.switch()
            for number in range(first, last):
                for pair, load in step().items():
                    by_pair.setdefault(pair, np.zeros(steps))[number] = load
            self.done = last
        return by_pair

    def switch(self) -> None:
        """Make the pushes act that act from the current step on."""
        self.exert(self.pushes[max(step for step in self.pushes if step <= self.done)])


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
