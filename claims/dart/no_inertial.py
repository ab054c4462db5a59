"""Print the mass (kg) and the moment (kg m²) that DART gives to a link without <inertial>."""

from pathlib import Path

import dartpy as dart

try:
    loader = dart.io.DartLoader()
except AttributeError:
    loader = dart.utils.DartLoader()
link = loader.parseSkeleton(str(Path(__file__).parents[1] / "robots" / "massless.urdf")).getBodyNode("tip")
print("mass", link.getMass(), "\nmoment", link.getInertia().getMoment()[0][0])
