"""The mechanics of robot models, which are links on joints as a URDF or MJCF file describes them.

- `model`: the links, joints and gravity of a robot model, as they were read, in the 80-bit type; the order of its joints from
  the root on, and the model with other numbers in one link or joint.
- `state`: positions, velocities, accelerations and efforts of the joints of a robot model.
- `states`: such states from a seed.
- `terms`: what an engine and the reference compute at a state: poses, Jacobians, mass matrix, forces, accelerations.
- `dynamics`: these terms by the reference, with `motion` of the links and `rotations`.
- `fusing`: links that are welded together as one link.
- `physical`: what of a model no bodies can have.
"""
