"""The scenes by which methods are told apart: short, with a turn of two thirds of a radian in each step.

With so coarse a step, schemes differ by far more than rounding, also in single precision, and after a few steps rounding has
hardly grown. The numbers of the flights are exact in single precision. Gravity is strong, so that a change of the fall by a
hundred-thousandth is seen in the velocity, and weak compared with the rotation. No engine limits motions so slow.
"""

from dataclasses import dataclass

from bodycheck.adapters.contract import Kind, kind_of
from bodycheck.casefile.content import Case
from bodycheck.reference.scene import Body, Brick, Plane, Scene, State


@dataclass(frozen=True)
class Trial:
    """A scene by which methods are told apart, with its time step (s)."""

    case: Case
    timestep: float

    @property
    def kind(self) -> Kind:
        """The kind of the scene."""
        return kind_of(self.case.scene)


def _trial(name: str, scene: Scene, timestep: float, steps: int) -> Trial:
    return Trial(Case(name, name, "", (), scene, steps * timestep, steps + 1, (), (), ""), timestep)


#: The flights begin at the origin, where positions have all their digits.
_TUMBLING = State(velocity=(0.25, 0.125, 0.5), angular_velocity=(12.0, -9.0, 15.0))
_TURNED = State(quaternion=(0.5, 0.5, 0.5, 0.5), velocity=(0.25, 0.125, 0.5), angular_velocity=(-12.0, 15.0, 9.0))
_THROWN = State(quaternion=(0.5, 0.5, 0.5, 0.5), velocity=(8.0, 2.0, 4.0), angular_velocity=(-12.0, 15.0, 9.0))

#: A brick of 1 kg, which slides and spins on its largest face. Its moments are m (b^2 + c^2) / 3 and so on.
_BRICK = Brick((0.125, 0.25, 0.0625))
_LYING = Body(1.0, (0.06640625 / 3, 0.01953125 / 3, 0.078125 / 3), _BRICK)
_SLIDING = State(position=(0.0, 0.0, 0.0625), velocity=(1.5, 0.75, 0.0), angular_velocity=(0.0, 0.0, 8.0))

#: The scenes of all kinds. On the plane the step is finer, so that soft contacts are stable.
TRIALS = (
    _trial("tumbling", Scene(Body(1.0, (2.0, 2.5, 3.0)), _TUMBLING, gravity=64.0), 1 / 32, 8),
    _trial("tumbling-turned", Scene(Body(1.0, (3.0, 2.0, 2.5)), _TURNED, gravity=64.0), 1 / 32, 8),
    _trial("tumbling-drag", Scene(Body(1.0, (3.0, 2.0, 2.5)), _THROWN, gravity=8.0, drag=0.125), 1 / 32, 8),
    _trial("sliding-and-spinning", Scene(_LYING, _SLIDING, gravity=9.8125, plane=Plane(friction=0.5)), 1 / 512, 32),
)
