"""Moments of solids against their defining integrals [G 2.29]."""

import numpy as np
import pytest

from bodycheck.reference.inertia import principal_moments, satisfies_triangle_inequality
from bodycheck.reference.scene import Brick, Cylinder, Ellipsoid, Shape, Sphere

INSIDE = {
    Brick((0.1, 0.3, 0.2)): lambda x, y, z: (abs(x) < 0.1) & (abs(y) < 0.3) & (abs(z) < 0.2),
    Ellipsoid((0.1, 0.3, 0.2)): lambda x, y, z: (x / 0.1) ** 2 + (y / 0.3) ** 2 + (z / 0.2) ** 2 < 1,
    Cylinder(0.2, 0.3): lambda x, y, z: (x * x + y * y < 0.04) & (abs(z) < 0.3),
    Sphere(0.3): lambda x, y, z: x * x + y * y + z * z < 0.09,
}


@pytest.mark.parametrize("shape", INSIDE, ids=lambda shape: type(shape).__name__)
def test_moments_are_the_sums_over_the_volume(shape: Shape) -> None:
    grid = (np.arange(180) + 0.5) / 180 * 0.6 - 0.3
    x, y, z = np.meshgrid(grid, grid, grid, indexing="ij")
    inside = INSIDE[shape](x, y, z)
    x, y, z = x[inside], y[inside], z[inside]
    summed = [np.mean(q) * 2.0 for q in (y * y + z * z, x * x + z * z, x * x + y * y)]
    # 90 cells a half-length: curved surfaces are off by parts in a thousand.
    np.testing.assert_allclose(principal_moments(shape, 2.0), summed, rtol=5e-3)


@pytest.mark.parametrize(
    ("moments", "exists"),
    [((1.0, 1.0, 2.0), True), ((1.0, 1.0, 2.0 * (1 + 1e-15)), True), ((1.0, 1.0, 2.001), False), ((3.0, 1.0, 1.0), False)],
)
def test_triangle_inequality(moments: tuple[float, float, float], exists: bool) -> None:
    assert satisfies_triangle_inequality(moments) is exists
