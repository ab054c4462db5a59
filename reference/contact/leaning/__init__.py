"""A body that leans on an edge or, as a rod, on its rim, and falls.

- `rod`: open this first. It computes the motion until the contact slips or lifts off, or the next face lands.
- `lean`: recognises such a scene, and computes the forces at the contact and the onset of slipping.
"""
