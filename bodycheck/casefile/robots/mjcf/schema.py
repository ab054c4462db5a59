"""The attributes that MuJoCo allows, of the elements of MJCF that are read for a case.

https://mujoco.readthedocs.io/en/stable/XMLreference.html
"""

from bodycheck.robots.elements import Element, quoted, refuse
from bodycheck.suggestion import did_you_mean

#: The attributes for an attitude.
TURN = "quat axisangle euler xyaxes zaxis"

#: The attributes of the elements, by their tags.
ATTRIBUTES = {
    "compiler": "alignfree angle assetdir autolimits balanceinertia boundinertia boundmass conflict coordinate "
    "discardvisual eulerseq fitaabb fusestatic inertiafromgeom inertiagrouprange meshdir passthrough "
    "savecanonical savecompiled saveinertial settotalmass strippath texturedir usethread",
    "option": "actuatorgroupdisable ccd_iterations ccd_tolerance cone density gravity impratio integrator "
    "iterations jacobian ls_iterations ls_tolerance magnetic noslip_iterations noslip_tolerance "
    "o_friction o_margin o_solimp o_solref sdf_initpoints sdf_iterations sleep_tolerance solver timestep "
    "tolerance viscosity wind",
    "flag": "actuation autoreset clampctrl constraint contact damper diagexact energy equality eulerdamp "
    "filterparent frictionloss fwdinv gravity invdiscrete ipc island limit midphase multiccd nativeccd "
    "override refsafe sensor sleep speculative spring warmstart",
    "body": f"childclass fuse gravcomp mocap name pos simple sleep user {TURN}",
    "frame": f"childclass name pos {TURN}",
    "replicate": "childclass count euler offset sep",
    "inertial": f"diaginertia fullinertia mass pos {TURN}",
    "joint": "actuatorfrclimited actuatorfrcrange actuatorgravcomp armature axis class damping frictionloss group "
    "limited margin name pos range ref solimpfriction solimplimit solreffriction solreflimit springdamper "
    "springref springyield stiffness type user",
    "freejoint": "align group name",
    "geom": "adhesion castshadow class conaffinity condim contype density fitscale fluidcoef fluidshape friction "
    "fromto gap group hfield margin mass material mesh name pos priority rgba shellinertia size solimp "
    f"solmix solref surfacevel type user {TURN}",
    "site": f"class fromto group material mesh name pos rgba size type user {TURN}",
}

#: Elements whose content is not read.
CLOSED = ("composite", "flexcomp", "plugin")


def check(root: Element) -> None:
    """Raise `BadInput` for an attribute that MuJoCo refuses, of an element that is read for a case."""
    left = [element for element in root.children if element.tag in ("compiler", "option", "worldbody", "default")]
    while left:
        element = left.pop()
        allowed = ATTRIBUTES.get(element.tag, "").split()
        for attribute in element.attributes if allowed else ():
            if attribute not in allowed:
                refuse(element, attribute, f"there is no such attribute{did_you_mean(quoted(attribute)[1:-1], allowed)}")
        left += [child for child in reversed(element.children) if child.tag not in CLOSED]
