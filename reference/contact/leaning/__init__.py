"""A body that leans on an edge or, as a rod, on its rim, and falls.

- `rod`: open this first. It gives the motion until the contact slips or the next face lands.
- `lean`: whether a scene is such a body, the forces at its contact, and where friction holds no longer.
"""
