"""Mechanisms in Exudyn: as kinematic trees, or as bodies that joints hold together."""

import exudyn

from bodycheck.adapters.contract import Method, Simulation
from bodycheck.adapters.exudyn import formulations, jointed_bodies, kinematic_trees, stepping
from bodycheck.adapters.exudyn.formulations import FORMULATIONS
from bodycheck.adapters.stepping import Normalised
from bodycheck.reference.mechanisms.mechanism import Mechanism

#: What Exudyn models of mechanisms; see `Engine.models`.
MODELS = frozenset(
    {
        "mechanisms",
        "revolute joints",
        "ball joints",
        "free joints",
        "prismatic joints",
        "fixed joints",
        "planar joints",
        "universal joints",
        "armature",
        "joint damping",
        "joint springs",
        "joint friction",
        "joint efforts",
        "loops",
        "point masses",
    }
)


def prepare(mechanism: Mechanism, method: Method) -> Simulation:
    """Return the simulation of a mechanism: as a tree, where it is one of joints that trees have, or else as jointed bodies.

    Raises `SceneUnsupported`.
    """
    container = exudyn.SystemContainer()
    system = container.AddSystem()
    redundant = bool(mechanism.loops)
    if kinematic_trees.fits(mechanism):
        seen, rows = kinematic_trees.add(system, mechanism, method.timestep)
        return stepping.initialised(container, system, method, seen, rows, redundant)
    formulation = formulations.of_method(method)
    seen, rows = jointed_bodies.add(system, mechanism, formulation)
    made = stepping.initialised(container, system, method, seen, rows, redundant)
    return Normalised(made) if formulation is FORMULATIONS["EP"] else made
