"""The choice of the closed form of a mechanism."""

from collections.abc import Callable

from bodycheck.reference.exact.numbers import MP, Real
from bodycheck.reference.exact.rotations import dot
from bodycheck.reference.mechanisms.control import Controller
from bodycheck.reference.mechanisms.driven import form as driven
from bodycheck.reference.mechanisms.forms import oscillator, pendulum
from bodycheck.reference.mechanisms.forms.ball import form_of_ball
from bodycheck.reference.mechanisms.forms.ground import Carried, axis_of, carried, cross, moment_about
from bodycheck.reference.mechanisms.forms.motion import Form, FormMotion, JointForm, gathered
from bodycheck.reference.mechanisms.forms.parallelogram import form_of_parallelograms
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.trajectory import Array

#: The motion of one joint at times (n,), s.
_Follow = Callable[[Array], JointForm]

#: The name of the closed form of a joint, the reason why it is exact, and the motion of the joint.
_Found = tuple[str, str, _Follow]


def form_of(mechanism: Mechanism) -> Form | None:
    """The closed form of the motion of a mechanism; None if there is none.

    Either each joint that moves is on the world, or on a body fixed to it, and has a closed form; or loops make all joints move
    with one angle.
    """
    if any(joint.mimic for joint in mechanism.joints) or mechanism.stops_until is not None:
        return None
    if mechanism.loops:
        limited = mechanism.controllers or any(joint.stops for joint in mechanism.joints)
        return None if limited else form_of_parallelograms(mechanism)
    groups = carried(mechanism)
    if not groups:
        return None
    controllers = {controller.joint: controller for controller in mechanism.controllers}
    forms = {held.index: _form_of_joint(held, controllers.get(held.index)) for held in groups}
    complete = {index: each for index, each in forms.items() if each is not None}
    if len(complete) < len(forms):
        return None
    names = list(dict.fromkeys(name for name, _, _ in complete.values()))
    reasons = list(dict.fromkeys(reason for _, reason, _ in complete.values()))

    def follow(times: Array) -> FormMotion:
        return gathered(mechanism, {index: motion_at(times) for index, (_, _, motion_at) in complete.items()}, len(times))

    return Form(", ".join(names), ", ".join(reasons), follow)


def _form_of_joint(held: Carried, controller: Controller | None) -> _Found | None:
    match held.joint.type:
        case "revolute":
            return _revolute(held, controller)
        case "prismatic":
            return _linear(held, held.mass, held.mass * dot(axis_of(held), held.gravity), controller)
        case "spherical":
            return form_of_ball(held)
        case _:
            return None


def _revolute(held: Carried, controller: Controller | None) -> _Found | None:
    joint, axis = held.joint, axis_of(held)
    moment = moment_about(held, axis)
    down, arm = cross(axis, held.gravity), cross(axis, held.centre)
    weight = held.mass * MP.sqrt(dot(down, down) * dot(arm, arm))
    if not weight:
        return _linear(held, moment, MP.mpf(0), controller)
    if joint.damping or joint.stiffness or joint.friction or joint.effort or joint.stops or controller:
        return None
    start, velocity = MP.mpf(joint.start[0]), MP.mpf(joint.start_velocity[0])
    equilibrium = MP.atan2(dot(held.gravity, arm), dot(down, arm))
    system = pendulum.Pendulum(weight / (moment + MP.mpf(joint.armature)), equilibrium, start, velocity)
    return "pendulum", "one hinge under gravity alone", lambda times: pendulum.follow(system, times)


def _linear(held: Carried, inertia: Real, force: Real, controller: Controller | None) -> _Found:
    """The closed form of a joint on which gravity has a constant force or torque, `force`.

    inertia: of the carried body along the coordinate, without the armature. Both have a hundred digits.
    """
    joint = held.joint
    system = oscillator.Oscillator(
        inertia=inertia + MP.mpf(joint.armature),
        damping=MP.mpf(joint.damping),
        stiffness=MP.mpf(joint.stiffness),
        rest=MP.mpf(joint.rest),
        force=force + MP.mpf(joint.effort),
        friction=MP.mpf(joint.friction),
        start=MP.mpf(joint.start[0]),
        velocity=MP.mpf(joint.start_velocity[0]),
    )
    if controller or joint.stops:
        name = "joint between stops" if controller is None else "sampled law" if controller.rate else "driven joint"
        return name, "linear in one joint between events", lambda t: driven.follow(system, controller, joint.stops, t)
    reason = "linear between the stops of one joint" if joint.friction else "linear in one joint"
    return (
        "damped oscillator" if joint.damping or joint.stiffness else "one joint",
        reason,
        lambda t: oscillator.follow(system, t),
    )
