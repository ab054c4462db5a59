"""The comparison of a truth with the judge: every error of a printed state in units of the bound beside it."""

import math
import traceback
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import bodycheck
from bodycheck.reference.errors import NotModelled, OutOfReach
from bodycheck.reference.mechanisms.coordinates import by_name
from tests.judge.numerals import Matrix, angle_between, exact, fifty_digits, matrix_of, minus, size

#: The state of a body, or what an event leaves of it, and its parts: position, velocity, attitude, angular velocity.
FIGURES = ("position", "velocity", "attitude", "angular_velocity")


#: Errors that may be the judge's own: it leaves out terms of 1e-35, and some thousand steps add up.
CERTAIN = 1e-28


@dataclass(frozen=True)
class Verdict:
    """What came of a scene.

    Attributes
    ----------
    seed
        The seed of the scene.
    kind
        Its kind.
    worst
        The largest error over its bound; 0 without a truth.
    broken
        The largest broken bounds, one line each; empty if all hold.
    refused
        Why there is no truth, or why the judge has no motion; empty otherwise.
    """

    seed: int
    kind: str
    worst: float
    broken: tuple[str, ...] = ()
    refused: str = ""

    def __str__(self) -> str:
        what = f"refused: {self.refused}" if self.refused else f"error / bound {self.worst:.3g}"
        return "\n    ".join((f"{self.seed} {self.kind}: {what}", *self.broken))


@dataclass(frozen=True)
class Claim:
    """A number that is claimed, as its error and the bound of it."""

    what: str
    error: float
    bound: float

    @property
    def ratio(self) -> float:
        """The error in units of the bound."""
        if self.error <= CERTAIN:
            return 0.0
        return self.error / self.bound if self.bound else math.inf

    def __str__(self) -> str:
        return f"{self.what}: error {self.error:.3g}, bound {self.bound:.3g}, ratio {self.ratio:.3g}"


def verdict(seed: int, kind: str, claims: Sequence[Claim]) -> Verdict:
    """Return the verdict on a scene with these claims."""
    ordered = sorted(claims, key=lambda claim: -claim.ratio)
    broken = tuple(str(claim) for claim in ordered[:4] if not claim.ratio <= 1)
    return Verdict(seed, kind, ordered[0].ratio if ordered else 0.0, broken)


def truth_of(text: str, folder: Path) -> Any:
    """Return the truth of a case, or the reason why it has none, as text."""
    path = folder / "judged.case.toml"
    path.write_text(text, "utf-8")
    case = bodycheck.load(path)
    try:
        return bodycheck.truth(case)
    except (NotModelled, OutOfReach) as error:
        return str(error)


def state_claims(truth: Any, body: int | None, expected: Mapping[int, Any], name: str = "") -> list[Claim]:
    """Return the claims of a truth on the states of a body at some of its instants, by their indices.

    body: its index in the trajectories of a mechanism; None for a single body.
    """
    trajectory = truth.trajectory if body is None else truth.trajectory.body(body)
    bounds = truth.bounds
    claims = []
    for index, state in expected.items():
        printed = {
            "position": size(minus(exact(trajectory.position[index].tolist()), state.position)),
            "velocity": size(minus(exact(trajectory.velocity[index].tolist()), state.velocity)),
            "attitude": angle_between(_turn(trajectory.quaternion[index].tolist()), state.turn),
            "angular_velocity": size(minus(exact(trajectory.angular_velocity[index].tolist()), state.spin)),
        }
        allowed = (bounds.position_error, bounds.velocity_error, bounds.error, bounds.angular_velocity_error)
        for figure, bound in zip(FIGURES, allowed, strict=True):
            what = f"{figure}{name} at t = {float(trajectory.t[index]):.17g}"
            claims.append(Claim(what, float(printed[figure]), float(bound[index])))
    return claims


def joint_claims(truth: Any, expected: Sequence[Any], lengths: float) -> list[Claim]:
    """Return the claims of a truth on the coordinates and velocities of joints.

    Twice the bounds of the bodies are allowed, since two of them make up a coordinate, and the rounding of the number itself.

    lengths: the sum of all lengths of the mechanism (m), by which errors of angles move points.
    """
    motion, bounds = by_name(truth.scene, truth.joints), truth.bounds
    claims = []
    for index, instant in enumerate(expected):
        turned, spun = float(bounds.error[index]), float(bounds.angular_velocity_error[index])
        for name, exactly in instant.joints.items():
            revolute = next(joint.type for joint in truth.scene.joints if joint.name == name) == "revolute"
            moved = turned if revolute else float(bounds.position_error[index]) + lengths * turned
            fast = spun if revolute else float(bounds.velocity_error[index]) + lengths * (turned + spun)
            for key, value, bound in zip(("position", "velocity"), exactly, (moved, fast), strict=True):
                printed = exact(float(motion[name][key][index]))
                allowed = 2 * bound + 2.3e-16 * abs(float(value))
                claims.append(Claim(f"{key} of joint {name} at instant {index}", float(abs(printed - value)), allowed))
    return claims


def judged(draw: Callable[[int, Path], Verdict], first: int, count: int, folder: Path) -> list[Verdict]:
    """Return the verdicts on so many scenes, from a seed on; each is printed when it is known."""
    verdicts = []
    for seed in range(first, first + count):
        with fifty_digits():
            try:
                verdicts.append(draw(seed, folder))
            except Exception:  # of the truth, which refuses a scene by exceptions of its own alone
                verdicts.append(Verdict(seed, "", 0.0, (traceback.format_exc(limit=-4),)))
        print(verdicts[-1], flush=True)
    print(summary(verdicts))
    return verdicts


def summary(verdicts: Sequence[Verdict]) -> str:
    """Return how many scenes had which verdict, and the worst error over its bound of those that hold."""
    refused = sum(bool(each.refused) for each in verdicts)
    broken = sum(bool(each.broken) for each in verdicts)
    worst = max((each.worst for each in verdicts if not each.broken), default=0.0)
    return f"{len(verdicts)} scenes, {refused} refused, {broken} broken, largest error over bound of the others {worst:.3g}"


def _turn(quaternion: Sequence[float]) -> Matrix:
    return matrix_of(exact(quaternion))
