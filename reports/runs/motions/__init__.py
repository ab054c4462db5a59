"""The animation of a case: the truth and the runs at one time step, as `templates/player/` shows them side by side.

- `animation`: chooses the kind of pictures for a scene.
- `cast`: chooses the runs that are shown.
- `playback`: the common parts of all animations.
- `single_body`: a body in flight or sliding on a plane. `several_bodies`: bodies on joints, and bodies that touch.
- `stills`: small pictures of motions, without scripts.
- `tracks`: motions with few enough instants to be stored in a page.
"""
