"""The mechanics of robot models, which are links on joints as a URDF or MJCF file describes them.

- `model`: the links, joints and gravity of a robot model, as read from the file, in the 80-bit type; the order of its joints
  from the root on, and copies of a model with other numbers in one link or joint.
- `state`: positions, velocities, accelerations and efforts of the joints of a robot model.
- `states`: pseudo-random states from a seed.
- `terms`: the terms that an engine and the reference compute at a state: poses, Jacobians, mass matrix, forces, accelerations.
- `dynamics`: the reference's terms, with `motion` of the links and `rotations`.
- `fusing`: joins links that are welded together into one link.
- `physical`: finds the values of a model that are physically impossible.
"""
