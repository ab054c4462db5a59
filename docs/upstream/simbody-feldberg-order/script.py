"""Print the order of Simbody's RungeKuttaFeldberg and RungeKuttaMerson on a body that tumbles freely for 1 s, by OpenSim."""

import math

import numpy as np
import opensim

opensim.Logger.setLevelString("Off")


def attitude(integrator, step):
    """Return the angles and their rates after 1 s of steps of a fixed size."""
    model = opensim.Model()
    model.setGravity(opensim.Vec3(0))
    body = opensim.Body("body", 1.0, opensim.Vec3(0), opensim.Inertia(0.0433, 0.0166, 0.0333))
    model.addBody(body)
    model.addJoint(opensim.FreeJoint("joint", model.getGround(), body))
    state = model.initSystem()
    for index, speed in enumerate((0.5, 1.0, 5.0)):
        state.updU().set(index, speed)
    manager = opensim.Manager(model)
    manager.setIntegratorMethod(getattr(opensim.Manager, f"IntegratorMethod_{integrator}"))
    manager.setIntegratorFixedStepSize(step)
    manager.initialize(state)
    return manager.integrate(1.0).getY().to_numpy()


for name in ("RungeKuttaFeldberg", "RungeKuttaMerson"):
    coarse, middle, fine = (attitude(name, step) for step in (0.01, 0.005, 0.0025))
    print(f"{name}_order", math.log2(np.linalg.norm(coarse - middle) / np.linalg.norm(middle - fine)))
