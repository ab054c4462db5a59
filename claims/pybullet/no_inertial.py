"""Print the mass (kg) and the moment (kg m²) that PyBullet gives to a link without <inertial>."""

from pathlib import Path

import pybullet

pybullet.connect(pybullet.DIRECT)
robot = pybullet.loadURDF(
    str(Path(__file__).parents[1] / "robots" / "massless.urdf"), useFixedBase=True, flags=pybullet.URDF_USE_INERTIA_FROM_FILE
)
mass, _, moments, *_ = pybullet.getDynamicsInfo(robot, 1)
print("\nmass", mass, "\nmoment", moments[0])
