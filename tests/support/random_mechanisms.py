"""Mechanisms drawn by hypothesis, and the documents of case files that say the same."""

import math
from typing import Any

from hypothesis import strategies as st

from bodycheck.reference.mechanisms.coordinates import COORDINATES, VELOCITIES
from bodycheck.reference.mechanisms.joint_types import JOINT_TYPES, JointType
from bodycheck.reference.mechanisms.mechanism import WORLD, BodyStart, Joint, JointedBody, Mechanism
from bodycheck.reference.scene import (
    Attitude,
    Brick,
    Cylinder,
    Ellipsoid,
    EulerAngles,
    EulerRates,
    Given,
    Particle,
    Quaternion,
    Shape,
    Solid,
    Sphere,
    Tensor,
)

Table = dict[str, Any]

number = st.floats(-1e3, 1e3).map(lambda value: value if abs(value) > 1e-6 else 0.0)
size = st.floats(1e-2, 1e2)
vectors = st.tuples(number, number, number)
sizes = st.tuples(size, size, size)


@st.composite
def quaternions(draw: st.DrawFn) -> Quaternion:
    """Unit quaternions, as far as doubles go."""
    w, x, y, z = draw(st.tuples(number, number, number, number).filter(any))
    length = math.hypot(w, x, y, z)
    made = (part / length for part in (w, x, y, z))
    w, x, y, z = (part if abs(part) > 1e-90 else 0.0 for part in made)
    return w, x, y, z


attitudes = st.one_of(st.just((1.0, 0.0, 0.0, 0.0)), quaternions(), vectors.filter(any).map(lambda v: EulerAngles(*v)))
shapes = st.one_of(sizes.map(Brick), sizes.map(Ellipsoid), st.builds(Cylinder, size, size), size.map(Sphere))
solids = st.builds(Solid, shapes, size, vectors, attitudes)


@st.composite
def tensors(draw: st.DrawFn) -> Tensor:
    """Tensors of bodies, whose moments are sums of two positive numbers each."""
    a, b, c = draw(sizes)
    return Tensor(draw(size), ((b + c, 0.0, 0.0), (0.0, a + c, 0.0), (0.0, 0.0, a + b)))


#: What bodies are made of, and where the centre of mass of a tensor is. Particles that are not in a plane have an extent.
CORNERS = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (0.0, 0.0, 0.0))
particles = st.tuples(size, size, size, size).map(
    lambda masses: tuple(Particle(mass, place) for mass, place in zip(masses, CORNERS, strict=True))
)
parts = st.lists(solids, min_size=1, max_size=3).map(tuple)
TYPES: tuple[JointType, ...] = tuple(JOINT_TYPES)


@st.composite
def bodies(draw: st.DrawFn, name: str, free: bool) -> JointedBody:
    """A body of a name."""
    start = None
    if free:
        rotation = draw(st.one_of(vectors, vectors.filter(any).map(lambda rates: EulerRates(*rates))))
        start = BodyStart(draw(vectors), draw(attitudes), draw(vectors), rotation)
    inertia: Given = draw(st.one_of(tensors(), st.builds(Solid, shapes, size, vectors), particles, parts))
    centre = (0.0, 0.0, 0.0)
    if isinstance(inertia, Tensor):
        centre = draw(vectors)
    elif isinstance(inertia, Solid):
        centre = inertia.position
    return JointedBody(name, inertia, centre, start)


@st.composite
def joints(draw: st.DrawFn, place: int) -> Joint:
    """A joint whose child is the body of a place, and whose parent is one before it or the world."""
    kind = draw(st.sampled_from(TYPES))
    start = list(draw(st.lists(number, min_size=COORDINATES[kind], max_size=COORDINATES[kind])))
    if kind in ("spherical", "free"):
        start[-4:] = draw(quaternions())
    velocity = draw(st.lists(number, min_size=VELOCITIES[kind], max_size=VELOCITIES[kind]))
    own: dict[str, Any] = {}
    if kind in ("revolute", "prismatic"):
        own = {name: draw(size) for name in ("armature", "damping", "stiffness", "friction")}
        own |= {"rest": draw(number), "effort": draw(number), "axis": draw(vectors.filter(any))}
    if kind == "spherical":
        own = {"damping": draw(size)}
    parent = draw(st.integers(WORLD, place - 1))
    return Joint(
        f"joint-{place}",
        kind,
        parent,
        place,
        draw(vectors),
        draw(attitudes),
        **own,
        start=tuple(start),
        start_velocity=tuple(velocity),
    )


@st.composite
def mechanisms(draw: st.DrawFn) -> Mechanism:
    """Trees of at most five bodies, some of which begin at free bodies."""
    held = draw(st.lists(st.booleans(), min_size=1, max_size=5))
    made = tuple(draw(bodies(f"body-{place}", not on)) for place, on in enumerate(held))
    return Mechanism(made, tuple(draw(joints(place)) for place, on in enumerate(held) if on), (), draw(size))


def document(mechanism: Mechanism) -> Table:
    """The document of a case file of a mechanism."""
    return {
        "format": 2,
        "name": "drawn",
        "title": "A mechanism that was drawn",
        "bodies": [_body(body) for body in mechanism.bodies],
        "joints": [_joint(joint, mechanism) for joint in mechanism.joints],
        "scene": {"gravity": mechanism.gravity},
        "run": {"duration": 1.0, "samples": 3},
    }


def _body(body: JointedBody) -> Table:
    table: Table = {"name": body.name}
    match body.inertia:
        case Tensor(mass, rows):
            table |= {"mass": mass, "inertia": [list(row) for row in rows], "center_of_mass": list(body.center_of_mass)}
        case Solid(shape, mass, position):
            table |= {**_shape(shape), "mass": mass, "center_of_mass": list(position)}
        case several:
            name = "parts" if isinstance(several[0], Solid) else "particles"
            table[name] = [_part(part) for part in several]
    if (start := body.start) is not None:
        table["initial"] = {"position": list(start.position), "velocity": list(start.velocity)} | _attitude(start.attitude)
        match start.rotation:
            case EulerRates(dphi, dtheta, dpsi):
                table["initial"]["euler_rates"] = [dphi, dtheta, dpsi]
            case rates:
                table["initial"]["angular_velocity"] = list(rates)
    return table


def _part(part: Solid | Particle) -> Table:
    if isinstance(part, Particle):
        return {"mass": part.mass, "position": list(part.position)}
    return {**_shape(part.shape), "mass": part.mass, "position": list(part.position)} | _attitude(part.attitude)


def _shape(shape: Shape) -> Table:
    return {"shape": type(shape).__name__.lower()} | {
        name: list(value) if isinstance(value, tuple) else value for name, value in vars(shape).items()
    }


def _attitude(attitude: Attitude) -> Table:
    if isinstance(attitude, EulerAngles):
        return {"euler_zxz": [attitude.phi, attitude.theta, attitude.psi]}
    return {"quaternion": list(attitude)}


def _joint(joint: Joint, mechanism: Mechanism) -> Table:
    names = [body.name for body in mechanism.bodies]
    table: Table = {"name": joint.name, "type": joint.type, "child": names[joint.child], "position": list(joint.position)}
    table |= _attitude(joint.attitude)
    if joint.parent != WORLD:
        table["parent"] = names[joint.parent]
    if joint.type in ("revolute", "prismatic"):
        table["axis"] = list(joint.axis)
        table |= {key: getattr(joint, key) for key in ("armature", "damping", "stiffness", "rest", "friction", "effort")}
    start, velocity = list(joint.start), list(joint.start_velocity)
    match joint.type:
        case "revolute" | "prismatic":
            table["initial"] = {"position": start[0], "velocity": velocity[0]}
        case "universal" | "planar":
            table["initial"] = {"position": start, "velocity": velocity}
        case "spherical":
            table |= {"damping": joint.damping, "initial": {"quaternion": start, "velocity": velocity}}
        case "free":
            table["initial"] = {
                "position": start[:3],
                "quaternion": start[3:],
                "linear": velocity[:3],
                "velocity": velocity[3:],
            }
    return table
