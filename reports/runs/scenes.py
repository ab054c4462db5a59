"""The description of a case in words: its bodies, joints, initial state, environment and truth."""

import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from bodycheck.casefile.content import Case
from bodycheck.reference.bodies import bodies
from bodycheck.reference.contact.motion import Event, EventKind, Interface
from bodycheck.reference.mechanisms.mechanism import WORLD, AnyScene, Joint, Mechanism, PairContact
from bodycheck.reference.planar import Stop
from bodycheck.reference.requirements import of_mechanism, slides
from bodycheck.reference.scene import Brick, Cylinder, Ellipsoid, Plane, Push, Scene, Shape, Sphere
from bodycheck.reference.truths import NoTruth, Truth
from bodycheck.reports.quantities import bound, count, listing, number, vector
from bodycheck.reports.runs.control import controllers, stops, unit_of
from bodycheck.running.certificates import certificate_of, word_of

#: The verbs for the events of bodies that touch.
EVENTS: dict[EventKind, str] = {
    "impact": "hits",
    "roll": "begins to roll",
    "slip": "begins to slip",
    "rest": "comes to rest",
    "tip": "begins to tip",
    "turn": "begins to turn about its contacts",
}

#: The most bodies, joints or contacts that are described individually.
MOST_TOLD = 6

#: The names of what acts along a joint, by the fields of `Joint`.
ACTING = {
    "armature": "an armature",
    "damping": "damping",
    "stiffness": "a spring",
    "friction": "dry friction",
    "effort": "a constant effort",
}

#: The most events, and the most loads, that are described individually.
MOST_EVENTS = 6


@dataclass(frozen=True)
class Fact:
    """A fact about a case: a term and a text."""

    term: str
    text: str


@dataclass(frozen=True)
class Told:
    """The facts about a truth: entries of `Truth` about how it was computed, and the largest error (rad) of its attitude."""

    model: str
    reason: str
    backend: str
    witnesses: tuple[str, ...]
    stop: Stop | None
    events: tuple[Event, ...]
    friction: float
    interfaces: tuple[Interface, ...]
    error: float

    @classmethod
    def of(cls, truth: Truth) -> "Told":
        """Return the facts about a truth."""
        error = float(np.fmax.reduce(truth.bounds.error))
        how = truth.model, truth.reason, truth.backend, truth.witnesses
        return cls(*how, truth.stop, truth.events, truth.friction, truth.interfaces, error)


def describe(case: Case, truths: Sequence[Told | NoTruth]) -> tuple[Fact, ...]:
    """Return the facts about a case. truths: the truths with which its runs are compared, one for each time step."""
    scene = case.scene
    return (
        *_facts(scene),
        Fact("Duration", f"{number(case.duration)} s, sampled at {case.samples} instants"),
        *((Fact("Truth", _truth(case, truths)),) if truths else ()),
        *_stop(truths),
        *_happens(scene, truths),
    )


def softness(scene: AnyScene, soft: Mapping[str, Mapping[str, str]]) -> tuple[Fact, ...]:
    """Return what engines that ran a scene model by springs and dampers.

    soft: requirements of mechanisms, with the options of their softness, by the names of the engines.
    """
    if not isinstance(scene, Mechanism):
        return ()
    required, engines = of_mechanism(scene).names(), dict[str, list[str]]()
    for engine, options in soft.items():
        if held := [f"{name} ({options[name]})" for name in required if name in options]:
            engines.setdefault(listing(held), []).append(engine)
    texts = [f"{held} in {listing(names)}" for held, names in engines.items()]
    if not texts:
        return ()
    return (Fact("Springs and dampers", f"{'; '.join(texts)}. A part of the error does not vanish with the time step."),)


def _facts(scene: AnyScene) -> tuple[Fact, ...]:
    """Return the facts about bodies, start, joints and environment of a scene."""
    surroundings = Fact("Environment", ", ".join(_environment(scene)))
    if isinstance(scene, Scene):
        body = scene.body
        made_of = f"{_shape(body.shape)}, {number(body.mass)} kg, principal moments {vector(body.moments)} kg m²"
        return Fact("Body", made_of), Fact("Start", _start(scene)), surroundings
    loops = f"{count(len(scene.loops), 'loop')}, each of which holds a point of one body on a point of another"
    return (
        Fact("Bodies", _bodies(scene)),
        Fact("Joints", _joints(scene)),
        *((Fact("Loops", loops),) if scene.loops else ()),
        *((Fact("Controllers", controllers(scene)),) if scene.controllers else ()),
        surroundings,
    )


def _start(scene: Scene) -> str:
    """Return the initial motion of a single body in words."""
    start = scene.initial
    spin, speed = math.hypot(*start.angular_velocity), math.hypot(*start.velocity)
    motion = f"spinning at {number(spin)} rad/s, {vector(start.angular_velocity)} about I, J, K" if spin else "not spinning"
    travel = f"moving at {number(speed)} m/s, {vector(start.velocity)} along x, y, z" if speed else "centre of mass at rest"
    return f"{motion}; {travel}"


def _environment(scene: AnyScene) -> Iterator[str]:
    """Yield descriptions of gravity, the plane, contacts, forces and drag."""
    yield f"gravity {number(scene.gravity)} m/s²" if scene.gravity else "no gravity"
    if scene.plane is not None:
        yield _flat_plane(scene.plane) if slides(scene) else _on_plane(scene.plane)
    if isinstance(scene, Mechanism):
        yield from (_contact(scene, pair) for pair in scene.contacts[:MOST_TOLD])
        yield from ["and other pairs"] if len(scene.contacts) > MOST_TOLD else []
        yield from (_pushed(push, scene.bodies[push.body].name) for push in scene.pushes)
    elif scene.plane is not None:
        yield from map(_pushed, scene.pushes)
    if isinstance(scene, Scene) and scene.drag:
        yield f"drag {number(scene.drag)} kg/m times speed squared"


def _flat_plane(plane: Plane) -> str:
    return f"on a plane with friction coefficient {number(plane.friction)} ({plane.law} law)"


def _on_plane(plane: Plane) -> str:
    """Return the description of a plane on which bodies roll, bounce and rest."""
    tilted = f"inclined by {number(plane.incline)} rad " if plane.incline else ""
    return f"on a plane {tilted}with {_touching(plane)}"


def _contact(mechanism: Mechanism, pair: PairContact) -> str:
    """Return the description of the contact of two bodies."""
    one, other = ("the plane" if place == WORLD else mechanism.bodies[place].name for place in pair.bodies)
    return f"between {one} and {other} {_touching(pair)}"


def _pushed(push: Push, name: str = "") -> str:
    """Return the description of a constant force. name: the name of the body; empty if there is only one body."""
    during = f" from {number(push.start)} s" if push.start else ""
    during += f" until {number(push.end)} s" if math.isfinite(push.end) else ""
    where = f" at {vector(push.point)} m from the centre of mass" if any(push.point) else ""
    return f"pushed {f'{name} ' if name else ''}with {vector(push.force)} N{where}{during}"


def _touching(law: Plane | PairContact) -> str:
    """Return the description of the coefficients of a contact."""
    slips = not math.isinf(law.friction)
    rough = f"friction coefficient {number(law.friction)}" if slips else "friction so large that nothing slips"
    moments = {"rolling": law.rolling_friction, "torsional": law.torsional_friction}
    braked = [f"{name} friction {number(value)} m" for name, value in moments.items() if value]
    cone = " in one cone" if braked and law.cone == "one" else ""
    bounces = f"coefficient of restitution {number(law.restitution)}"
    return f"{listing([rough, *braked])}{cone}, and {bounces}" if braked else f"{rough} and {bounces}"


def _bodies(mechanism: Mechanism) -> str:
    masses = {body.name: body.mass for body in bodies(mechanism) if body.mass}  # frames are no bodies for readers
    if len(masses) > MOST_TOLD:
        least, most = number(min(masses.values())), number(max(masses.values()))
        return f"{len(masses)} of {least if least == most else f'{least} to {most}'} kg"
    return listing([f"{name} {number(mass)} kg" for name, mass in masses.items()])


def _joints(mechanism: Mechanism) -> str:
    """Return the description of the joints: each joint, or the number of joints of each type if there are many."""
    free = sum(joint is None for joint in mechanism.joint_of)
    rest = f"{count(free, 'body', 'bodies')} on no joint" if free else ""
    if not mechanism.joints:
        return rest
    if len(mechanism.joints) <= MOST_TOLD:
        told = "; ".join(_joint(mechanism, joint) for joint in mechanism.joints)
    else:
        types = Counter(joint.type for joint in mechanism.joints).items()
        told = listing([f"{amount} {kind}" for kind, amount in types])
        acting = [text for name, text in ACTING.items() if any(getattr(joint, name) for joint in mechanism.joints)]
        followers = sum(joint.mimic is not None for joint in mechanism.joints)
        acting += [count(followers, "joint that follows another", "joints that follow others")] if followers else []
        stopped = sum(joint.stops is not None for joint in mechanism.joints)
        acting += [f"stops of {count(stopped, 'joint')}"] if stopped else []
        told += f", with {listing(acting)}" if acting else ""
    return "; ".join(filter(None, (told, rest)))


def _joint(mechanism: Mechanism, joint: Joint) -> str:
    parent = "the world" if joint.parent == WORLD else mechanism.bodies[joint.parent].name
    acting = [text for name, text in ACTING.items() if getattr(joint, name)]
    acting += [stops(joint.stops, unit_of(joint))] if joint.stops is not None else []
    with_these = f", with {listing(acting)}" if acting else ""
    follows = f", follows {mechanism.joints[joint.mimic.joint].name}" if joint.mimic is not None else ""
    return f"{joint.name}: {joint.type}, {mechanism.bodies[joint.child].name} on {parent}{with_these}{follows}"


def _happens(scene: AnyScene, truths: Sequence[Told | NoTruth]) -> tuple[Fact, ...]:
    """Return the events of bodies that touch and the loads of bodies at rest, which are the same for every time step."""
    told = next((truth for truth in truths if isinstance(truth, Told) and (truth.events or truth.interfaces)), None)
    if told is None:
        return ()
    names = [body.name if isinstance(scene, Mechanism) else "the body" for body in bodies(scene)]
    events = [f"{names[event.body]} {EVENTS[event.kind]} after {number(event.time)} s" for event in told.events[:MOST_EVENTS]]
    if (more := len(told.events) - MOST_EVENTS) > 0:
        events.append(f"{count(more, 'further event')} until {number(told.events[-1].time)} s")
    places = [["the plane" if place == WORLD else names[place] for place in pair.bodies] for pair in told.interfaces]
    loads = [
        f"{one} bears {other} with {number(pair.load)} N" for pair, (one, other) in zip(told.interfaces, places, strict=True)
    ]
    if len(loads) > MOST_EVENTS:
        loads = [*loads[:MOST_EVENTS], f"and {count(len(loads) - MOST_EVENTS, 'further pair')}"]
    return (
        *((Fact("Events", "; ".join(events)),) if events else ()),
        *((Fact("Loads", "; ".join(loads)),) if loads else ()),
    )


def _stop(truths: Sequence[Told | NoTruth]) -> tuple[Fact, ...]:
    """Return the time and place at which the body comes to rest, which are the same for every time step."""
    for truth in truths:
        if isinstance(truth, Told) and truth.stop is not None:
            stop = truth.stop
            where = f"at {vector(stop.position)} m, with a yaw of {number(stop.yaw)} rad"
            return (Fact("Rest", f"after {number(stop.time)} s {where}"),)
    return ()


def _shape(shape: Shape | None) -> str:
    match shape:
        case Brick((a, b, c)):
            return f"brick of {' × '.join(number(2 * half) for half in (a, b, c))} m along I, J, K"
        case Ellipsoid(semi_axes):
            return f"ellipsoid of semi-axes {' × '.join(map(number, semi_axes))} m along I, J, K"
        case Cylinder(radius, half_length):
            return f"cylinder about K of radius {number(radius)} m and length {number(2 * half_length)} m"
        case Sphere(radius):
            return f"sphere of radius {number(radius)} m"
        case None:
            return "body without a shape"


def _truth(case: Case, truths: Sequence[Told | NoTruth]) -> str:
    """Return the description of the truth: its source and the reason for it, independent checks, error bound, and its word."""
    known = [truth for truth in truths if isinstance(truth, Told)]
    if not known:
        reasons = dict.fromkeys(truth.reason for truth in truths if isinstance(truth, NoTruth))
        return f"none: {'; '.join(reasons)}"
    sources = dict.fromkeys(f"{_source(truth)}, because {truth.reason}" for truth in known)
    # A witness is named by its equations and its solver, with a comma between them.
    witnesses = list(dict.fromkeys(witness.replace(", ", " by ") for truth in known for witness in truth.witnesses))
    checked = f" Checked by {count(len(witnesses), 'independent computation')}: {listing(witnesses)}." if witnesses else ""
    errors = [truth.error for truth in known if not math.isnan(truth.error)]
    least = f"Its attitude is wrong by at most {bound(max(errors), 2)} rad." if errors else "It gives no motion."
    return f"{' and '.join(sources)}.{checked} {least} {_word(case, compared=bool(witnesses))}"


def _word(case: Case, *, compared: bool) -> str:
    """Return how well the truth of a case is known: it is enclosed, cross-checked or estimated."""
    proof = certificate_of(case)
    if proof is None:
        return f"It is {word_of(case, compared=compared)}."
    if proof.distance is None:
        return f"It is {proof.word}, without a proof: {proof.reason}."
    until = "" if proof.until is None else f" until {number(proof.until)} s"
    return f"It is {proof.word}{until}: a proof puts its attitude within {bound(proof.distance, 2)} rad of the exact one."


def _source(truth: Told) -> str:
    """Return how a truth was computed, in words: with a formula, or by integration of equations of motion."""
    formula = truth.model.removeprefix("closed form: ")
    if formula != truth.model:
        return f"an exact formula ({formula}), evaluated with {truth.backend}"
    return f"equations of motion ({truth.model}), integrated with {truth.backend}"
