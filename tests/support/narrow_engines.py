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

#: What the module of an engine of free bodies does that takes their motion from the reference. Its attitude is wrong where the
#: second component of the spin is within `{width}` rad/s of `{middle}` rad/s at the start.
FAULTY = """
from dataclasses import replace
import numpy as np
from bodycheck.reference.flight.flights import flights
from bodycheck.reference.kinematics import multiply
from bodycheck.reference.requirements import Requirements
from bodycheck.reference.scenes import vary

engine = RECORD = replace(RECORD, models=frozenset(Requirements.__dataclass_fields__), batch=1000)

class Bodies:
    def __init__(self, scenes, timestep):
        initial = [scene.initial for scene in scenes]
        names = ("position", "quaternion", "velocity", "angular_velocity")
        self.scenes = vary(scenes[0], {{name: np.array([getattr(one, name) for one in initial]) for name in names}})
        self.timestep = timestep

    def advance(self, strides):
        t = np.cumsum(strides) * self.timestep
        flown = flights(self.scenes, t).trajectory
        wrong = np.abs(self.scenes.angular_velocity[:, 1] - {middle}) <= {width}
        half = np.where(wrong[:, None], 0.5, 1e-7) * t / 2
        turned = np.stack([np.cos(half), np.sin(half), np.zeros_like(half), np.zeros_like(half)], axis=-1)
        quaternion = multiply(flown.quaternion, turned)
        parts = [flown.position, quaternion, flown.velocity, flown.angular_velocity]
        return np.concatenate(parts, axis=2)[:, :, None, :]

def prepare(scenes, method):
    return Bodies(scenes, method.timestep)
"""
