"""Drag in MuJoCo Warp: a kernel added to its passive forces, so that every integrator evaluates it with all other forces."""

from typing import Any

import warp as wp


def add_drag(drag: float, velocities: wp.array2d[float], forces: wp.array2d[float]) -> None:
    """Add drag, with the coefficient `drag` (kg/m), to forces on coordinates whose first velocities are the body's (world).

    Warp compiles this function as a kernel. The first axis of both arrays is the axis of worlds.
    """
    world = wp.tid()
    velocity = wp.vec3(velocities[world, 0], velocities[world, 1], velocities[world, 2])
    force = -drag * wp.length(velocity) * velocity
    for axis in range(3):
        forces[world, axis] += force[axis]


drag_kernel = wp.kernel(add_drag)


def resist(model: Any, drag: float) -> None:
    """Add drag, with a coefficient (kg/m) that may be zero, to the passive forces of a model of MuJoCo Warp."""
    if drag:
        model.callback.passive = lambda model, data: wp.launch(
            drag_kernel, dim=data.nworld, inputs=[drag, data.qvel], outputs=[data.qfrc_passive]
        )
