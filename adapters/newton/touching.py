"""Step free bodies that touch a plane and each other, by the contacts of Newton's solvers MuJoCo and XPBD.

The plane is Newton's infinite plane, and a body has one shape. Newton's own coefficients of torsional and rolling friction,
which XPBD uses for every contact, are those of the scene, which are lengths as Newton's are. The stiffness and the damping of
contacts are Newton's own, which the solver MuJoCo converts to MuJoCo's own time constant and damping ratio.

The solver MuJoCo uses the larger coefficient of friction of two shapes, and finds contacts by MuJoCo Warp. All shapes have the
friction of the plane, and other pairs are MuJoCo's pairs (`add_contact_pair`). XPBD uses the mean of the coefficients of two
shapes. It has restitution if it is asked for (`enable_restitution`), but none for impacts below 2 g h, the speed that gravity
gives in two steps. Restitution is an impulse after the positions are corrected, to which no friction belongs.

A push is a force of Newton's (`State.body_f`), which is computed at the start of each step.
"""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import newton
import numpy as np
import warp as wp
from newton.solvers import mujoco

from bodycheck.adapters.contract import Method, SensingSimulation
from bodycheck.adapters.links import link_of, tensor
from bodycheck.adapters.mujoco import touching as of_mujoco
from bodycheck.adapters.mujoco.contact import MUJOCO_MIN_FRICTION
from bodycheck.adapters.mujoco_warp import graphs
from bodycheck.adapters.newton.mechanisms import by_mujoco, twist
from bodycheck.adapters.newton.sensing import Instruments, add_sites, transform
from bodycheck.adapters.newton.solvers import SOLVERS
from bodycheck.adapters.pair_coefficients import COMBINED, coefficients, differences, differing, shared
from bodycheck.adapters.stepping import Loop, Normalised
from bodycheck.adapters.touching import Law, Pushed, TouchingBody, laws, laws_of_pairs, plane_of, switches, touching_bodies
from bodycheck.reference.kinematics import conjugate, normalise, rotate
from bodycheck.reference.mechanisms.exact import nearest_inertia
from bodycheck.reference.mechanisms.mechanism import WORLD, AnyScene, Mechanism
from bodycheck.reference.requirements import touches
from bodycheck.reference.scene import Brick, Cylinder, Ellipsoid, Push, Sphere
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.trajectory import Array

#: The requirements of touching bodies that Newton models.
MODELS = frozenset({"incline", "restitution", "rolling", "pushes", "contacts", "rolling friction", "torsional friction"})

#: The largest coefficient below zero that is a rounding error of zero.
ROUNDING = 1e-9

#: The least number of single precision that is not below MuJoCo's least coefficient of torsional friction (m).
LEAST_IN_SINGLE_PRECISION = float(np.nextafter(np.float32(MUJOCO_MIN_FRICTION), np.float32(1.0)))

#: The dimensions of a contact with friction alone.
USUAL_DIMENSIONS = 3

#: The number of contacts of each body for which MuJoCo Warp reserves memory, and the most rows of constraints of a contact,
#: without and with rolling or torsional friction.
CONTACTS_OF_A_BODY, ROWS_OF_A_CONTACT, ROWS_WITH_MOMENTS = 16, 4, 10


def add_pushes(
    bodies: wp.array[int],
    acting: wp.array[wp.vec3],
    points: wp.array[wp.vec3],
    poses: wp.array[wp.transform],
    forces: wp.array[wp.spatial_vector],
) -> None:
    """Add the forces of pushes (world) at points in the frames of bodies. Warp compiles this function as a kernel."""
    push = wp.tid()
    body, force = bodies[push], acting[push]
    arm = wp.quat_rotate(wp.transform_get_rotation(poses[body]), points[push])
    wp.atomic_add(forces, body, wp.spatial_vector(force, wp.cross(arm, force)))


pushes_kernel = wp.kernel(add_pushes)


def prepare(scene: AnyScene, method: Method) -> Normalised:
    """Return the simulation of bodies that touch, as `Adapter.prepare` does. Raises `SceneUnsupported`."""
    bodies = touching_bodies(scene)
    model = built(scene, bodies, method)
    return Normalised(stepped(scene, bodies, method, model, model.state()))


def prepare_sensing(scene: AnyScene, sensors: Sequence[Sensor], method: Method) -> SensingSimulation:
    """Return the simulation of bodies that touch, with sensors. Raises `SceneUnsupported`."""
    bodies = touching_bodies(scene)
    placed = [at_centre(scene, sensor) for sensor in sensors]
    model = built(scene, bodies, method, placed)
    state, instruments = model.state(), Instruments(model, placed, [sensor.body for sensor in placed])
    simulation = stepped(scene, bodies, method, model, state, instruments)
    return SensingSimulation(Normalised(simulation), lambda: instruments.read(state))


def at_centre(scene: AnyScene, sensor: Sensor) -> Sensor:
    """Return a sensor with its place relative to the body's centre of mass."""
    if not isinstance(scene, Mechanism):
        return sensor
    x, y, z = np.subtract(sensor.position, nearest_inertia(scene.bodies[sensor.body]).centre).tolist()
    return replace(sensor, position=(x, y, z))


def stepped(
    scene: AnyScene,
    bodies: Sequence[TouchingBody],
    method: Method,
    model: Any,
    state: Any,
    instruments: Instruments | None = None,
) -> Pushed[Loop[Any]]:
    """Return the simulation of a model by steps of a state, with the observables that sensors need if there are any."""
    solver, control, following = solver_of(scene, model, method), model.control(), model.state()
    pipeline = newton.CollisionPipeline(model) if SOLVERS[method.integrator].collides else None
    contacts = pipeline.contacts() if pipeline is not None else None
    if instruments is not None:
        contacts = instruments.attach(solver, contacts)
    observed = {} if instruments is None else instruments.observed
    acting = wp.zeros(len(scene.pushes), dtype=wp.vec3)
    forces = acting.numpy()  # a view of the array that the kernel reads
    pushed = [push.body for push in scene.pushes], [push.point for push in scene.pushes]
    inputs = [wp.array(pushed[0], dtype=int), acting, wp.array(pushed[1], dtype=wp.vec3), state.body_q]

    def step() -> None:
        state.clear_forces()
        if scene.pushes:
            wp.launch(pushes_kernel, dim=len(scene.pushes), inputs=inputs, outputs=[state.body_f])
        if pipeline is not None:
            pipeline.collide(state, contacts)
        solver.step(state, following, control, contacts, method.timestep, **observed)
        state.assign(following)

    def exert(pushes: Sequence[Push]) -> None:
        if scene.pushes:
            forces[:] = [push.force if push in pushes else (0.0, 0.0, 0.0) for push in scene.pushes]

    poses, twists = state.body_q.numpy(), state.body_qd.numpy()  # views of the arrays that are stepped
    loop = Loop(graphs.record(step), graphs.replay, lambda _: np.concatenate([poses, twists], axis=None), rows)
    return Pushed(loop, switches(scene.pushes, method.timestep), exert)


def solver_of(scene: AnyScene, model: Any, method: Method) -> Any:
    """Return the solver of a model of bodies that touch."""
    if by_mujoco(method):
        count = CONTACTS_OF_A_BODY * model.body_count
        rows = ROWS_WITH_MOMENTS if any(law.resists for law in laws(scene)) else ROWS_OF_A_CONTACT
        chosen: dict[str, Any] = {"nconmax": count, "njmax": rows * count}
    else:
        chosen = {"enable_restitution": any(law.restitution for law in laws(scene))}
    return SOLVERS[method.integrator].make(model, method, **chosen)


def built(scene: AnyScene, bodies: Sequence[TouchingBody], method: Method, sensors: Sequence[Sensor] = ()) -> Any:
    """Return Newton's model of bodies that touch, with sensors, whose default state is the initial state.

    Raises `SceneUnsupported`.
    """
    builder = newton.ModelBuilder(gravity=(0.0, 0.0, -scene.gravity))
    if by_mujoco(method):
        newton.solvers.SolverMuJoCo.register_custom_attributes(builder)
    materials = materials_of(scene, len(bodies), method)
    builder.add_shape_plane(
        plane=(*plane_of(scene).normal, 0.0), width=0.0, length=0.0, **shape_of_material(materials[0], method)
    )
    for body, material in zip(bodies, materials[1:], strict=True):
        add_body(builder, body, shape_of_material(material, method))
    if by_mujoco(method):
        for law in laws(scene)[1:]:
            add_pair(builder, law)
    add_sites(builder, sensors, [sensor.body for sensor in sensors])
    builder.color()
    # The check of inertia would replace moments of which one is nearly the sum of the others.
    return builder.finalize(skip_validation_inertia=True)


def materials_of(scene: AnyScene, bodies: int, method: Method) -> list[Law]:
    """Return the coefficients of the plane and of each body, of which Newton makes those of pairs, as laws."""
    usual, *_ = laws(scene)
    if by_mujoco(method):
        return [usual] * (bodies + 1)
    given, resisting = coefficients(scene, bodies, "mean"), moments_of(scene, bodies)
    return [
        replace(
            usual,
            friction=given[index].friction,
            restitution=given[index].restitution,
            rolling_friction=resisting["rolling friction"][index],
            torsional_friction=resisting["torsional friction"][index],
        )
        for index in (WORLD, *range(bodies))
    ]


def moments_of(scene: AnyScene, bodies: int) -> dict[str, dict[int, float]]:
    """Return the rolling and the torsional friction (m), by their names, of the plane and of each body, for XPBD."""
    return {what: shared(pairs, "mean") for what, pairs in moments_wanted(scene, bodies).items()}


def moments_wanted(scene: AnyScene, bodies: int) -> dict[str, dict[tuple[int, int], float]]:
    """Return the rolling and the torsional friction (m), by their names, of each pair of a scene."""
    between = laws_of_pairs(scene, bodies)
    return {
        "rolling friction": {pair: law.rolling_friction for pair, law in between.items()},
        "torsional friction": {pair: law.torsional_friction for pair, law in between.items()},
    }


def shape_of_material(law: Law, method: Method) -> dict[str, Any]:
    """Return the arguments of a shape with the coefficients of a law."""
    torsional, rolling = law.torsional_friction, law.rolling_friction
    attributes: dict[str, Any] = {}
    if by_mujoco(method):
        torsional, rolling = moments_of_mujoco(law)
        if (dimensions := dimensions_of(law)) != USUAL_DIMENSIONS:
            attributes["mujoco:condim"] = dimensions
    config = newton.ModelBuilder.ShapeConfig(
        mu=law.friction, mu_torsional=torsional, mu_rolling=rolling, restitution=law.restitution
    )
    return {"cfg": config, "custom_attributes": attributes}


def moments_of_mujoco(law: Law) -> tuple[float, float]:
    """Return the torsional and the rolling friction (m) of MuJoCo's contacts of a pair with a law.

    In the single precision of Newton's model, MuJoCo's least coefficient would be less than itself.
    """
    if not law.resists:
        return 0.0, 0.0
    torsional, rolling = of_mujoco.moments(law)
    return max(torsional, LEAST_IN_SINGLE_PRECISION) if law.rolling_friction else torsional, rolling


def dimensions_of(law: Law) -> int:
    """Return the dimensions of MuJoCo's contacts of a pair with a law."""
    return int(of_mujoco.dimensions(law) or (USUAL_DIMENSIONS if law.friction else 1))


def add_body(builder: Any, body: TouchingBody, shape: Mapping[str, Any]) -> None:
    """Add a free body with its shape to a builder."""
    link = link_of(body.body)
    number = builder.add_link(
        xform=transform(body.start.position, body.start.quaternion),
        mass=link.mass,
        inertia=wp.mat33(*tensor(link).ravel().tolist()),
        lock_inertia=True,
    )
    builder.body_qd[number] = twist(link, body.start)
    joint = builder.add_joint_free(number)
    builder.add_articulation([joint])
    first = builder.joint_qd_start[joint]
    builder.joint_qd[first : first + 6] = builder.body_qd[number]
    match body.shape:
        case Brick((a, b, c)):
            builder.add_shape_box(number, hx=a, hy=b, hz=c, **shape)
        case Cylinder(radius, half_length):
            builder.add_shape_cylinder(number, radius=radius, half_height=half_length, **shape)
        case Ellipsoid((a, b, c)):
            builder.add_shape_ellipsoid(number, rx=a, ry=b, rz=c, **shape)
        case Sphere(radius):
            builder.add_shape_sphere(number, radius=radius, **shape)


def add_pair(builder: Any, law: Law) -> None:
    """Add a pair with its own friction to a builder of a model for MuJoCo. The shapes follow the plane in their order."""
    first, second = (body - WORLD for body in law.bodies)
    torsional, rolling = moments_of_mujoco(law)
    friction = (law.friction, law.friction, torsional, rolling, rolling)
    mujoco.add_contact_pair(builder, first, second, condim=dimensions_of(law), friction=friction)


def rows(seen: Array) -> Array:
    """Return the states (n, bodies, 13) of the contract from the poses of n states, and then the twists, of all bodies."""
    bodies = seen.shape[1] // 13
    poses, twists = (part.reshape(len(seen), bodies, -1) for part in np.split(seen, [7 * bodies], axis=1))
    quaternions = poses[..., [6, 3, 4, 5]]
    spins = rotate(conjugate(normalise(quaternions)), twists[..., 3:])
    return np.concatenate([poses[..., :3], quaternions, twists[..., :3], spins], axis=2)


def contact_terms(scene: AnyScene, method: Method) -> str:
    """Return what Newton is handed in the place of a scene's friction and restitution, as `ContactTerms` does."""
    if by_mujoco(method):
        return of_mujoco.contact_terms(scene, method)
    if not touches(scene):
        return ""
    bodies, mean = touching_bodies(scene), COMBINED["mean"]
    phrases = differences(scene, bodies, "mean")
    for what, pairs in moments_wanted(scene, len(bodies)).items():
        given = moments_of(scene, len(bodies))[what]

        def arrived(one: int, other: int, given: Mapping[int, float] = given) -> float:
            return mean(given[one], given[other])

        phrases += differing(what, pairs, arrived, bodies)
    if any(law.resists and law.cone == "one" for law in laws(scene)):
        phrases.append("a bound of its own for friction, torsional friction and rolling friction")
    if any(law.restitution for law in laws(scene)):
        phrases.append(f"restitution above {2 * scene.gravity * method.timestep:.3g} m/s, without friction of its impulse")
    return "; ".join(phrases)


def interface_loads(scene: AnyScene, method: Method, steps: int) -> dict[tuple[int, int], Array]:
    """Return the normal forces between pairs that touch in each of n steps, as `InterfaceLoads.interface_loads` does.

    They are Newton's observable of contacts. Those of XPBD are approximate, as its documentation says.
    """
    bodies = touching_bodies(scene)
    model = built(scene, bodies, method)
    instruments = Instruments(model, [Sensor("load", "contact_force")], [0])
    simulation = stepped(scene, bodies, method, model, model.state(), instruments)
    contacts, forces = instruments.contacts, instruments.observed["observables"].contact_f.numpy()
    count, normals = contacts.rigid_contact_count.numpy(), contacts.rigid_contact_normal.numpy()
    shapes = contacts.rigid_contact_shape0.numpy(), contacts.rigid_contact_shape1.numpy()
    body_of = model.shape_body.numpy()  # the number of a body is its index, and that of the plane is `WORLD`

    def step() -> Mapping[tuple[int, int], float]:
        graphs.replay(simulation.simulation.state)
        by_pair = defaultdict[tuple[int, int], float](float)
        for number in range(int(count[0])):
            first, second = sorted(body_of[[shape[number] for shape in shapes]].tolist())
            by_pair[first, second] += abs(float(normals[number] @ forces[number, :3]))
        return by_pair

    return simulation.loads(steps, step)
