"""A sphere on a plane whose rolling and whose spin about the normal are resisted by friction.

- `motion`: open this first. It recognises such a sphere, and joins its legs.
- `laws`: the sphere, its velocities, and the limits of the forces and moments.
- `straight`: legs with constant accelerations, in closed form.
- `curved`: all other legs, integrated.
"""
