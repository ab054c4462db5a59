"""The animation of a case: the truth and the runs at one time step, as `templates/player/` shows them side by side.

- `animation`: chooses the pictures by the scene. `cast`: which runs are shown. `playback`: what all animations have in common.
- `single_body`: a body in flight, and one that slides. `several_bodies`: bodies on joints, and all bodies that touch.
- `tracks`: motions with few enough instants to be stored in a page.
"""
