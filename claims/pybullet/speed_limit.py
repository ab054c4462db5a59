"""Print the speed (m/s) of a ball that is thrown at 1000 m/s in PyBullet, a step later, with and without a higher limit."""

import pybullet

for name, limit in (("by_default", None), ("raised", 2000)):
    pybullet.connect(pybullet.DIRECT)
    body = pybullet.createMultiBody(1.0, pybullet.createCollisionShape(pybullet.GEOM_SPHERE, radius=0.1))
    pybullet.changeDynamics(body, -1, linearDamping=0, angularDamping=0)
    if limit is not None:
        pybullet.changeDynamics(body, -1, maxJointVelocity=limit)
    pybullet.resetBaseVelocity(body, [1000, 0, 0])
    pybullet.stepSimulation()
    print(name, pybullet.getBaseVelocity(body)[0][0])
    pybullet.disconnect()
