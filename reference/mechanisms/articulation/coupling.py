"""The accelerations of the coordinates that several joints share, in any arithmetic.

A joint that follows another one, its leader, has a share of the coordinate of the leader. Of all accelerations that the joints
allow, the true ones minimise Gauss's constraint. The recursion minimises it over the accelerations of all joints that neither
follow nor lead, from the tips to the root. A quadratic function of the accelerations a of the leaders remains, namely
a^T H a / 2 + c^T a, in which H is their mass matrix while all other joints are loose, and -c are the forces on them: H a = -c.
"""

from collections.abc import Iterable, Mapping

from bodycheck.reference.mechanisms.articulation.spatial import Number


class Shared:
    """The quadratic function of the accelerations of leaders, which are given by the indices of their links."""

    def __init__(self, leaders: Iterable[int]) -> None:
        self._leaders = sorted(set(leaders))
        self._inertia: dict[tuple[int, int], Number] = {}
        self._load: dict[int, Number] = dict.fromkeys(self._leaders, 0)

    def hold(self, leader: int, share: Number, weight: Number, need: Number, responses: Mapping[int, Number]) -> None:
        """Add a joint that has a share of the coordinate of a leader.

        weight: its inertia along its coordinate. need: the force along it, without the force that its motion requires at rest.
        responses: the force along it for unit accelerations of leaders, so far.
        """
        for other, response in responses.items():
            self._add(leader, other, share * response * (2 if other == leader else 1))
        self._add(leader, leader, share * share * weight)
        self._load[leader] = self._load[leader] - share * need

    def release(self, inverse: Number, need: Number, responses: Mapping[int, Number]) -> None:
        """Add a joint that is alone. inverse: of its inertia; 0 if it is held. need, responses: as for `hold`."""
        for leader, response in responses.items():
            part = response * inverse
            self._load[leader] = self._load[leader] + part * need
            for other, one in responses.items():
                if other <= leader:
                    self._add(leader, other, -(part * one))

    def accelerations(self) -> tuple[dict[int, Number], dict[int, Number]]:
        """The accelerations of the leaders, and the pivots of H, by Gauss's elimination, as H is positive definite."""
        h, x = dict(self._inertia), {leader: -load for leader, load in self._load.items()}
        for n, k in enumerate(self._leaders):
            below = [i for i in self._leaders[n + 1 :] if (i, k) in h]
            for i in below:
                ratio = h[i, k] / h[k, k]
                for j in below:
                    if j <= i:
                        h[i, j] = h.get((i, j), 0) - ratio * h[j, k]
                x[i] = x[i] - ratio * x[k]
        for k in reversed(self._leaders):
            rest = x[k]
            for i in self._leaders:
                if i > k and (i, k) in h:
                    rest = rest - h[i, k] * x[i]
            x[k] = rest / h[k, k]
        return x, {k: h[k, k] for k in self._leaders}

    def _add(self, one: int, other: int, value: Number) -> None:
        pair = max(one, other), min(one, other)
        self._inertia[pair] = self._inertia.get(pair, 0) + value
