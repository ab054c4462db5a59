"""Print the largest differences in Pinocchio between one robot whose joints are added depth first, and not depth first."""

import numpy as np
import pinocchio as pin

TREE = {"a": ("universe", "RZ"), "b": ("a", "RY"), "c": ("a", "RX"), "d": ("b", "RX")}
NEAR, Q, V = pin.ProximalSettings(1e-12, 1e-10, 9), np.array([0.3, -0.4, 0.7, 0.2]), np.array([1, 2, -1, 0.5])
BODY, AT, ONE = pin.Inertia(1.0, np.full(3, 0.2), np.diag([0.1, 0.2, 0.25])), pin.SE3(np.eye(3), np.full(3, 0.25)), np.ones(4)


def results(order):
    """Return what `check` says, and what algorithms give with rows and columns in the order a, b, c, d."""
    model, place = pin.Model(), [order.index(name) for name in "abcd"]
    for name in order:
        joint = model.addJoint(model.getJointId(TREE[name][0]), getattr(pin, f"JointModel{TREE[name][1]}")(), AT, name)
        model.appendBodyToJoint(joint, BODY, pin.SE3.Identity())
    (q, v), data = (numbers[np.argsort(place)] for numbers in (Q, V)), [model.createData() for _ in range(5)]
    held = pin.RigidConstraintModel(pin.ContactType.CONTACT_3D, model, model.getJointId("d"), pin.SE3.Identity())
    loops = pin.StdVec_RigidConstraintModel([held]), pin.StdVec_RigidConstraintData([held.createData()])
    pin.initConstraintDynamics(model, data[0], *loops)
    upper = pin.crba(model, data[3], q)
    seen = {"crba": np.triu(upper) + np.triu(upper, 1).T, "aba": pin.aba(model, data[1], q, v, ONE)}
    seen["constraintDynamics"] = pin.constraintDynamics(model, data[0], q, v, ONE, *loops, NEAR)
    seen["computeCoriolisMatrix"] = pin.computeCoriolisMatrix(model, data[2], q, v)
    seen["computeABADerivatives"] = pin.computeABADerivatives(model, data[4], q, v, ONE)[0]
    return model.check(data[0]), {name: np.array(one)[np.ix_(*[place] * np.ndim(one))] for name, one in seen.items()}


(sound, right), (other, wrong) = results("abdc"), results("abcd")
print("check", sound, "\ncheck_other", other, *(f"\n{name} {np.abs(right[name] - wrong[name]).max()}" for name in right))
