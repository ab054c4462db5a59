"""Tools of the book's chapter that no truth needs; docs/chapter.md lists the equation, figure or exercise that each belongs to.

- `orientation`: rotation matrices, chains of rotations, the angles and the single rotation of a matrix.
- `placing`: orientation of a body with one axis along a given direction; the axes of a wheel.
- `rotation_vector`: angular velocity in both frames from Euler angles and their rates, and the matrices of these relations.
- `particles`: three particles at fixed distances, and their six coordinates.
- `wobble`: the wobble that a stable spin tolerates.

`particles` imports `placing`; otherwise the modules do not import one another. Nothing else in the package imports them.
"""
