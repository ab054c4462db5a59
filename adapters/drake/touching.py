"""Step free bodies that touch a plane and each other in Drake, by Drake's compliant contacts.

The plane is Drake's half space, turned about y. Without an option, bodies with faces (bricks and cylinders) touch by
hydroelastic contact, which Drake's documentation recommends, and round bodies (spheres and ellipsoids) by point contact.
`contact=hydroelastic` gives round bodies hydroelastic contact too, and `settings=engine` is Drake's default for all shapes,
point contact. `contact=points` replaces a single brick by points at its eight corners, and leaves round bodies as they are.

Drake takes the harmonic mean of two coefficients of friction. The coefficients of the bodies are chosen such that every pair
has that of the scene. Friction is regularised: it grows with the slip, most of all up to Drake's stiction tolerance.

Drake has no coefficient of restitution, but a dissipation of Hunt and Crossley, from which a coefficient follows that depends
on the speed of the impact. A pair with a coefficient has the dissipation that returns it after the first fall; see
`bodycheck.adapters.pair_coefficients`. All other pairs have Drake's default, with which no rebound is faster than 2 cm/s. The
approximation `sap` ignores this dissipation and has no restitution.

A push is an external force on the plant, from the step on that is nearest to its instant; with error control steps end at its
instants.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from pydrake.common.eigen_geometry import Quaternion
from pydrake.common.value import Value
from pydrake.geometry import Box, Cylinder, Ellipsoid, HalfSpace, SceneGraphConfig, Sphere
from pydrake.math import RigidTransform
from pydrake.multibody.math import SpatialForce, SpatialVelocity
from pydrake.multibody.plant import AddMultibodyPlant, ExternallyAppliedSpatialForce, MultibodyPlantConfig
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

from bodycheck.adapters.contract import Method, SceneUnsupported, Simulation
from bodycheck.adapters.drake.contact import compliant, contact_of, properties, rigid
from bodycheck.adapters.drake.mechanisms import body_name, seer
from bodycheck.adapters.drake.models import PLANT, Model, add_link, configured, controlled, integrated, stepping_to
from bodycheck.adapters.links import link_of
from bodycheck.adapters.mechanisms import in_body_axes
from bodycheck.adapters.pair_coefficients import COMBINED, differing, dissipation, impact_speed, shared, wanted
from bodycheck.adapters.stepping import Loop
from bodycheck.adapters.touching import TouchingBody, laws, plane_of, switches, touching_bodies
from bodycheck.reference import scene as shapes
from bodycheck.reference.kinematics import rotate
from bodycheck.reference.mechanisms.mechanism import WORLD, AnyScene, Mechanism
from bodycheck.reference.planar import describe_shape
from bodycheck.reference.scene import Push, Shape
from bodycheck.reference.trajectory import Array

#: The requirements of touching bodies that Drake models, of which restitution is an approximation.
MODELS = frozenset({"incline", "restitution", "rolling", "pushes", "contacts"})

#: The approximation that ignores the dissipation of Hunt and Crossley.
WITHOUT_DISSIPATION = "sap"

#: Drake's default dissipation (s/m).
DISSIPATION = SceneGraphConfig().default_proximity_properties.hunt_crossley_dissipation

#: The largest coefficient of friction of a body.
MOST_FRICTION = 1e12


@dataclass(frozen=True, eq=False)
class Touching:
    """Bodies that touch in a model of Drake.

    Parameters
    ----------
    model, bodies
        The model at t = 0, and its bodies in their order.
    seen
        Returns a copy of the present poses and velocities (13 k,) of k bodies.
    step_to
        Steps to a time (s), and switches the pushes on the way; it may raise `EngineDiverged`.
    """

    model: Model
    bodies: Sequence[Any]
    seen: Callable[[], Array]
    step_to: Callable[[float], None]


def prepare(scene: AnyScene, method: Method, approximations: tuple[str, ...]) -> Simulation:
    """Return the simulation of bodies that touch. Raises `SceneUnsupported`.

    approximations: the names of the integrators that are approximations of contact of the discrete plant.
    """
    if method.accuracy is not None and not scene.pushes:

        def with_state() -> tuple[Model, Callable[[], Array]]:
            touched = built(scene, method, approximations)
            return touched.model, touched.seen

        return controlled(with_state, method, in_body_axes)
    return stepped(built(scene, method, approximations), method)


def stepped(touched: Touching, method: Method) -> Simulation:
    """Return the simulation that steps one model, also to samples with error control."""
    step_to, seen = touched.step_to, touched.seen
    if method.accuracy is not None:

        def at(time: float) -> Array:
            step_to(time)
            return seen()

        simulation = controlled(lambda: (touched.model, seen), method, in_body_axes)
        return replace(simulation, at=at, between=None)

    def step(taken: int) -> int:
        step_to((taken + 1) * method.timestep)
        return taken + 1

    return Loop(0, step, lambda _: seen(), in_body_axes)


def built(scene: AnyScene, method: Method, approximations: tuple[str, ...]) -> Touching:
    """Return the bodies of a scene in a model. Raises `SceneUnsupported`."""
    builder, parts, plane = DiagramBuilder(), touching_bodies(scene), plane_of(scene)
    plant, _ = AddMultibodyPlant(configured(method, approximations), builder)
    plant.set_name(PLANT)
    names = [body_name(number) for number in range(len(parts))] if isinstance(scene, Mechanism) else ["body"]
    bodies = [add_link(plant, name, link_of(part.body)) for name, part in zip(names, parts, strict=True)]
    plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, -scene.gravity])
    contact, (frictions, dissipations) = contact_of(method, ""), of_bodies(scene, parts)
    on_plane = properties(frictions[WORLD], dissipations[WORLD])
    rigid(on_plane)
    turn = RigidTransform(Quaternion(math.cos(plane.incline / 2), 0.0, math.sin(plane.incline / 2), 0.0), np.zeros(3))
    plant.RegisterCollisionGeometry(plant.world_body(), turn, HalfSpace(), "plane", on_plane)
    for number, (body, part) in enumerate(zip(bodies, parts, strict=True)):
        on_body = properties(frictions[number], dissipations[number])
        if contact == "hydroelastic" or (not contact and isinstance(part.shape, shapes.Brick | shapes.Cylinder)):
            compliant(on_body, part.shape)
        for label, (geometry, position) in enumerate(geometries(part.shape, contact, alone=len(parts) == 1)):
            plant.RegisterCollisionGeometry(body, RigidTransform(position), geometry, f"{names[number]} {label}", on_body)
    plant.Finalize()
    simulator = Simulator(builder.Build())
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    for body, part in zip(bodies, parts, strict=True):
        turned = np.array(part.start.quaternion)
        spin = rotate(turned, np.array(part.start.angular_velocity))
        plant.SetFreeBodyPose(context, body, RigidTransform(Quaternion(turned), part.start.position))
        plant.SetFreeBodySpatialVelocity(context, body, SpatialVelocity(spin, np.array(part.start.velocity)))
    model = Model(simulator, plant, context)
    step_to = pushed(model, bodies, instants(scene.pushes, method))
    integrated(simulator, method, continuous=method.integrator not in approximations)
    return Touching(model, bodies, seer(model, bodies), step_to)


def geometries(shape: Shape, contact: str, *, alone: bool) -> list[tuple[Any, list[float]]]:
    """Return the geometries of a body, each with the position (m) of its centre in the body's frame.

    alone: whether the body is the only one. Raises `SceneUnsupported`.
    """
    centre = [0.0, 0.0, 0.0]
    match shape:
        case shapes.Brick((a, b, c)) if contact == "points":
            if not alone:
                raise SceneUnsupported("contact=points has points at corners, which do not touch the points of other bricks")
            return [(Sphere(0.0), [x, y, z]) for x in (-a, a) for y in (-b, b) for z in (-c, c)]
        case shapes.Brick((a, b, c)):
            return [(Box(2 * a, 2 * b, 2 * c), centre)]
        case shapes.Cylinder(radius, half_length):
            if contact == "points":
                raise SceneUnsupported(f"contact=points has points at corners, which {describe_shape(shape)} does not have")
            return [(Cylinder(radius, 2 * half_length), centre)]
        case shapes.Ellipsoid((a, b, c)):
            return [(Ellipsoid(a, b, c), centre)]
        case _:
            return [(Sphere(shape.radius), centre)]


def instants(pushes: Sequence[Push], method: Method) -> dict[float, tuple[Push, ...]]:
    """Return the pushes that act from each instant (s) on at which a push begins or ends, in ascending order."""
    if method.accuracy is None:
        return {step * method.timestep: acting for step, acting in switches(pushes, method.timestep).items()}
    edges = {0.0, *(edge for push in pushes for edge in (push.start, push.end) if math.isfinite(edge))}
    return {edge: tuple(push for push in pushes if push.start <= edge < push.end) for edge in sorted(edges)}


def pushed(model: Model, bodies: Sequence[Any], by_instant: Mapping[float, tuple[Push, ...]]) -> Callable[[float], None]:
    """Return a function that steps a model to a time (s), and switches pushes at their instants (s)."""
    step_to, port = stepping_to(model), model.plant.get_applied_spatial_force_input_port()
    waiting = list(by_instant)

    def exert(pushes: Sequence[Push]) -> None:
        forces = []
        for push in pushes:
            force = ExternallyAppliedSpatialForce()
            force.body_index, force.p_BoBq_B = bodies[push.body].index(), np.array(push.point)
            force.F_Bq_W = SpatialForce(tau=np.zeros(3), f=np.array(push.force))
            forces.append(force)
        port.FixValue(model.context, Value[list[ExternallyAppliedSpatialForce]](forces))

    def pushed_to(time: float) -> None:
        while waiting and waiting[0] < time:
            instant = waiting.pop(0)
            step_to(instant)
            exert(by_instant[instant])
        step_to(time)

    if any(by_instant.values()):
        exert(by_instant[waiting.pop(0)])
    else:
        waiting.clear()
    return pushed_to


def interface_loads(
    scene: AnyScene, method: Method, approximations: tuple[str, ...], steps: int
) -> dict[tuple[int, int], Array]:
    """Return the normal forces between pairs that touch after each of n steps, as `InterfaceLoads.interface_loads` does."""
    touched, by_pair = built(scene, method, approximations), dict[tuple[int, int], Array]()
    for step in range(steps):
        touched.step_to((step + 1) * method.timestep)
        for pair, load in pressed(touched):
            by_pair.setdefault(pair, np.zeros(steps))[step] += load
    return by_pair


def pressed(touched: Touching) -> Iterator[tuple[tuple[int, int], float]]:
    """Yield the pair of each present contact, and its normal force (N)."""
    plant, context = touched.model.plant, touched.model.context
    indices = {body.index(): index for index, body in enumerate(touched.bodies)} | {plant.world_body().index(): WORLD}
    results = plant.get_contact_results_output_port().Eval(context)

    def pair(one: Any, other: Any) -> tuple[int, int]:
        first, second = sorted((indices[one], indices[other]))
        return first, second

    for number in range(results.num_point_pair_contacts()):
        contact = results.point_pair_contact_info(number)
        load = abs(contact.contact_force() @ contact.point_pair().nhat_BA_W)
        yield pair(contact.bodyA_index(), contact.bodyB_index()), load
    inspector = plant.get_geometry_query_input_port().Eval(context).inspector()
    for number in range(results.num_hydroelastic_contacts()):
        contact = results.hydroelastic_contact_info(number)
        surface = contact.contact_surface()
        frames = (inspector.GetFrameId(geometry) for geometry in (surface.id_M(), surface.id_N()))
        one, other = (plant.GetBodyFromFrameId(frame).index() for frame in frames)
        faces = range(surface.num_faces())
        normal = sum(surface.area(face) * surface.face_normal(face) for face in faces) / surface.total_area()
        yield pair(one, other), abs(contact.F_Ac_W().translational() @ normal)


def terms(scene: AnyScene, method: Method) -> str:
    """Return the contact law that Drake has in the place of a scene's, as `ContactTerms.contact_terms` does."""
    if scene.plane is None:
        return ""
    parts = touching_bodies(scene)
    friction, restitution = wanted(scene, len(parts))
    phrases = []
    if any(friction.values()):
        tolerance = f", with a stiction tolerance of {MultibodyPlantConfig().stiction_tolerance:g} m/s"
        phrases.append(f"friction that grows with the slip{tolerance if method.integrator != WITHOUT_DISSIPATION else ''}")
    if any(restitution.values()) and method.integrator == WITHOUT_DISSIPATION:
        phrases.append("no restitution, since sap ignores the dissipation of Hunt and Crossley")
    elif any(restitution.values()):
        stated = {law.bodies for law in laws(scene)}
        for pair, value in restitution.items():
            if value and (pair in stated or WORLD in pair):
                speed = impact_speed(*pair, parts, scene)
                names = ["the plane" if index == WORLD else parts[index].name for index in pair]
                between = f" between {names[1]} and {names[0]}" if len(parts) > 1 else ""
                phrases.append(
                    f"dissipation {dissipation_of(value, speed):.3g} s/m of Hunt and Crossley for the restitution {value:g} at "
                    f"{speed:.3g} m/s{between}"
                )
    frictions, _ = of_bodies(scene, parts)
    harmonic = COMBINED["harmonic mean"]
    phrases += differing("friction", friction, lambda a, b: harmonic(frictions[a], frictions[b]), parts)
    return "; ".join(phrases)


def of_bodies(scene: AnyScene, parts: Sequence[TouchingBody]) -> tuple[dict[int, float], dict[int, float]]:
    """Return the coefficients of friction, and the dissipations (s/m), of the plane, with the index `WORLD`, and of bodies.

    Drake takes the harmonic mean of two coefficients of friction, and of two dissipations of bodies that are equally stiff the
    mean.
    """
    friction, restitution = wanted(scene, len(parts))
    dissipations = {pair: dissipation_of(value, impact_speed(*pair, parts, scene)) for pair, value in restitution.items()}
    frictions = {index: min(value, MOST_FRICTION) for index, value in shared(friction, "harmonic mean").items()}
    return frictions, shared(dissipations, "mean")


def dissipation_of(restitution: float, speed: float) -> float:
    """Return the dissipation (s/m) of a pair with a coefficient of restitution that meets at a speed (m/s)."""
    return dissipation(restitution, speed) if restitution > 0 and speed > 0 else DISSIPATION
