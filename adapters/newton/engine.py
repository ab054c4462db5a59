"""The adapter of Newton; the docstring of the package describes the solvers and the settings that are switched off."""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import newton
import numpy as np
import warp as wp

from bodycheck.adapters.contract import KINDS, Engine, Integrator, Method, SensingSimulation, Usage, single_bodies, states
from bodycheck.adapters.links import Link, links_of, state_in, tensor, velocity_to_origin
from bodycheck.adapters.mujoco_warp import graphs
from bodycheck.adapters.mujoco_warp.drag import resist
from bodycheck.adapters.newton import INSTALLATION, mechanisms, touching
from bodycheck.adapters.newton.file_motion import file_facts as file_facts
from bodycheck.adapters.newton.file_motion import run_file as run_file
from bodycheck.adapters.newton.mechanisms import twist
from bodycheck.adapters.newton.robots import read_robot as read_robot
from bodycheck.adapters.newton.robots import step_robot as step_robot
from bodycheck.adapters.newton.sensing import Instruments, add_sites, transform
from bodycheck.adapters.newton.sensing import lacking as lacking
from bodycheck.adapters.newton.solvers import SOLVERS, STEEL_DAMPING, VARIANTS, Solver, keeps_damping
from bodycheck.adapters.stepping import InTurn, Loop, Normalised, Taking
from bodycheck.adapters.touching import corners_of_brick, lying_shape
from bodycheck.reference.kinematics import conjugate, normalise, rotate
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.requirements import touches
from bodycheck.reference.scene import Brick, Plane, Scene, State
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.trajectory import Array

# Newton's kernels can be differentiated, which bodycheck does not need and which doubles the time of compiling them.
wp.config.enable_backward = False

#: The solver of Newton's first tutorial, which takes ten steps in each of 60 frames in a second.
TUTORIAL = Usage("XPBD:iterations=10", 1 / 600, "https://newton-physics.github.io/newton/stable/tutorials/00_introduction.html")

engine = Engine(
    name="newton",
    distribution=INSTALLATION.distribution,
    version=str(newton.__version__),
    integrators=tuple(
        Integrator(name, solver.order, solver.evaluations, solver.kinds, solver.options, refuses=solver.refuses)
        for name, solver in SOLVERS.items()
    ),
    models=frozenset({"gravity", "translation", "rotation", "contact", "friction", "drag"})
    | mechanisms.MODELS
    | touching.MODELS,
    variants=VARIANTS,
    precision="float32",
    device=graphs.DEVICE,
    batch=2,
    roles={"default": dict.fromkeys(sorted(KINDS), TUTORIAL)},
    reads=("step",),
)

#: The friction law of contacts.
contact_law = corners_of_brick

contact_terms, interface_loads = touching.contact_terms, touching.interface_loads

calls = graphs.CALLS

#: Kamino's contact solvers whose motion of a scene changes if other scenes are stepped with it: of five sliding bricks, each in
#: its own world, one is off by 0.07 (m, m/s or rad/s) within 60 steps of 1 ms. These solvers step one scene after another.
NOT_TOGETHER = ("lox",)

#: The number of contacts for which memory is reserved; a body and a plane have at most 8. Kamino computes with matrices of this
#: size in every step, and Newton's own estimate is a thousand.
MOST_CONTACTS = 16


def set_drag(drag: float, velocities: wp.array[wp.spatial_vector], forces: wp.array[wp.spatial_vector]) -> None:
    """Set the force on a body, at its centre of mass, to the drag of its velocity. `drag` is the coefficient (kg/m).

    Warp compiles this function as a kernel.
    """
    body = wp.tid()
    velocity = wp.spatial_top(velocities[body])
    forces[body] = wp.spatial_vector(-drag * wp.length(velocity) * velocity, wp.vec3())


drag_kernel = wp.kernel(set_drag)


def prepare(scenes: Sequence[AnyScene], method: Method) -> Normalised | InTurn | Taking:
    """Return the simulation of one or more scenes, as `Adapter.prepare` does."""
    if touches(scenes[0]):
        return touching.prepare(scenes[0], method)
    if isinstance(scenes[0], Mechanism):
        return mechanisms.prepare(scenes[0], method)
    bodies = single_bodies(scenes)
    links = links_of(bodies[0])
    if len(bodies) > 1 and method.option("dynamics_solver") in NOT_TOGETHER:
        return InTurn([((index,), started(links, [scene], method)) for index, scene in enumerate(bodies)])
    return started(links, bodies, method)


def prepare_links(links: Sequence[Link], scene: Scene, method: Method) -> Normalised:
    """Return the simulation of a free body that is made of links, as `Links.prepare_links` does."""
    return started(links, [scene], method)


def prepare_sensing(scene: AnyScene, sensors: Sequence[Sensor], method: Method) -> SensingSimulation:
    """Return the simulation of a scene with sensors, as `Sensing.prepare_sensing` does."""
    if touches(scene):
        return touching.prepare_sensing(scene, sensors, method)
    if isinstance(scene, Mechanism):
        return mechanisms.prepare_sensing(scene, sensors, method)
    (link,) = links_of(scene)
    model = built([link], scene, method, sensors)
    state, instruments = model.state(), Instruments(model, sensors, [0] * len(sensors))
    step = stepper(scene, method, SOLVERS[method.integrator], model, state, instruments)
    return SensingSimulation(stepped(link, step, state, 1), lambda: instruments.read(state))


def stepped(link: Link, step: Callable[[], None], state: Any, scenes: int) -> Normalised:
    """Return the simulation of a number of scenes by a function that steps a state; the link is the first of each body."""
    graph = graphs.record(step)
    poses, twists = state.body_q.numpy(), state.body_qd.numpy()  # views of the arrays that are stepped

    def seen(graph: Any) -> Array:
        return np.concatenate([poses[0], twists[0]]) if scenes == 1 else np.hstack([poses, twists])

    return Normalised(Loop(graph, graphs.replay, seen, rows=partial(rows, link)))


def started(links: Sequence[Link], scenes: Sequence[Scene], method: Method) -> Normalised:
    """Return the simulation of a body of links, whose first link is in the initial states of one or more scenes.

    If there are several scenes, the body must be a single link.
    """
    model = built(links, scenes[0], method) if len(scenes) == 1 else replicated(links[0], scenes, method)
    state = model.state()
    step = stepper(scenes[0], method, SOLVERS[method.integrator], model, state)
    return stepped(links[0], step, state, len(scenes))


def stepper(
    scene: Scene, method: Method, solver_of_method: Solver, model: Any, state: Any, instruments: Instruments | None = None
) -> Callable[[], None]:
    """Return a function that takes a step of `state` in place, with the observables that sensors need if there are any."""
    solver, control, following = solver_of_method.make(model, method), model.control(), model.state()
    if solver_of_method.own_passive_forces:
        resist(solver.mjw_model, scene.drag)
    pushed = scene.drag and not solver_of_method.own_passive_forces
    pipeline = newton.CollisionPipeline(model) if scene.plane is not None and solver_of_method.collides else None
    contacts = pipeline.contacts() if pipeline is not None else None
    if instruments is not None:
        contacts = instruments.attach(solver, contacts)
    observed = {} if instruments is None else instruments.observed

    def step() -> None:
        state.clear_forces()
        if pushed:
            wp.launch(drag_kernel, dim=model.body_count, inputs=[scene.drag, state.body_qd], outputs=[state.body_f])
        if pipeline is not None:
            pipeline.collide(state, contacts)
        solver.step(state, following, control, contacts, method.timestep, **observed)
        state.assign(following)

    return step


def built(links: Sequence[Link], scene: Scene, method: Method, sensors: Sequence[Sensor] = ()) -> Any:
    """Return Newton's model of a body of links, whose default state is the initial state of a scene.

    The first link has a free joint. A fixed joint, which every solver treats differently, connects it to each of the other
    links. Raises `SceneUnsupported`.
    """
    builder = empty(scene)
    if scene.plane is not None:
        add_plane(builder, scene.plane)
    add_body(builder, links, scene, method)
    add_sites(builder, sensors, [0] * len(sensors))
    return finished(builder, 1)


def replicated(link: Link, scenes: Sequence[Scene], method: Method) -> Any:
    """Return Newton's model of scenes with a body of one link, each in its own world. Raises `SceneUnsupported`."""
    single, builder = empty(scenes[0]), empty(scenes[0])
    add_body(single, [link], scenes[0], method)
    if scenes[0].plane is not None:
        add_plane(builder, scenes[0].plane)
    builder.replicate(single, len(scenes))
    model = finished(builder, len(scenes))
    starts = [scene.initial for scene in scenes]
    poses = np.array([list(transform(state.position, state.quaternion)) for state in starts])
    twists = np.array([twist(link, state) for state in starts])
    for places, values in ((model.body_q, poses), (model.body_qd, twists)):
        places.assign(values.astype(np.float32))
    model.joint_q.assign(poses.astype(np.float32).ravel())
    model.joint_qd.assign(twists.astype(np.float32).ravel())
    return model


def empty(scene: Scene) -> Any:
    """Return a builder of a model with the gravity of a scene."""
    builder = newton.ModelBuilder(gravity=(0.0, 0.0, -scene.gravity))
    newton.solvers.SolverSteel.register_custom_attributes(builder)
    return builder


def finished(builder: Any, worlds: int) -> Any:
    """Return the model of a builder with the given number of worlds."""
    builder.color()
    # The check of inertia would replace moments of which one is nearly the sum of the others.
    model = builder.finalize(skip_validation_inertia=True)
    model.rigid_contact_max = MOST_CONTACTS * worlds
    return model


def add_body(builder: Any, links: Sequence[Link], scene: Scene, method: Method) -> None:
    """Add a body of links in the initial state of a scene, with its shape if there is a plane. Raises `SceneUnsupported`."""
    bodies = [add_link(builder, link, scene.initial, method) for link in links]
    joints = [builder.add_joint_free(bodies[0])]
    for body, link in zip(bodies[1:], links[1:], strict=True):
        joints.append(builder.add_joint_fixed(bodies[0], body, parent_xform=transform(link.position, link.quaternion)))
    builder.add_articulation(joints)
    if scene.plane is not None:
        add_shape(builder, bodies[0], scene, scene.plane)
    builder.joint_qd[:] = builder.body_qd[bodies[0]]


def add_link(builder: Any, link: Link, initial: State, method: Method) -> int:
    """Add a link without a joint, at its place if the first link is in the initial state, and return its number."""
    state = state_in((link.position, link.quaternion), initial)
    body: int = builder.add_link(
        xform=transform(state.position, state.quaternion),
        com=wp.vec3(*link.center_of_mass),
        mass=link.mass,
        inertia=wp.mat33(*tensor(link).ravel().tolist()),
        lock_inertia=True,
        custom_attributes={} if keeps_damping(method) else {STEEL_DAMPING: 0.0},
    )
    builder.body_qd[body] = twist(link, state)
    return body


def add_plane(builder: Any, plane: Plane) -> None:
    """Add the plane z = 0, with Newton's own stiffness."""
    builder.add_ground_plane(cfg=newton.ModelBuilder.ShapeConfig(mu=plane.friction))


def add_shape(builder: Any, body: int, scene: Scene, plane: Plane) -> None:
    """Add the shape of a body that touches a plane, with Newton's own stiffness. Raises `SceneUnsupported`."""
    shape, cfg = lying_shape(scene), newton.ModelBuilder.ShapeConfig(mu=plane.friction)
    if isinstance(shape, Brick):
        a, b, c = shape.semi_axes
        builder.add_shape_box(body, hx=a, hy=b, hz=c, cfg=cfg)
    else:
        builder.add_shape_cylinder(body, radius=shape.radius, half_height=shape.half_length, cfg=cfg)


def rows(link: Link, seen: Array) -> Array:
    """Return rows (n, 13) of states of a link's frame from its poses and twists (n, 13).

    A pose is the position and the quaternion x y z w of the frame. A twist is the velocity of the link's centre of mass and the
    angular velocity, both in the world frame.
    """
    quaternion = seen[:, [6, 3, 4, 5]]
    spin = rotate(conjugate(normalise(quaternion)), seen[:, 10:])
    return velocity_to_origin(states(seen[:, :3], quaternion, seen[:, 7:10], spin), link.center_of_mass)
