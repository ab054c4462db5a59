"""Build the mechanism of a case from the tables of its file, and check its initial state.

The checks concern the mass matrix, the loops, and numbers that would overflow.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from bodycheck.casefile.grammar import InitialTable
from bodycheck.casefile.mechanisms import control_grammar, grammar
from bodycheck.casefile.scenes import MAX_SIZE, Inconsistent, attitude_of, inertia_of, rotation_of, solid_shape
from bodycheck.casefile.surroundings import attitude_on, build_contacts, build_plane, build_push, position_on
from bodycheck.casefile.toml_positions import Path
from bodycheck.reference.exact.numbers import Wide
from bodycheck.reference.mechanisms import mimicry, start
from bodycheck.reference.mechanisms.control import Controller, Samples, Signal, Sine, Stops
from bodycheck.reference.mechanisms.joint_types import JOINT_TYPES, JointType
from bodycheck.reference.mechanisms.mechanism import WORLD, BodyStart, Joint, JointedBody, Loop, Mechanism, Mimic
from bodycheck.reference.scene import Plane, Shape, Solid, Vector

#: Smallest pivot of the mass matrix relative to its diagonal element; a smaller pivot is rounding of the file's numbers.
MIN_PIVOT = 1e-15

#: Largest ratio of the total mass times the square of the largest distance to the inertia about a joint: sums of both are
#: computed with a hundred digits.
MAX_RATIO = 1e60

#: The largest distance of the two points of a loop relative to the lengths of the mechanism, and the largest relative speed of
#: the points relative to its speeds: the rounding of decimals in a file stays below it.
LOOP_TOLERANCE = 1e-12


def check_start(mechanism: Mechanism, duration: float) -> None:
    """Raise `Inconsistent` if the motion of a mechanism is not determined or too large. duration: of the run (s).

    The causes are a mass matrix in joint coordinates that is not positive definite at the start, loops that do not close or do
    not stay closed, inertias that are too small compared with the others, and quantities above `MAX_SIZE`.
    """
    frames, coordinates = start.frames(mechanism), start.coordinates(mechanism)
    faults = [*_undetermined(mechanism, coordinates), *_open_loops(mechanism, frames)]
    if not faults:
        faults += _out_of_scale(mechanism, frames, coordinates)
        faults += _too_large(mechanism, frames, coordinates, duration)
    if faults:
        raise Inconsistent(*faults)


def _undetermined(mechanism: Mechanism, coordinates: tuple[start.Coordinate, ...]) -> Iterator[tuple[Path, str]]:
    """Yield a fault for each joint or free body that has a coordinate without inertia."""
    reported: set[int] = set()
    for coordinate in coordinates:
        if coordinate.loose > MIN_PIVOT * coordinate.locked or coordinate.body in reported:
            continue
        reported.add(coordinate.body)
        name = mechanism.bodies[coordinate.body].name
        if coordinate.joint is None:
            yield (
                ("bodies", coordinate.body),
                f"{name} is free and has no moment of inertia about some axis; its turning is not determined",
            )
        else:
            yield (
                ("joints", coordinate.joint),
                "what it moves has no inertia against it while the joints behind it are loose: the mass matrix is not positive "
                "definite at the start; give moments of inertia, or an armature",
            )


def _open_loops(mechanism: Mechanism, frames: Mapping[int, start.Frame]) -> Iterator[tuple[Path, str]]:
    reach = max(np.abs(frame.origin).max() for frame in frames.values())
    fastest = max(np.abs(frame.velocity).max() for frame in frames.values())
    turning = max(np.abs(frame.spin).max() for frame in frames.values())
    for index, loop in enumerate(mechanism.loops):
        ends = [frames[body] for body in loop.bodies]
        points = [np.array(point, dtype=Wide) for point in loop.points]
        size = max(reach, *(np.abs(point).max() for point in points))
        here, there = (end.point(point) for end, point in zip(ends, points, strict=True))
        if (gap := _length(here - there)) > LOOP_TOLERANCE * size:
            yield (
                ("loops", index),
                f"does not close at the start: its points are {gap:.6g} m apart, at {_told(here)} and {_told(there)} in the "
                "world",
            )
            continue
        one, other = (end.speed(point) for end, point in zip(ends, points, strict=True))
        if (speed := _length(one - other)) > LOOP_TOLERANCE * (fastest + turning * size):
            yield (
                ("loops", index),
                f"does not stay closed: its points part with {speed:.6g} m/s at the start; the initial velocities must fit",
            )


def _out_of_scale(
    mechanism: Mechanism, frames: Mapping[int, start.Frame], coordinates: tuple[start.Coordinate, ...]
) -> Iterator[tuple[Path, str]]:
    """Yield a fault for each joint whose inertia is so small that sums with the inertia of the whole mechanism lose it."""
    mass = sum(start.mass(body) for body in mechanism.bodies)
    reach = max(max(_length(frames[index].origin), _length(start.centre(body))) for index, body in enumerate(mechanism.bodies))
    reported: set[int] = set()
    for coordinate in coordinates:
        joint = coordinate.joint
        if joint is None or joint in reported or mechanism.joints[joint].form.slides:
            continue
        if mass * reach**2 > MAX_RATIO * coordinate.locked:
            reported.add(joint)
            yield (
                ("joints", joint),
                f"the inertia about it is {coordinate.locked:.3g} kg m^2, and all masses times the square of the largest "
                f"distance are {mass * reach**2:.3g} kg m^2; their ratio may be at most {MAX_RATIO:g}",
            )


def _too_large(
    mechanism: Mechanism, frames: Mapping[int, start.Frame], coordinates: tuple[start.Coordinate, ...], duration: float
) -> Iterator[tuple[Path, str]]:
    """Yield a fault for each quantity that becomes so large within a duration (s) that products could overflow."""
    time, gravity, energy, mass, speed, way = (Wide(duration), Wide(mechanism.gravity), *[Wide(0)] * 4)
    for index, body in enumerate(mechanism.bodies):
        frame, centre, mass_of_body = frames[index], start.centre(body), start.mass(body)
        velocity, spin = frame.speed(centre), frame.turn.T @ frame.spin
        energy += Wide(mass_of_body * velocity @ velocity + spin @ start.tensor(body) @ spin) / 2
        mass, speed = mass + mass_of_body, max(speed, _length(velocity))
        way = max(way, _length(frame.point(centre)))
    push = gravity
    for coordinate in coordinates:
        if coordinate.joint is not None and len(mechanism.joints[coordinate.joint].start) == 1:
            joint = mechanism.joints[coordinate.joint]
            force = abs(Wide(joint.effort)) + Wide(joint.stiffness) * (abs(Wide(joint.start[0])) + abs(Wide(joint.rest)))
            push = max(push, force / coordinate.loose)
    way += (speed + push * time) * time
    inertia = [coordinate.locked for coordinate in coordinates]
    sizes: dict[Path, dict[str, tuple[Wide, str]]] = {
        ("bodies",): {
            "kinetic energy at the start": (energy, "J"),
            "largest inertia of a coordinate": (max(inertia, default=Wide(1)), "kg m^2 or kg"),
            "smallest inertia of a coordinate, inverted,": (
                1 / min((coordinate.loose for coordinate in coordinates), default=Wide(1)),
                "1/(kg m^2) or 1/kg",
            ),
        },
        ("run", "duration"): {
            "distance from the origin at the end": (way, "m"),
            "energy at the end": (mass * ((speed + push * time) ** 2 + push * way), "J"),
        },
    }
    for path, quantities in sizes.items():
        for name, (value, unit) in quantities.items():
            if not value <= MAX_SIZE:
                yield path, f"its {name} is {value:.3g} {unit}; at most {MAX_SIZE:g} is allowed"


def _length(vector: start.WideArray) -> Wide:
    """Return the length of a vector, without overflow or underflow of its square."""
    largest = np.abs(vector).max()
    return Wide(largest * np.sqrt(np.square(vector / largest).sum())) if largest else Wide(0)


def _told(point: start.WideArray) -> str:
    return f"[{', '.join(f'{float(part):.6g}' for part in point)}]"


#: The keys of a joint's axis and of the forces along it.
FORCES = ("axis", "armature", "damping", "stiffness", "rest", "friction", "effort")

#: The default centre of mass of a body.
ORIGIN: Vector = (0.0, 0.0, 0.0)


def build_mechanism(table: grammar.MechanismTable) -> Mechanism:
    """Return the mechanism of a case.

    Raises `Inconsistent` for faults of the initial state; see `check_start`.
    """
    places = {grammar.WORLD: WORLD} | {body.name: index for index, body in enumerate(table.bodies)}
    children = {joint.child for joint in table.joints}
    plane = build_plane(table.scene.plane)
    mechanism = Mechanism(
        tuple(_body(body, plane, free=body.name not in children) for body in table.bodies),
        _joints(table.joints, places),
        tuple(Loop((places[loop.bodies[0]], places[loop.bodies[1]]), loop.points) for loop in table.loops),
        table.scene.gravity,
        plane,
        build_contacts(table.scene.contacts, [body.name for body in table.bodies], plane),
        tuple(build_push(push, places[push.body] if push.body is not None else 0) for push in table.scene.push),
        _controllers(table),
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
    position = table.position or position_on(plane, shape, attitude)
    return BodyStart(position, attitude, table.velocity, rotation_of(table))


def _joints(tables: Sequence[grammar.JointTable], places: dict[str, int]) -> tuple[Joint, ...]:
    """Return the joints of tables; those that follow others begin where their rules say."""
    order = {table.name: index for index, table in enumerate(tables)}
    joints = [_joint(table, places, order) for table in tables]
    starts = {index: mimicry.start(joints, index) for index, joint in enumerate(joints) if joint.mimic is not None}
    for index, (position, velocity) in starts.items():
        joints[index] = replace(joints[index], start=(float(position),), start_velocity=(float(velocity),))
    return tuple(joints)


def _joint(table: grammar.JointTable, places: dict[str, int], order: Mapping[str, int]) -> Joint:
    name: JointType = getattr(table, "type")  # noqa: B009  (a key of the tables, which are generated from the types)
    forces = {key: getattr(table, key) for key in FORCES if key in type(table).model_fields}
    keys = JOINT_TYPES[name].start
    start, velocity = (_numbers(table, keys.position), _numbers(table, keys.velocity)) if keys is not None else ((), ())
    parent, child = places[table.parent], places[table.child]
    rule = table.mimic if isinstance(table, grammar.AxisTable) else None
    mimic = None if rule is None else Mimic(order[rule.joint], rule.multiplier, rule.offset)
    stops = _stops(table.limits) if isinstance(table, grammar.AxisTable) else None
    return Joint(
        *(table.name, name, parent, child, table.position, attitude_of(table)),
        **forces,
        start=start,
        start_velocity=velocity,
        mimic=mimic,
        stops=stops,
    )


def _stops(table: control_grammar.StopsTable | None) -> Stops | None:
    if table is None:
        return None
    if table.stiffness is None:
        return Stops(table.lower, table.upper, table.restitution or 0.0)
    return Stops(table.lower, table.upper, None, table.stiffness, table.damping or 0.0)


def _controllers(table: grammar.MechanismTable) -> tuple[Controller, ...]:
    order = {joint.name: index for index, joint in enumerate(table.joints)}
    return tuple(_controller(each, order[each.joint]) for each in table.controllers)


def _controller(table: control_grammar.ControllerTable, joint: int) -> Controller:
    return Controller(
        joint,
        table.law,
        table.kp,
        table.kd,
        table.ki,
        target=_signal(table.target),
        target_velocity=_signal(table.target_velocity),
        effort=_signal(table.effort),
        rate=table.rate,
        delay=table.delay,
        effort_limit=table.effort_limit,
        no_load_speed=table.no_load_speed,
    )


def _signal(table: control_grammar.AnySignal) -> Signal:
    match table:
        case control_grammar.SineTable():
            return Sine(table.amplitude, table.angular_frequency, table.phase, table.offset)
        case control_grammar.SamplesTable():
            return Samples(table.times, table.values, table.between)
        case control_grammar.FileSignalTable():
            raise TypeError("a file where its values are meant")  # `signal_files` puts the values in its place
        case _:
            return table


def _numbers(table: grammar.JointTable, names: tuple[str, ...]) -> tuple[float, ...]:
    """Return the numbers of some keys of the table `initial` of a joint, concatenated."""
    values = [getattr(getattr(table, "initial"), name) for name in names]  # noqa: B009
    return tuple(number for value in values for number in (value if isinstance(value, tuple) else (value,)))
