"""Step free bodies that touch a plane and each other in Simbody, by OpenSim's compliant contact of Hunt and Crossley.

Each pair has a `HuntCrossleyForce` of its own with the pair's friction. Spheres touch the plane, a `ContactHalfSpace` turned
about y, and each other. OpenSim has no box or cylinder: a brick touches the plane by small spheres in its corners, and bricks
among several bodies, cylinders and ellipsoids are `unsupported`.

OpenSim has no default of the stiffness: a body sinks in by a hundredth of its smallest half-length under its weight, as a flat
brick does (module `contact`), or under standard gravity if there is none. A pair with a coefficient of restitution has the
dissipation that returns it in the first impact; see `bodycheck.adapters.pair_coefficients`. All others are damped critically at
rest. Friction grows with the slip up to OpenSim's default transition speed of 0.01 m/s.

A push is a `PrescribedForce`, which is a function of the time.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import opensim

from bodycheck.adapters.contract import Method, SceneUnsupported
from bodycheck.adapters.links import link_of
from bodycheck.adapters.pair_coefficients import dissipation, impact_speed
from bodycheck.adapters.simbody.contact import RADIUS, SINKING, hardness
from bodycheck.adapters.simbody.mechanisms import in_simbody, placed
from bodycheck.adapters.simbody.models import added
from bodycheck.adapters.touching import Law, TouchingBody, laws, laws_of_pairs, touching_bodies
from bodycheck.reference.mechanisms.mechanism import WORLD, AnyScene
from bodycheck.reference.planar import describe_shape
from bodycheck.reference.requirements import touches
from bodycheck.reference.scene import Brick, Push, Sphere, Vector
from bodycheck.reference.trajectory import Array

#: The requirements of touching bodies that OpenSim models, of which restitution is an approximation.
MODELS = frozenset({"incline", "restitution", "rolling", "pushes", "contacts", "contacts without a plane"})

#: The acceleration (m/s^2) under which bodies sink in by their part where there is no gravity.
STANDARD_GRAVITY = 9.80665

#: The number of corners that bear a brick.
BEARING = 4

#: The part of a step by which rounding could make a step begin too early.
ROUNDING = 1e-6

#: OpenSim's default of the speed of slip (m/s) at which friction has its coefficient.
TRANSITION_SPEED = opensim.HuntCrossleyForce().getTransitionVelocity()

#: The name of the plane, and the beginnings of the names of the spheres of bodies and of the forces of pairs.
PLANE, SHAPE, CONTACT = "plane", "shape", "contact"


@dataclass(frozen=True, eq=False)
class Touching:
    """OpenSim's model of bodies that touch.

    Parameters
    ----------
    model, bodies, joints
        The model, and its bodies and their joints in the order of the scene.
    parts
        The bodies of the scene.
    forces
        The forces of contacts, by the indices of their two bodies, of which the first may be `WORLD`.
    incline
        The slope of the plane (rad).
    """

    model: Any
    bodies: Sequence[Any]
    joints: Sequence[Any]
    parts: Sequence[TouchingBody]
    forces: Mapping[tuple[int, int], Any]
    incline: float

    def loads(self, state: Any) -> dict[tuple[int, int], float]:
        """Return the normal forces (N) of all pairs in a state, which need not be realized."""
        self.model.realizeDynamics(state)
        return {pair: abs(float(self.force(state, pair) @ self.normal(state, pair))) for pair in self.forces}

    def normal(self, state: Any, pair: tuple[int, int]) -> Array:
        """Return the normal (3,) of a pair: that of the plane, or along the line of the centres of two spheres."""
        if WORLD in pair:
            return np.array([math.sin(self.incline), 0.0, math.cos(self.incline)])
        one, other = (self.bodies[index].getPositionInGround(state).to_numpy() for index in pair)
        return np.array((other - one) / np.linalg.norm(other - one))

    def force(self, state: Any, pair: tuple[int, int]) -> Array:
        """Return the force (3,), in N and in the world, of a pair on the second of its bodies, in a realized state."""
        record = self.forces[pair].getRecordValues(state)  # force and torque on the one body, then on the other
        return np.array([record.get(index) for index in range(6, 9)])


def built(scene: AnyScene, method: Method) -> Touching:
    """Return the model of a scene. Raises `SceneUnsupported`."""
    parts = touching_bodies(scene)
    for part in parts:
        check_shape(part, alone=len(parts) == 1)
    model = opensim.Model()
    model.setGravity(opensim.Vec3(0.0, 0.0, -scene.gravity))
    bodies = [added(model, f"body_{index}", link_of(part.body)) for index, part in enumerate(parts)]
    joints = [opensim.FreeJoint(f"joint_{index}", model.getGround(), body) for index, body in enumerate(bodies)]
    for joint in joints:
        model.addJoint(joint)
    geometries = {index: add_spheres(model, body, index, parts[index]) for index, body in enumerate(bodies)}
    if scene.plane is not None:
        # The half-space is on the side to which the x axis of its frame points.
        downwards = opensim.Vec3(0.0, math.pi / 2 + scene.plane.incline, 0.0)
        model.addContactGeometry(opensim.ContactHalfSpace(opensim.Vec3(0.0), downwards, model.getGround(), PLANE))
        geometries[WORLD] = [PLANE]
    between = laws_of_pairs(scene, len(parts))
    forces = {pair: add_force(model, pair, law, geometries, parts, scene) for pair, law in between.items()}
    for number, push in enumerate(scene.pushes):
        add_push(model, bodies[push.body], number, push, method)
    incline = 0.0 if scene.plane is None else scene.plane.incline
    return Touching(model, bodies, joints, parts, forces, incline)


def started(touched: Touching, quaternions: bool) -> Any:
    """Return the initial state of a model, with quaternions or with angles."""
    starts = []
    for part in touched.parts:
        position = np.array([*part.start.position, *part.start.quaternion])
        velocity = np.array([*part.start.velocity, *part.start.angular_velocity])
        starts.append(in_simbody("free", position, velocity, quaternions))
    return placed(touched.model, touched.model.initSystem(), touched.joints, starts, quaternions)


def check_shape(part: TouchingBody, *, alone: bool) -> None:
    """Raise `SceneUnsupported` for a body whose shape is none of OpenSim's. alone: whether it is the only body."""
    if isinstance(part.shape, Sphere) or (isinstance(part.shape, Brick) and alone):
        return
    among = "" if alone else " among several bodies"
    lacking = f"OpenSim has contacts of spheres, half-spaces and meshes, but none of {describe_shape(part.shape)}{among}"
    raise SceneUnsupported(lacking)


def spheres(part: TouchingBody) -> list[tuple[Vector, float]]:
    """Return the centres, in the frame of a body, and the radii of the spheres by which it touches (m)."""
    if isinstance(part.shape, Sphere):
        return [((0.0, 0.0, 0.0), part.shape.radius)]
    assert isinstance(part.shape, Brick)  # `check_shape` has said so
    radius = RADIUS * min(part.shape.semi_axes)
    a, b, c = (half - radius for half in part.shape.semi_axes)
    return [((x, y, z), radius) for x in (-a, a) for y in (-b, b) for z in (-c, c)]


def add_spheres(model: Any, body: Any, index: int, part: TouchingBody) -> list[str]:
    """Add the spheres of a body to a model, and return their names."""
    names = []
    for number, (centre, radius) in enumerate(spheres(part)):
        names.append(f"{SHAPE}_{index}_{number}")
        model.addContactGeometry(opensim.ContactSphere(radius, opensim.Vec3(*centre), body, names[-1]))
    return names


def add_force(
    model: Any,
    pair: tuple[int, int],
    law: Law,
    geometries: Mapping[int, Sequence[str]],
    parts: Sequence[TouchingBody],
    scene: AnyScene,
) -> Any:
    """Add the contact force of a pair with a law to a model, and return it."""
    force = opensim.HuntCrossleyForce()
    force.setName(f"{CONTACT}_{pair[0] - WORLD}_{pair[1] - WORLD}")
    for index in pair:
        for name in geometries[index]:
            force.addGeometry(name)
    stiffness, critical = of_pair(pair, parts, scene)
    force.setStiffness(stiffness)
    force.setDissipation(dissipation_of(pair, law, parts, scene) or critical)
    force.setStaticFriction(law.friction)
    force.setDynamicFriction(law.friction)
    force.setViscousFriction(0.0)
    model.addForce(force)
    return force


def of_pair(pair: tuple[int, int], parts: Sequence[TouchingBody], scene: AnyScene) -> tuple[float, float]:
    """Return OpenSim's stiffness (Pa) of a pair of bodies, and the dissipation (s/m) that is critical at rest."""
    touching = [parts[index] for index in pair if index != WORLD]
    gravity = scene.gravity or STANDARD_GRAVITY
    mass = 1 / sum(1 / part.body.mass for part in touching)
    bearing = BEARING if any(isinstance(part.shape, Brick) for part in touching) else 1
    radius = 1 / sum(1 / spheres(part)[0][1] for part in touching)
    depth = SINKING * min(least_half_length(part) for part in touching)
    return hardness(mass * gravity / bearing, gravity, depth, radius)


def least_half_length(part: TouchingBody) -> float:
    """Return the radius of a sphere, or the least half-length of a brick (m)."""
    return min(part.shape.semi_axes) if isinstance(part.shape, Brick) else spheres(part)[0][1]


def dissipation_of(pair: tuple[int, int], law: Law, parts: Sequence[TouchingBody], scene: AnyScene) -> float | None:
    """Return OpenSim's dissipation (s/m) of a pair with a coefficient of restitution; None without an impact or coefficient."""
    speed = impact_speed(*pair, parts, scene) if law.restitution else 0.0
    # OpenSim's force is f (1 + 1.5 D v).
    return dissipation(law.restitution, speed) / 1.5 if speed else None


def add_push(model: Any, body: Any, number: int, push: Push, method: Method) -> None:
    """Add a push to a model."""
    force = opensim.PrescribedForce(f"push_{number}", body)
    force.setForceIsInGlobalFrame(True)
    force.setPointIsInGlobalFrame(False)
    start, end = (edge(instant, method) for instant in (push.start, push.end))
    force.setForceFunctions(*(during(start, end, part) for part in push.force))
    force.setPointFunctions(*(opensim.Constant(part) for part in push.point))
    model.addForce(force)


def edge(instant: float, method: Method) -> float:
    """Return the time (s) at which a push begins or ends.

    With fixed steps it is the start of the step that is nearest to the instant, and earlier by so much as rounding could make
    that step begin before it.
    """
    if method.accuracy is not None or not math.isfinite(instant):
        return instant
    return (float(np.rint(instant / method.timestep)) - ROUNDING) * method.timestep


def during(start: float, end: float, value: float) -> Any:
    """Return OpenSim's function of the time that has a value from a start to an end (s), and is otherwise zero."""
    function = opensim.PiecewiseConstantFunction()
    for time, part in ((start - 1.0, 0.0), (start, value), (end, 0.0)):
        if math.isfinite(time):
            function.addPoint(time, part)
    return function


def contact_terms(scene: AnyScene, method: Method) -> str:
    """Return what OpenSim is given in the place of a scene's friction and restitution, as `ContactTerms` does."""
    if not touches(scene):
        return ""
    parts, (usual, *others) = touching_bodies(scene), laws(scene)
    phrases = []
    if any(law.friction for law in (usual, *others)):
        phrases.append(f"friction that grows with the slip up to {TRANSITION_SPEED:g} m/s")
    stated = {law.bodies: law for law in others}
    falls = {(WORLD, index): usual for index in range(len(parts))} if scene.plane is not None else {}
    for pair, law in (falls | stated).items():
        given = dissipation_of(pair, law, parts, scene)
        if given is not None:
            at = f"the restitution {law.restitution:g} at {impact_speed(*pair, parts, scene):.3g} m/s"
            names = ["the plane" if index == WORLD else parts[index].name for index in pair]
            between = f" between {names[1]} and {names[0]}" if len(parts) > 1 else ""
            phrases.append(f"dissipation {given:.3g} s/m of Hunt and Crossley for {at}{between}")
    for part in parts:
        if isinstance(part.shape, Brick):
            _, radius = spheres(part)[0]
            phrases.append(f"spheres of {radius:.3g} m in the corners of {part.name}")
    return "; ".join(phrases)
