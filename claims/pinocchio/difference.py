"""Print the error of Pinocchio's derivative of the difference of two configurations, for small turns of three joints."""

import numpy as np
import pinocchio as pin


def bracket(name, u):
    """Return the matrix of the Lie bracket with a velocity u, in the coordinates of a joint."""
    if name == "planar":
        return np.array([[0, -u[2], u[1]], [u[2], 0, -u[0]], [0, 0, 0]])
    turn = pin.skew(u[-3:])
    return turn if name == "spherical" else np.block([[turn, pin.skew(u[:3])], [np.zeros((3, 3)), turn]])


joints = {"free": pin.JointModelFreeFlyer(), "planar": pin.JointModelPlanar(), "spherical": pin.JointModelSpherical()}
for name, joint in joints.items():
    model = pin.Model()
    model.addJoint(0, joint, pin.SE3.Identity(), name)
    for turn in (1e-2, 1e-3, 1e-4, 1e-5):
        q, u = pin.neutral(model), np.full(model.nv, turn)
        derivative = pin.dDifference(model, q, pin.integrate(model, q, u), pin.ARG1)
        a = bracket(name, u)
        series = np.eye(model.nv) + a / 2 + a @ a / 12 - np.linalg.matrix_power(a, 4) / 720  # the next term is below 1e-16
        print(f"{name}_{-np.log10(turn):.0f}", np.abs(derivative - series).max())
