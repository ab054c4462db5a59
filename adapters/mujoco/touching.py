"""Step free bodies that touch a plane and each other in MuJoCo, by MuJoCo's own contacts.

Each body has a free joint at its centre of mass and one geom of its shape; bodies on joints that touch others are in the module
`gripping`. The plane is an infinite geom that is rotated about y. All geoms have the friction of the scene's plane: MuJoCo uses
the larger coefficient of two geoms, which is this coefficient for every pair. Pairs with other coefficients are elements
`pair`, which replace the contacts that MuJoCo finds itself. A pair without friction has contacts of one dimension. The options
of the module `contact` apply to all pairs.

A pair with rolling friction has contacts of six dimensions, and one with torsional friction alone has contacts of four. Both
coefficients are lengths, as MuJoCo's are.

MuJoCo has no coefficient of restitution. The fraction of its velocity with which a body rebounds follows from the stiffness and
the damping of the contact, which by default do not depend on the scene. The option `restitution=solref` chooses both for each
pair that has a coefficient, such that a point that hits a fixed plane without gravity rebounds with this fraction: see
`bounce`.

A push is an applied force. The torque of a push beside the centre of mass turns with the body. It is evaluated together with
MuJoCo's own passive forces, so that every integrator keeps its order.
"""

import math
from collections import defaultdict
from collections.abc import Sequence
from functools import partial
from typing import Any
from xml.etree import ElementTree

import mujoco
import numpy as np
from numpy.typing import NDArray

from bodycheck.adapters.contract import Method, SceneUnsupported, kind_of
from bodycheck.adapters.mujoco import contact
from bodycheck.adapters.mujoco.contact import numbers_written
from bodycheck.adapters.mujoco.models import Force, compiled_model, geometry
from bodycheck.adapters.mujoco.stepping import Stepper, external_force, refuse_warnings
from bodycheck.adapters.touching import Law, Pushed, TouchingBody, laws, switches, touching_bodies
from bodycheck.reference.kinematics import conjugate, rotate
from bodycheck.reference.mechanisms.mechanism import WORLD, AnyScene
from bodycheck.reference.scene import Push, Shape, Vector
from bodycheck.reference.trajectory import Array

#: The requirements of touching bodies that MuJoCo models, of which restitution is an approximation.
MODELS = frozenset(
    {
        *("incline", "restitution", "rolling", "rolling friction", "torsional friction", "pushes", "contacts"),
        "contacts without a plane",
    }
)

#: The number of steps that a bounce lasts with `restitution=solref`. A shorter bounce is not resolved, a longer one is softer.
STEPS_OF_A_BOUNCE = 20

#: MuJoCo's default time constant (s) and damping ratio of contacts.
DEFAULT_SOLREF = "0.02 1"

#: The smallest coefficient with `restitution=solref`. For this coefficient, the damping removes a contact's velocity in one
#: step.
LEAST_RESTITUTION = 0.02


def prepare(scene: AnyScene, method: Method) -> Pushed[Stepper]:
    """Return the simulation of bodies that touch, as `Adapter.prepare` does. Raises `SceneUnsupported`."""
    bodies = touching_bodies(scene)
    return started(scene, bodies, document(scene, bodies, method), method)


def started(scene: AnyScene, bodies: Sequence[TouchingBody], xml: str, method: Method) -> Pushed[Stepper]:
    """Return the simulation of bodies that touch from their XML. Raises `SceneUnsupported`."""
    model = compiled_model(xml)
    data = mujoco.MjData(model)
    data.qpos[:], data.qvel[:] = coordinates(bodies)
    count = len(bodies)
    stepper = Stepper(model, data, lambda seen: states_of(seen, count))
    return Pushed(stepper, switches(scene.pushes, method.timestep), partial(exert, stepper))


def exert(stepper: Stepper, pushes: Sequence[Push]) -> None:
    """Make pushes act from now on, in the place of those before."""
    data = stepper.data
    data.qfrc_applied[:] = 0
    for push in pushes:
        first = 6 * push.body
        data.qfrc_applied[first : first + 3] += push.force
    beside = [push for push in pushes if any(push.point)]
    stepper.force = torques(data, beside) if beside else None


def interface_loads(scene: AnyScene, method: Method, steps: int) -> dict[tuple[int, int], Array]:
    """Return the normal forces between pairs that touch in each of n steps, as `InterfaceLoads.interface_loads` does.

    MuJoCo reports them at the beginning of a step; for RK4 they belong to the last stage.
    """
    simulation = prepare(scene, method)
    stepper, force = simulation.simulation, np.empty(6)
    model, data, body_of = stepper.model, stepper.data, stepper.model.geom_bodyid

    def step() -> dict[tuple[int, int], float]:
        time, by_pair = data.time, defaultdict[tuple[int, int], float](float)
        with external_force(stepper.force):
            mujoco.mj_step(model, data)
        refuse_warnings(data, time)
        # `contact.geom`, which has both geoms, is not in the first releases of MuJoCo 3.
        for number, geoms in enumerate(zip(data.contact.geom1, data.contact.geom2, strict=True)):
            mujoco.mj_contactForce(model, data, number, force)
            by_pair[pair_of(body_of[list(geoms)])] += force[0]
        return by_pair

    return simulation.loads(steps, step)


def pair_of(bodies: NDArray[np.integer[Any]]) -> tuple[int, int]:
    """Return the indices of two bodies in the scene, the lower first, from their numbers (2,) in MuJoCo's model.

    The world is MuJoCo's body 0, and the bodies follow in their order.
    """
    first, second = sorted((bodies - 1).tolist())
    return first, second


def coordinates(bodies: Sequence[TouchingBody]) -> tuple[list[float], list[float]]:
    """Return MuJoCo's coordinates and velocities of free bodies at t = 0."""
    starts = [body.start for body in bodies]
    qpos = [number for start in starts for number in (*start.position, *start.quaternion)]
    return qpos, [number for start in starts for number in (*start.velocity, *start.angular_velocity)]


def states_of(seen: Array, bodies: int) -> Array:
    """Return the states (n, bodies, 13) from coordinates and velocities (n, 7 + 6 bodies) of free joints at centres of mass."""
    qpos, qvel = np.split(seen, [7 * bodies], axis=1)
    return np.concatenate([qpos.reshape(-1, bodies, 7), qvel.reshape(-1, bodies, 6)], axis=2)


def torques(data: mujoco.MjData, pushes: Sequence[Push]) -> Force:
    """Return a passive force on `data`: the torques of pushes about the centres of mass, along the axes of the bodies."""
    indices = [push.body for push in pushes]
    points, forces = np.array([push.point for push in pushes]), np.array([push.force for push in pushes])
    attitudes = [data.qpos[7 * index + 3 : 7 * index + 7] for index in indices]
    passive = [data.qfrc_passive[6 * index + 3 : 6 * index + 6] for index in indices]

    def force(_model: object, _data: object) -> None:
        quaternions = np.array(attitudes)  # in a stage of RK4 they have norm 1 too
        turned = np.cross(points, rotate(conjugate(quaternions), forces))
        for forces_of_body, torque in zip(passive, turned, strict=True):
            forces_of_body += torque

    return force


def document(scene: AnyScene, bodies: Sequence[TouchingBody], method: Method) -> str:
    """Return MuJoCo's XML of free bodies that touch. Raises `SceneUnsupported`."""
    root, world = surrounded(scene, method)
    for index, body in enumerate(bodies):
        add_body(world, index, body)
    return written(root)


def surrounded(scene: AnyScene, method: Method) -> tuple[ElementTree.Element, ElementTree.Element]:
    """Return MuJoCo's XML of the surroundings of bodies that touch, and its element of the world, which has no bodies yet.

    Without a plane, only elements `pair` touch. Raises `SceneUnsupported`.
    """
    chosen = dict(method.options)
    check_options(scene, method)
    root = ElementTree.Element("mujoco")
    ElementTree.SubElement(root, "compiler", angle="radian", balanceinertia="false", inertiafromgeom="false")
    option = {"timestep": repr(method.timestep), "integrator": method.integrator}
    option |= {"gravity": numbers_written(0, 0, -scene.gravity)} | contact.solver_options(chosen)
    element = ElementTree.SubElement(root, "option", option)
    if "multiccd" in chosen:
        ElementTree.SubElement(element, "flag", multiccd=chosen["multiccd"])
    usual, *others = laws(scene)
    law_of_plane = law_written(usual, method) | {"friction": numbers_written(usual.friction, *moments(usual))}
    alone = {"contype": "0", "conaffinity": "0"}
    ElementTree.SubElement(ElementTree.SubElement(root, "default"), "geom", law_of_plane if scene.plane else alone)
    world = ElementTree.SubElement(root, "worldbody")
    if scene.plane is not None:
        turn = numbers_written(math.cos(scene.plane.incline / 2), 0, math.sin(scene.plane.incline / 2), 0)
        ElementTree.SubElement(world, "geom", name=geom_name(WORLD), type="plane", size="0 0 1", quat=turn)
    if others:
        pairs = ElementTree.SubElement(root, "contact")
        for law in others:
            one, other = map(geom_name, law.bodies)
            torsional, rolling = moments(law)
            sliding = numbers_written(law.friction, law.friction, torsional, rolling, rolling)
            touching = law_written(law, method) | {"friction": sliding}
            ElementTree.SubElement(pairs, "pair", {"geom1": one, "geom2": other} | touching)
    return root, world


def written(root: ElementTree.Element) -> str:
    """Return an element as text."""
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode")


def add_body(world: ElementTree.Element, index: int, body: TouchingBody) -> None:
    """Add a free body with its shape to the XML of the world."""
    element = ElementTree.SubElement(world, "body", name=body.name, pos=numbers_written(*body.start.position))
    ElementTree.SubElement(element, "freejoint")
    axes, moments = numbers_written(*body.body.axes), numbers_written(*body.body.moments)
    mass = numbers_written(body.body.mass)
    ElementTree.SubElement(element, "inertial", pos="0 0 0", mass=mass, quat=axes, diaginertia=moments)
    add_geom(element, index, body.shape)


def add_geom(element: ElementTree.Element, index: int, shape: Shape, centre: Vector = (0.0, 0.0, 0.0)) -> None:
    """Add the shape of a body, whose centre is at a point of its frame (m), to the element of the body."""
    geom = ElementTree.fromstring(geometry(shape))
    geom.set("name", geom_name(index))
    if any(centre):
        geom.set("pos", numbers_written(*centre))
    element.append(geom)


def geom_name(index: int) -> str:
    """Return the name of the geom of a body, or of the plane."""
    return "plane" if index == WORLD else f"shape {index + 1}"


def check_options(scene: AnyScene, method: Method) -> None:
    """Raise `SceneUnsupported` for options that do not fit the scene or each other, or that MuJoCo would silently change."""
    chosen = dict(method.options)
    if (model := chosen.get("model")) is not None:
        raise SceneUnsupported(f"no model {model!r} of bodies that touch")
    contact.check_time_constant(chosen, contact.shortest_time_constant(method.integrator, method.timestep))
    if "restitution" in chosen:
        if "solref" in chosen:
            raise SceneUnsupported("restitution=solref together with solref: both set the stiffness of a contact")
        coefficients = [law.restitution for law in laws(scene) if law.restitution]
        if not coefficients:
            raise SceneUnsupported("restitution=solref: nothing in the scene has a coefficient of restitution")
        if min(coefficients) < LEAST_RESTITUTION:
            least = f"a coefficient of {min(coefficients):g}; the least is {LEAST_RESTITUTION:g}"
            raise SceneUnsupported(f"restitution=solref: its damping is not resolved by the steps of a bounce for {least}")


def moments(law: Law) -> tuple[float, float]:
    """Return the coefficients of torsional and of rolling friction (m) of a pair.

    They are those of MuJoCo's defaults for a pair that has neither, whose contacts use them only where `condim` says so. With
    rolling friction, MuJoCo raises a torsional friction to its least coefficient, and MuJoCo Warp, which does not, needs it.
    """
    if not law.resists:
        return contact.TORSION_AND_ROLLING_FRICTION_M
    least = contact.MUJOCO_MIN_FRICTION if law.rolling_friction else 0.0
    return max(law.torsional_friction, least), law.rolling_friction


def dimensions(law: Law) -> str | None:
    """Return the dimensions of a contact with rolling friction (6) or with torsional friction alone (4); else None."""
    return "6" if law.rolling_friction else "4" if law.torsional_friction else None


def law_written(law: Law, method: Method) -> dict[str, str]:
    """Return the attributes of a geom or a pair with a law, except the attributes of friction.

    Raises `SceneUnsupported` if MuJoCo would silently change its friction or its rolling friction.
    """
    chosen = dict(method.options)
    if 0 < law.rolling_friction < contact.MUJOCO_MIN_FRICTION:
        raise SceneUnsupported(
            f"a rolling friction of {law.rolling_friction:g} m; the least is {contact.MUJOCO_MIN_FRICTION:g} m"
        )
    needed = dimensions(law)
    attributes = {"condim": contact.dimensions(law.friction, chosen if needed is None else {"condim": needed} | chosen)}
    attributes |= {key: value for key, value in chosen.items() if key in ("solref", "solimp")}
    if "restitution" in chosen and law.restitution:
        stiffness, damping = bounce(law.restitution, method.timestep)
        attributes["solref"] = numbers_written(-stiffness, -damping)
    return attributes


def contact_terms(scene: AnyScene, method: Method) -> str:
    """Return what MuJoCo's own contacts are handed in the place of the scene's coefficients, as `ContactTerms` says.

    MuJoCo has one elliptic cone for friction and both moments, or a pyramid within it.
    """
    if kind_of(scene) not in ("plane", "contact"):
        return ""
    coefficients = sorted({law.restitution for law in laws(scene) if law.restitution})
    terms: list[str] = []
    elliptic = method.option("cone") == "elliptic"
    if any(law.friction for law in laws(scene)):
        cone = "soft friction" if elliptic else "soft friction in a pyramid of four sides"
        terms.append("no friction" if method.option("condim") == "1" else cone)
    terms += _moment_terms([law for law in laws(scene) if law.resists], elliptic, method)
    for coefficient in coefficients:
        if "restitution" in dict(method.options):
            stiffness, damping = bounce(coefficient, method.timestep)
            held = f"a spring of {stiffness:.4g}/s^2 and a damper of {damping:.4g}/s"
        else:
            held = f"a spring and a damper with solref={method.option('solref') or DEFAULT_SOLREF}"
        terms.append(f"restitution {coefficient:g} as {held}")
    return "; ".join(terms)


def _moment_terms(resisting: Sequence[Law], elliptic: bool, method: Method) -> list[str]:
    """The cone of rolling and torsional friction, and the coefficients that MuJoCo raises to its least one."""
    if not resisting:
        return []
    terms = []
    if not (elliptic and all(law.cone == "one" for law in resisting)):
        terms.append(f"{'one elliptic cone' if elliptic else 'a pyramid'} of friction, torsional and rolling friction")
    raised = any(law.rolling_friction and law.torsional_friction < contact.MUJOCO_MIN_FRICTION for law in resisting)
    if raised and method.option("condim") in (None, "6"):
        terms.append(f"torsional friction {contact.MUJOCO_MIN_FRICTION:g} m")
    return terms


def bounce(restitution: float, timestep: float) -> tuple[float, float]:
    """Return the stiffness (1/s^2) and the damping (1/s) of a contact with a coefficient of restitution, above 0 to 1.

    A contact only pushes. A point that enters a spring with a damper, x'' = -2 zeta w x' - w^2 x, leaves it when x'' = 0, with
    the fraction exp(-2 c / tan c) of its velocity, zeta = cos c (Schwager and Poeschel, Granular Matter 9, 465, 2007), or
    exp(-2 b / tanh b), zeta = cosh b. The frequency w is such that without a damper the bounce lasts `STEPS_OF_A_BOUNCE` steps.
    """
    stiffness = (math.pi / (STEPS_OF_A_BOUNCE * timestep)) ** 2
    return stiffness, 2 * damping_ratio(restitution) * math.sqrt(stiffness)


def damping_ratio(restitution: float) -> float:
    """Return the damping ratio of a spring that only pushes and has a coefficient of restitution, above 0 to 1."""
    from scipy.optimize import brentq  # takes longer to import than the rest of this adapter without MuJoCo

    wanted = -math.log(restitution)
    if wanted < 2:
        return math.cos(brentq(lambda c: 2 * c / math.tan(c) - wanted, 1e-9, 2.0))
    return math.cosh(brentq(lambda b: 2 * b / math.tanh(b) - wanted, 1e-9, wanted))
