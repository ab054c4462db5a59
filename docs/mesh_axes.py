"""Print how far MuJoCo's inertia of a tetrahedral mesh is from the exact one. Run: python docs/mesh_axes.py

The script needs MuJoCo and NumPy alone. The tensor is compared in the axes of the body, relative to its largest entry, and the
principal moments are compared by themselves.
"""

import mujoco
import numpy as np

#: The corners (m), which are exact in single precision, and the density (kg/m^3).
CORNERS = np.array([[0, 0, 0], [4, 1, 0], [-1, 3, 1], [1, -1, 5]]) / 32
DENSITY = 1000.0

FILE = """
<mujoco>
  <asset><mesh name="tetrahedron" vertex="{}"/></asset>
  <worldbody><body><freejoint/><geom type="mesh" mesh="tetrahedron" density="{}"/></body></worldbody>
</mujoco>
"""


def exact() -> np.ndarray:
    """Return the inertia tensor of the tetrahedron about its centre of mass (kg m^2)."""
    mass = DENSITY * abs(np.linalg.det(CORNERS[1:] - CORNERS[0])) / 6
    around = CORNERS - CORNERS.mean(axis=0)
    spread = mass * around.T @ around / 20
    return np.trace(spread) * np.eye(3) - spread


def main() -> None:
    """Print the largest relative differences of principal moments and of the tensor."""
    model = mujoco.MjModel.from_xml_string(FILE.format(" ".join(map(str, CORNERS.ravel())), DENSITY))
    turn = np.zeros(9)
    mujoco.mju_quat2Mat(turn, model.body_iquat[1])
    axes, moments, true = turn.reshape(3, 3), model.body_inertia[1], exact()
    apart = np.abs(np.sort(moments) / np.linalg.eigvalsh(true) - 1).max()
    tensor = np.abs(axes @ np.diag(moments) @ axes.T - true).max() / true.max()
    print(f"MuJoCo {mujoco.__version__}: principal moments {apart:.1e}, tensor {tensor:.1e}")


if __name__ == "__main__":
    main()
