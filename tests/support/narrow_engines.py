"""An engine of free balls that is nearly exact but in narrow regions, where it is wrong, gives up, or ends its process."""

#: What the module of the engine does besides being an adapter, for `planted_engines.plant`. Many scenes are stepped at once.
NARROW = """
import os
from dataclasses import replace
import numpy as np
from bodycheck.adapters.contract import EngineDiverged
from bodycheck.reference.requirements import Requirements

engine = RECORD = replace(RECORD, models=frozenset(Requirements.__dataclass_fields__), batch=100)

class Balls:
    def __init__(self, scenes):
        initial = [scene.initial for scene in scenes]
        for name in ("position", "quaternion", "velocity", "angular_velocity"):
            setattr(self, name, np.array([getattr(one, name) for one in initial]))
        self.fall = np.array([[0.0, 0.0, -scene.gravity] for scene in scenes])
        self.mass = np.array([scene.body.mass for scene in scenes])

    def advance(self, strides):
        t = (np.cumsum(strides) * self.timestep)[None, :, None]
        velocity = self.velocity[:, None] + self.fall[:, None] * t
        position = self.position[:, None] + self.velocity[:, None] * t + self.fall[:, None] * t**2 / 2
        spin = self.angular_velocity
        # Wrong where the second component of the spin is near 2 rad/s.
        wrong = np.abs(spin[:, 1] - 2.0) < 0.01
        position = position + np.where(wrong, 0.3, 1e-7)[:, None, None] * t * np.array([1.0, 0.0, 0.0])
        rate = np.linalg.norm(spin, axis=1)[:, None, None]
        half = rate * t / 2
        turned = np.concatenate([np.cos(half), np.sinc(half / np.pi) * t / 2 * spin[:, None]], axis=2)
        p, q = self.quaternion[:, None], turned
        quaternion = np.concatenate([
            p[..., :1] * q[..., :1] - (p[..., 1:] * q[..., 1:]).sum(axis=2, keepdims=True),
            p[..., :1] * q[..., 1:] + q[..., :1] * p[..., 1:] + np.cross(p[..., 1:], q[..., 1:]),
        ], axis=2)
        quaternion /= np.linalg.norm(quaternion, axis=2, keepdims=True)
        spins = np.broadcast_to(spin[:, None], position.shape)
        return np.concatenate([position, quaternion, velocity, spins], axis=2)[:, :, None, :]

def prepare(scenes, method):
    for scene in scenes:
        if scene.initial.velocity[0] > 0.99:
            raise RuntimeError("it fails")
        if scene.initial.velocity[2] > 0.99:
            os._exit(7)
        if scene.initial.velocity[1] > 0.99 and len(scenes) == 1:
            raise EngineDiverged("it gives up")
    made = Balls(scenes)
    made.timestep = method.timestep
    return made
"""
