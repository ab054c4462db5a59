"""Drive the joints of a MuJoCo model by efforts: held ones in `qfrc_applied`, and laws in `mjcb_passive`.

MuJoCo calls the callback at each evaluation of the accelerations, in `RK4` at each of the four stages, with the time and the
state of the stage in its data.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import mujoco

from bodycheck.adapters.contract import Law
from bodycheck.adapters.stepping import TakingLaws
from bodycheck.reference.trajectory import Array

if TYPE_CHECKING:
    from bodycheck.adapters.mujoco.stepping import Stepper


class Actuated:
    """The driven joints of a model, each a hinge or a slide, in data that is stepped.

    Parameters
    ----------
    model, data
        MuJoCo's model and its data, which hold the constant efforts.
    names
        The names of the joints.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, names: Sequence[str]) -> None:
        joints = [model.joint(name).id for name in names]
        self.data, self.in_q, self.in_v = data, model.jnt_qposadr[joints], model.jnt_dofadr[joints]
        self.constant = data.qfrc_applied[self.in_v]

    def state(self) -> tuple[Array, Array]:
        """Return the coordinates and velocities (j,) of the joints."""
        return self.data.qpos[self.in_q], self.data.qvel[self.in_v]

    def apply(self, efforts: Array) -> None:
        """Exert efforts (j,) from now on, in addition to the constant ones."""
        self.data.qfrc_applied[self.in_v] = self.constant + efforts

    def follow(self, law: Law) -> None:
        """Keep the law that `force` evaluates."""
        self.law = law

    def force(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        """Add the efforts of the law to the passive forces, as a callback of MuJoCo."""
        data.qfrc_passive[self.in_v] += self.law(data.time, data.qpos[self.in_q], data.qvel[self.in_v])


def driven(stepper: "Stepper", names: Sequence[str]) -> TakingLaws:
    """Return the simulation of a mechanism whose joints with these names are driven."""
    joints = Actuated(stepper.model, stepper.data, names)

    def follow(law: Law) -> None:
        joints.follow(law)
        stepper.force = joints.force

    return TakingLaws(stepper, joints.state, joints.apply, follow)
