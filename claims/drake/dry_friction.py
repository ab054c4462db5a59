"""Print the names of what Drake's revolute joints have of damping and friction."""

from pydrake.multibody.tree import RevoluteJoint

names = [name for name in dir(RevoluteJoint) if name.startswith("default_") or "friction" in name.lower()]
print("friction", "yes" if any("friction" in name.lower() for name in names) else "none")
print("damping", "yes" if "default_damping" in names else "none")
