"""Rigid bodies of Exudyn with their weight."""

from typing import Any

import exudyn
from exudyn import itemInterface, utilities

from bodycheck.adapters.exudyn import formulations
from bodycheck.adapters.exudyn.formulations import Formulation
from bodycheck.adapters.links import Link, tensor
from bodycheck.reference.scene import State


def add(system: "exudyn.MainSystem", formulation: Formulation, link: Link, initial: State, gravity: float) -> Any:
    """Add to a system a link with its weight, whose frame is in a state, and return its number."""
    # Exudyn takes the tensor about the origin of the link; this is its own conversion.
    inertia = utilities.RigidBodyInertia(link.mass, tensor(link), link.center_of_mass, inertiaTensorAtCOM=True)
    body = system.AddObject(
        itemInterface.ObjectRigidBody(
            nodeNumber=system.AddNode(formulations.node(formulation, initial)),
            mass=inertia.Mass(),
            inertia=inertia.GetInertia6D(),
            centerOfMass=inertia.COM(),
        )
    )
    mass = system.AddMarker(itemInterface.MarkerBodyMass(bodyNumber=body))
    system.AddLoad(itemInterface.LoadMassProportional(markerNumber=mass, loadVector=[0.0, 0.0, -gravity]))
    return body
