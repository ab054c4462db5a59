"""A mechanism in words: its bodies, its joints with what acts in them, its loops, and gravity."""

from collections import Counter

from bodycheck.reference.mechanisms.exact import nearest_inertia
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, Mechanism
from bodycheck.reports.quantities import count, listing, number
from bodycheck.reports.runs.surroundings import contact, on_plane, pushed

#: Most bodies and joints that are told one by one.
MOST_TOLD = 6

#: What acts in a joint besides what it holds, by the names of `Joint`, in words.
ACTING = {
    "armature": "an armature",
    "damping": "damping",
    "stiffness": "a spring",
    "friction": "dry friction",
    "effort": "a constant effort",
}


def described(mechanism: Mechanism) -> tuple[tuple[str, str], ...]:
    """Return the terms and texts of the facts of a mechanism."""
    environment = [f"gravity {number(mechanism.gravity)} m/s²" if mechanism.gravity else "no gravity"]
    if mechanism.plane is not None:
        environment.append(on_plane(mechanism.plane))
        environment += [contact(mechanism, pair) for pair in mechanism.contacts[:MOST_TOLD]]
        environment += ["and other pairs"] if len(mechanism.contacts) > MOST_TOLD else []
    environment += [pushed(push, mechanism.bodies[push.body].name) for push in mechanism.pushes]
    loops = count(len(mechanism.loops), "loop")
    return (
        ("Bodies", _bodies(mechanism)),
        ("Joints", _joints(mechanism)),
        *((("Loops", f"{loops}, each of which holds a point of one body on a point of another"),) if mechanism.loops else ()),
        ("Environment", ", ".join(environment)),
    )


def _bodies(mechanism: Mechanism) -> str:
    masses = [nearest_inertia(body).mass for body in mechanism.bodies]
    if len(masses) > MOST_TOLD:
        least, most = number(min(masses)), number(max(masses))
        return f"{len(masses)} of {least if least == most else f'{least} to {most}'} kg"
    return listing([f"{body.name} {number(mass)} kg" for body, mass in zip(mechanism.bodies, masses, strict=True)])


def _joints(mechanism: Mechanism) -> str:
    """Return which joints there are: each, or how many of each type where they are many."""
    free = sum(joint is None for joint in mechanism.joint_of)
    rest = f"{count(free, 'body', 'bodies')} on no joint" if free else ""
    if not mechanism.joints:
        return rest
    if len(mechanism.joints) <= MOST_TOLD:
        told = "; ".join(_joint(mechanism, joint) for joint in mechanism.joints)
    else:
        types = Counter(joint.type for joint in mechanism.joints).items()
        told = listing([f"{amount} {kind}" for kind, amount in types])
        acting = [text for name, text in ACTING.items() if any(getattr(joint, name) for joint in mechanism.joints)]
        told += f", with {listing(acting)}" if acting else ""
    return "; ".join(filter(None, (told, rest)))


def _joint(mechanism: Mechanism, joint: Joint) -> str:
    parent = "the world" if joint.parent == WORLD else mechanism.bodies[joint.parent].name
    acting = [text for name, text in ACTING.items() if getattr(joint, name)]
    with_these = f", with {listing(acting)}" if acting else ""
    return f"{joint.name}: {joint.type}, {mechanism.bodies[joint.child].name} on {parent}{with_these}"
