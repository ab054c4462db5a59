"""Print the largest attitude errors (rad) within 10 s of a brick spun about its intermediate axis, in Simbody by OpenSim."""

import numpy as np
import opensim


def attitudes(method, accuracy):
    """Return the quaternions every 10 ms, with steps of at most 10 ms; without an accuracy with steps of 0.5 ms."""
    model = opensim.Model()
    model.setGravity(opensim.Vec3(0.0, 0.0, -9.81))
    model.addBody(body := opensim.Body("brick", 1.0, opensim.Vec3(0), opensim.Inertia(0.13 / 3, 0.05 / 3, 0.1 / 3)))
    model.addJoint(opensim.FreeJoint("joint", model.getGround(), body))
    state = model.initSystem()
    state.updQ().set(0, np.pi / 2)
    for index, speed in enumerate((0.1, -10.0, 0.0, 1.0, 0.0, 2.0)):
        state.updU().set(index, speed)
    manager = opensim.Manager(model)
    manager.setIntegratorMethod(getattr(opensim.Manager, f"IntegratorMethod_{method}"))
    manager.setIntegratorAccuracy(accuracy) if accuracy else manager.setIntegratorFixedStepSize(5e-4)
    manager.setIntegratorMaximumStepSize(0.01 if accuracy else 5e-4)
    manager.initialize(state)
    turns = (body.getTransformInGround(manager.integrate(step * 0.01)).R() for step in range(1, 1001))
    return np.array([[q.get(i) for i in range(4)] for q in (turn.convertRotationToQuaternion() for turn in turns)])


opensim.Logger.setLevelString("Off")
exact = attitudes("RungeKuttaMerson", None)  # whose own error is some 1e-8 rad
for method, accuracy in (("RungeKuttaMerson", 1e-3), ("RungeKuttaMerson", 1e-8), ("CPodes", 1e-8), ("CPodes", 1e-10)):
    gaps = np.linalg.norm(attitudes(method, accuracy) - np.array([1, -1])[:, None, None] * exact, axis=2).min(axis=0)
    print(f"{method}_{-np.log10(accuracy):.0f}", 4 * np.arcsin(gaps.max() / 2))
