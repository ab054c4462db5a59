"""Print the largest attitude errors (rad) within 10 s of a brick spun about its intermediate axis, in Simbody by OpenSim."""

import numpy as np
import opensim

opensim.Logger.setLevelString("Off")
model = opensim.Model()
model.setGravity(opensim.Vec3(0.0, 0.0, -9.81))
model.addBody(body := opensim.Body("brick", 1.0, opensim.Vec3(0), opensim.Inertia(0.13 / 3, 0.05 / 3, 0.1 / 3)))
model.addJoint(opensim.FreeJoint("joint", model.getGround(), body))
start = model.initSystem()
start.updQ().set(0, np.pi / 2)
for index, speed in enumerate((0.1, -10.0, 0.0, 1.0, 0.0, 2.0)):
    start.updU().set(index, speed)
for method, accuracy in (("RungeKuttaMerson", 1e-3), ("RungeKuttaMerson", 1e-8), ("CPodes", 1e-8), ("CPodes", 1e-10)):
    run, exact, largest = opensim.Manager(model), opensim.Manager(model), 0.0  # the exact one is right to some 1e-8 rad
    run.setIntegratorMethod(getattr(opensim.Manager, f"IntegratorMethod_{method}"))
    for manager, tolerance, step in ((run, accuracy, 0.01), (exact, 1e-12, 5e-4)):
        manager.setIntegratorAccuracy(tolerance)
        manager.setIntegratorMaximumStepSize(step)
        manager.setRecordStatesTrajectory(manager is run)
        manager.initialize(start)
    run.integrate(10.0)
    states = run.getStatesTrajectory()
    for state in (states.get(index) for index in range(1, states.getSize())):
        pair = (model.realizePosition(s) or body.getTransformInGround(s).R() for s in (state, exact.integrate(state.getTime())))
        a, b = (np.array([q.get(i) for i in range(4)]) for q in (turn.convertRotationToQuaternion() for turn in pair))
        largest = max(largest, 4 * np.arcsin(min(np.linalg.norm(a - b), np.linalg.norm(a + b)) / 2))
    print(f"{method}_{-np.log10(accuracy):.0f}", largest)
