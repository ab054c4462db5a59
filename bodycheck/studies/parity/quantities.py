"""The quantities that are compared, and the words for the results and causes."""

from typing import Literal, get_args

Quantity = Literal[
    "total_mass", "mass", "center_of_mass", "inertia",
    "armature", "damping", "friction", "stiffness", "effort_limit",
    "joint_type", "axis", "parent", "order", "gravity",
    "pose", "jacobian", "mass_matrix", "gravity_force", "coriolis_force", "passive_force", "forward_dynamics",
    "inverse_dynamics",
]  # fmt: skip

#: The result of a comparison. "accepted-unphysical" means that an engine has accepted values that no body can have.
#: "crashed", "timeout" and "adapter-fault" mean that there is no answer of the engine: its process died or ran out of memory,
#: its time was up, or its adapter is at fault. "unreadable" is said of a file that is not there or is no robot's file.
Status = Literal[
    "agrees", "differs", "refused", "accepted-unphysical", "not-modelled", "crashed", "timeout", "adapter-fault", "unreadable"
]

#: The statuses of which any ends the command with exit code 1.
FAILED: tuple[Status, ...] = ("unreadable", "crashed", "timeout", "adapter-fault", "refused", "differs")

#: The origin of an engine's value: what the engine computes or how it moves, or what its records of the model say. Empty in
#: rows without a value of the engine.
Source = Literal["behaviour", "told", ""]

#: The cause of a difference; empty if there is none. "base-welded" alone is no difference.
Cause = Literal[
    "armature", "inertia-turned", "inertia-dropped", "inertia-fused", "inertia-balanced", "mass", "center-of-mass",
    "damping-ignored", "friction-ignored", "mimic-ignored", "mimic-inverted", "limits-ignored", "frame", "coordinate-order",
    "representation", "base-welded", "unexplained", "",
]  # fmt: skip

QUANTITIES: tuple[Quantity, ...] = get_args(Quantity)
CAUSES: tuple[Cause, ...] = get_args(Cause)

#: Forces and accelerations that are compared at states: vectors with one number per velocity.
FORCES: tuple[Quantity, ...] = ("gravity_force", "coriolis_force", "passive_force", "forward_dynamics", "inverse_dynamics")

#: Everything that is compared at states.
TERMS: tuple[Quantity, ...] = ("pose", "jacobian", "mass_matrix", *FORCES)

#: The subject of a row about the whole model.
MODEL = "model"

#: The engine of a row about the file itself.
FILE = "file"

#: The meaning of each quantity, for readers.
MEANINGS: dict[Quantity, str] = {
    "total_mass": "mass of all bodies, kg",
    "mass": "mass of a body, kg",
    "center_of_mass": "centre of mass in the link's frame, m",
    "inertia": "inertia about the centre of mass along the link's axes: xx yy zz xy xz yz, kg m²",
    "armature": "inertia added to that of a coordinate, kg m² or kg",
    "damping": "viscous damping, N m s/rad or N s/m",
    "friction": "dry friction, N m or N",
    "stiffness": "stiffness of a joint's spring, N m/rad or N/m",
    "effort_limit": "largest effort of a joint, N m or N",
    "joint_type": "type of a joint, its limits and what it mimics; of the model: its number of velocities",
    "axis": "axis of a joint in its frame",
    "parent": "body that a body hangs on",
    "order": "order of the joints",
    "gravity": "gravity that the engine uses if the user sets none, m/s²",
    "pose": "positions and attitudes of all bodies",
    "jacobian": "Jacobians of all bodies",
    "mass_matrix": "mass matrix, relative to the roots of its diagonal",
    "gravity_force": "efforts that hold the robot still",
    "coriolis_force": "Coriolis and centrifugal forces",
    "passive_force": "forces of springs, damping and friction",
    "forward_dynamics": "accelerations under given efforts",
    "inverse_dynamics": "efforts for given accelerations",
}
