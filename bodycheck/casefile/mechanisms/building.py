"""Build the mechanism of a case from the tables of its file."""

from dataclasses import replace

from bodycheck.casefile.grammar import InitialTable
from bodycheck.casefile.mechanisms import grammar
from bodycheck.casefile.mechanisms.start_faults import check_start
from bodycheck.casefile.scenes import attitude_of, inertia_of, rotation_of, solid_shape
from bodycheck.casefile.surroundings import attitude_on, build_contacts, build_plane, build_push, position_on
from bodycheck.reference.mechanisms.exact import nearest_turn
from bodycheck.reference.mechanisms.joint_types import JOINT_TYPES, JointType
from bodycheck.reference.mechanisms.mechanism import WORLD, BodyStart, Joint, JointedBody, Loop, Mechanism
from bodycheck.reference.scene import Plane, Shape, Solid, Vector

#: The keys of a joint's axis and of the forces along it.
FORCES = ("axis", "armature", "damping", "stiffness", "rest", "friction", "effort")

#: The centre of mass of a body whose file does not say it.
ORIGIN: Vector = (0.0, 0.0, 0.0)


def build_mechanism(table: grammar.MechanismTable) -> Mechanism:
    """Return the mechanism of a case.

    Raises `Inconsistent` for what only the start can tell: see `start_faults.check_start`.
    """
    places = {grammar.WORLD: WORLD} | {body.name: place for place, body in enumerate(table.bodies)}
    held = {joint.child for joint in table.joints}
    plane = build_plane(table.scene.plane)
    mechanism = Mechanism(
        tuple(_body(body, plane, free=body.name not in held) for body in table.bodies),
        tuple(_joint(joint, places) for joint in table.joints),
        tuple(Loop((places[loop.bodies[0]], places[loop.bodies[1]]), loop.points) for loop in table.loops),
        table.scene.gravity,
        plane,
        build_contacts(table.scene.contacts, [body.name for body in table.bodies], plane),
        tuple(build_push(push, places[push.body] if push.body is not None else 0) for push in table.scene.push),
    )
    check_start(mechanism, table.run.duration)
    return mechanism


def _body(table: grammar.AnyBody, plane: Plane | None, *, free: bool) -> JointedBody:
    inertia, centre, shape = inertia_of(table), table.center_of_mass or ORIGIN, solid_shape(table)
    start = _start(table.initial or InitialTable(), plane, shape) if free else None
    if isinstance(inertia, Solid):
        return JointedBody(table.name, replace(inertia, position=centre), centre, start)
    return JointedBody(table.name, inertia, centre, start, shape)


def _start(table: InitialTable, plane: Plane | None, shape: Shape | None) -> BodyStart:
    attitude = attitude_of(table, attitude_on(plane))
    position = table.position or position_on(plane, shape, nearest_turn(attitude))
    return BodyStart(position, attitude, table.velocity, rotation_of(table))


def _joint(table: grammar.JointTable, places: dict[str, int]) -> Joint:
    name: JointType = getattr(table, "type")  # noqa: B009  (a key of the tables that are made of the types)
    forces = {key: getattr(table, key) for key in FORCES if key in type(table).model_fields}
    keys = JOINT_TYPES[name].start
    start, velocity = (_numbers(table, keys.position), _numbers(table, keys.velocity)) if keys is not None else ((), ())
    parent, child = places[table.parent], places[table.child]
    return Joint(
        *(table.name, name, parent, child, table.position, attitude_of(table)), **forces, start=start, start_velocity=velocity
    )


def _numbers(table: grammar.JointTable, names: tuple[str, ...]) -> tuple[float, ...]:
    """Return the numbers of some keys of the table `initial` of a joint, one key after another."""
    values = [getattr(getattr(table, "initial"), name) for name in names]  # noqa: B009
    return tuple(number for value in values for number in (value if isinstance(value, tuple) else (value,)))
