"""Step free bodies that touch a plane and each other in Exudyn, by its contacts of a sphere with a triangle or a sphere.

Exudyn has no contact of two triangles. A brick therefore touches the plane by small spheres in its corners; bricks among
several bodies, cylinders and ellipsoids are `unsupported`. The plane is a triangle on the ground, turned about y.

A contact is a linear spring, for whose stiffness Exudyn has no default: here a body oscillates on it with the time constant of
the contacts of a flat brick (module `contact`), or with a shorter one, such that the first impact presses no sphere in by more
than half of its radius. A pair with a coefficient of restitution has Exudyn's impact model 2, which its documentation calls
"much more accurate" than the others. Its damping belongs to the speed of an impact; `minimumImpactVelocity` is the speed for
which it is critical for a body at rest. A pair without restitution has a linear damper that is critical. Friction is Coulomb's,
and proportional to the velocity below 1 mm/s, which is Exudyn's default.

The state of a contact is that of the last iteration for discontinuities, which only the implicit solvers make. They halve steps
in which it does not converge. A push is a load that is set at the start of a step.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import product
from typing import Any

import exudyn
import numpy as np
from exudyn import itemInterface

from bodycheck.adapters.contract import Method, SceneUnsupported, Simulation
from bodycheck.adapters.exudyn import formulations, sensing, stepping
from bodycheck.adapters.exudyn.contact import GROUND_SIZE_M, TIME_CONSTANT_S
from bodycheck.adapters.exudyn.formulations import FORMULATIONS, Formulation
from bodycheck.adapters.exudyn.stepping import Stepper
from bodycheck.adapters.links import link_of
from bodycheck.adapters.pair_coefficients import impact_speed
from bodycheck.adapters.stepping import Normalised
from bodycheck.adapters.touching import Law, Pushed, TouchingBody, laws, laws_of_pairs, plane_of, switches, touching_bodies
from bodycheck.reference.mechanisms.mechanism import WORLD, AnyScene
from bodycheck.reference.planar import describe_shape
from bodycheck.reference.requirements import touches
from bodycheck.reference.scene import Brick, Push, Sphere
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.trajectory import Array

#: The requirements of touching bodies that Exudyn models, of which restitution is an approximation.
MODELS = frozenset({"incline", "restitution", "rolling", "pushes", "contacts", "contacts without a plane"})

#: The speed (m/s) below which Exudyn's friction is proportional to the velocity, by its default.
FRICTION_ZONE = 1e-3

#: The radius of the spheres in the corners of a brick, over its least half-length.
RADIUS_OF_CORNERS = 0.2

#: The number of corners that bear a brick.
BEARING = 4


@dataclass(frozen=True, eq=False)
class Touching:
    """Bodies that touch in a system of Exudyn.

    Parameters
    ----------
    stepper
        The simulation without changes of the pushes.
    formulation
        The formulation of the rotations.
    contacts
        The numbers of the contacts, each with the indices of its two bodies, of which the first may be `WORLD`.
    loads
        The pushes with the numbers of their loads.
    read
        Returns the readings of the sensors.
    """

    stepper: Stepper
    formulation: Formulation
    contacts: Sequence[tuple[tuple[int, int], Any]]
    loads: Sequence[tuple[Push, Any]]
    read: Callable[[], tuple[Array, ...]]

    def exert(self, pushes: Sequence[Push]) -> None:
        """Make pushes act from now on, in the place of those before."""
        for push, load in self.loads:
            acting = [*push.force] if push in pushes else [0.0, 0.0, 0.0]
            self.stepper.system.SetLoadParameter(load, "loadVector", acting)


def prepare(scene: AnyScene, method: Method) -> Simulation:
    """Return the simulation of bodies that touch, as `Adapter.prepare` does. Raises `SceneUnsupported`."""
    return simulated(scene, built(scene, method), method)


def simulated(scene: AnyScene, touching: Touching, method: Method) -> Simulation:
    """Return the simulation of bodies that touch from their system."""
    pushed = Pushed(touching.stepper, switches(scene.pushes, method.timestep), touching.exert)
    return Normalised(pushed) if touching.formulation is FORMULATIONS["EP"] else pushed


def built(scene: AnyScene, method: Method, sensors: Sequence[Sensor] = ()) -> Touching:
    """Return a system with the bodies of a scene in their initial states, and with sensors. Raises `SceneUnsupported`."""
    parts, formulation = touching_bodies(scene), formulations.of_method(method)
    for part in parts:
        check_shape(part, alone=len(parts) == 1)
    container = exudyn.SystemContainer()
    system = container.AddSystem()
    bodies = [formulations.add_body(system, formulation, link_of(part.body), part.start, scene.gravity) for part in parts]
    ground = system.AddMarker(itemInterface.MarkerNodeRigid(nodeNumber=system.AddNode(itemInterface.NodePointGround())))
    contacts: list[tuple[tuple[int, int], Any]] = []
    for pair, law in laws_of_pairs(scene, len(parts)).items():
        one, other = pair
        options = parameters(law, pair, parts, scene)
        if one != WORLD:
            contacts.append((pair, on_each_other(system, [(bodies[index], parts[index]) for index in pair], options)))
            continue
        for sphere in spheres(parts[other]):
            contacts.append((pair, on_plane(system, ground, bodies[other], sphere, plane_of(scene).incline, options)))
    loads = [(push, add_load(system, bodies[push.body], push)) for push in scene.pushes]
    read = sensing.of_touching(system, bodies, contacts, sensors)
    count = formulations.coordinates(formulation)

    def seen() -> Array:
        data = system.systemData
        return np.stack([data.GetODE2Coordinates().reshape(-1, count), data.GetODE2Coordinates_t().reshape(-1, count)])

    def rows(states: Array) -> Array:
        together = np.moveaxis(states, 1, 2).reshape(-1, 2 * count)
        return formulations.rows(formulation, together).reshape(len(states), len(parts), 13)

    stepper = stepping.initialised(container, system, method, seen, rows, impacts=True)
    assert isinstance(stepper, Stepper)  # no implicit solver has error control
    return Touching(stepper, formulation, contacts, loads, read)


def check_shape(part: TouchingBody, *, alone: bool) -> None:
    """Raise `SceneUnsupported` for a body whose shape is none of Exudyn's. alone: whether it is the only body."""
    if isinstance(part.shape, Sphere) or (isinstance(part.shape, Brick) and alone):
        return
    among = "" if alone else " among several bodies"
    lacking = f"Exudyn has contacts of a sphere with a sphere or a triangle, but none of {describe_shape(part.shape)}{among}"
    raise SceneUnsupported(lacking)


def spheres(part: TouchingBody) -> list[tuple[list[float], float]]:
    """Return the centres, in the frame of a body, and the radii of the spheres by which it touches (m)."""
    if isinstance(part.shape, Sphere):
        return [([0.0, 0.0, 0.0], part.shape.radius)]
    assert isinstance(part.shape, Brick)  # `check_shape` has said so
    radius = RADIUS_OF_CORNERS * min(part.shape.semi_axes)
    sides = [(radius - half, half - radius) for half in part.shape.semi_axes]
    return [([*corner], radius) for corner in product(*sides)]


def parameters(law: Law, pair: tuple[int, int], parts: Sequence[TouchingBody], scene: AnyScene) -> dict[str, Any]:
    """Return the parameters of each contact of a pair with a law."""
    masses = [parts[index].body.mass for index in pair if index != WORLD]
    shared = BEARING if any(isinstance(parts[index].shape, Brick) for index in pair if index != WORLD) else 1
    mass, constant = 1 / sum(1 / mass for mass in masses) / shared, time_constant(pair, parts, scene)
    given: dict[str, Any] = {"contactStiffness": mass / constant**2, "dynamicFriction": law.friction}
    if not law.restitution:
        return given | {"contactDamping": 2 * mass / constant}
    lowest = slowest(law.restitution, constant, scene)
    return given | {"impactModel": 2, "restitutionCoefficient": law.restitution, "minimumImpactVelocity": lowest}


def time_constant(pair: tuple[int, int], parts: Sequence[TouchingBody], scene: AnyScene) -> float:
    """Return the time constant (s) of a pair on its contacts."""
    radius = min(radius for index in pair if index != WORLD for _, radius in spheres(parts[index]))
    speed = impact_speed(*pair, parts, scene)
    return min(TIME_CONSTANT_S, radius / 2 / speed) if speed else TIME_CONSTANT_S


def slowest(restitution: float, constant: float, scene: AnyScene) -> float:
    """Return the speed (m/s) of impacts whose damping is critical for a body at rest on its contacts.

    In impact model 2, the damping is k c d / v, for the stiffness k, the penetration d and the speed v of the impact. The
    factor c is that of Exudyn's documentation. constant: the time constant (s) of the body on its contacts.
    """
    if restitution > 1 / 3:
        factor = 1.5 * (1 - restitution) * (11 - restitution) / (1 + 9 * restitution)
    else:
        factor = (1 - restitution**2) / restitution
    return factor * scene.gravity * constant / 2


def on_plane(
    system: "exudyn.MainSystem",
    ground: Any,
    body: Any,
    sphere: tuple[list[float], float],
    incline: float,
    options: Mapping[str, Any],
) -> Any:
    """Add the contact of a sphere on a body, with a centre and a radius, with the plane, and return its number."""
    centre, radius = sphere
    cosine, sine = math.cos(incline), math.sin(incline)
    corners = [(-GROUND_SIZE_M, -GROUND_SIZE_M), (3 * GROUND_SIZE_M, -GROUND_SIZE_M), (-GROUND_SIZE_M, 3 * GROUND_SIZE_M)]
    marker = system.AddMarker(itemInterface.MarkerBodyRigid(bodyNumber=body, localPosition=centre))
    return system.AddObject(
        itemInterface.ObjectContactSphereTriangle(
            markerNumbers=[marker, ground],
            nodeNumber=data_node(system),
            sphereRadius=radius,
            trianglePoints=exudyn.Vector3DList([[x * cosine, y, -x * sine] for x, y in corners]),
            **options,
        )
    )


def on_each_other(system: "exudyn.MainSystem", pair: Sequence[tuple[Any, TouchingBody]], options: Mapping[str, Any]) -> Any:
    """Add the contact of two spheres, each a body and its part of the scene, and return its number."""
    markers = [system.AddMarker(itemInterface.MarkerBodyRigid(bodyNumber=body)) for body, _ in pair]
    radii = [radius for _, part in pair for _, radius in spheres(part)]
    return system.AddObject(
        itemInterface.ObjectContactSphereSphere(
            markerNumbers=markers, nodeNumber=data_node(system), spheresRadii=radii, **options
        )
    )


def data_node(system: "exudyn.MainSystem") -> Any:
    """Add a node for the state of a contact that is open, and return its number."""
    return system.AddNode(itemInterface.NodeGenericData(initialCoordinates=[0.0] * 4, numberOfDataCoordinates=4))


def add_load(system: "exudyn.MainSystem", body: Any, push: Push) -> Any:
    """Add the load of a push, without a force as yet, and return its number."""
    marker = system.AddMarker(itemInterface.MarkerBodyRigid(bodyNumber=body, localPosition=[*push.point]))
    return system.AddLoad(itemInterface.LoadForceVector(markerNumber=marker, loadVector=[0.0, 0.0, 0.0]))


def interface_loads(scene: AnyScene, method: Method, steps: int) -> dict[tuple[int, int], Array]:
    """Return the normal forces between pairs that touch in each of n steps, as `InterfaceLoads.interface_loads` does."""
    touching = built(scene, method)
    pushed = Pushed(touching.stepper, switches(scene.pushes, method.timestep), touching.exert)
    return pushed.loads(steps, partial(step_with_loads, touching))


def step_with_loads(touching: Touching) -> Mapping[tuple[int, int], float]:
    """Take one step, and return the normal forces (N) of the pairs that touch at its end."""
    system = touching.stepper.system
    touching.stepper.advance(np.ones(1, dtype=np.int64))
    by_pair: dict[tuple[int, int], float] = {}
    for pair, contact in touching.contacts:
        normal = np.array(system.GetObjectOutput(contact, exudyn.OutputVariableType.Director1))
        if pressed := abs(float(sensing.force_of(system, contact) @ normal)):
            by_pair[pair] = by_pair.get(pair, 0.0) + pressed
    return by_pair


def contact_terms(scene: AnyScene, method: Method) -> str:
    """Return what Exudyn is given in the place of a scene's friction and restitution, as `ContactTerms` does."""
    if not touches(scene):
        return ""
    parts = touching_bodies(scene)
    phrases = []
    if any(law.friction for law in laws(scene)):
        phrases.append(f"friction that is proportional to the velocity below {FRICTION_ZONE:g} m/s")
    for restitution in sorted({law.restitution for law in laws(scene) if law.restitution}):
        phrases.append(f"restitution {restitution:g} as springs with the damping of impact model 2")
    for part in parts:
        if isinstance(part.shape, Brick):
            _, radius = spheres(part)[0]
            phrases.append(f"spheres of {radius:.3g} m in the corners of {part.name}")
    return "; ".join(phrases)
