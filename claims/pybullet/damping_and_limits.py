"""PyBullet's multibody: damping of 0.04 (1 + u) of a velocity u, limits of 100 m/s and 100 rad/s; none of them in `maximal`."""

import pybullet as p

STEP = 0.001


def ran(velocity, spin, steps, maximal, **dynamics):
    """Return the velocities of a body along x after steps."""
    p.resetSimulation()
    p.setTimeStep(STEP)
    body = p.createMultiBody(1.0, p.createCollisionShape(p.GEOM_SPHERE, radius=1), useMaximalCoordinates=maximal)
    if dynamics:
        p.changeDynamics(body, -1, **dynamics)
    p.resetBaseVelocity(body, (velocity, 0, 0), (spin, 0, 0))
    for _ in range(steps):
        p.stepSimulation()
    moving, turning = p.getBaseVelocity(body)
    return moving[0], turning[0]


p.connect(p.DIRECT)
for name, speed in (("one", 1.0), ("two", 2.0)):
    moving, turning = ran(speed, speed, 1, False)
    print(f"rate_{name}", (speed - moving) / speed / STEP)
    print(f"turning_rate_{name}", (speed - turning) / speed / STEP)
for name, maximal in (("multibody", False), ("maximal", True)):
    for part, speed in zip(("speed", "spin"), ran(300.0, 300.0, 1, maximal, linearDamping=0, angularDamping=0), strict=True):
        print(f"{name}_{part}", speed)
print("switched_off_speed", ran(300.0, 0.0, 1, False, linearDamping=0, angularDamping=0, maxJointVelocity=1e9)[0])
