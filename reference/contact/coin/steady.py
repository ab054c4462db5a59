"""A coin that rolls along a circle or a straight line, or turns on the spot, with a constant tilt: in closed form."""

import numpy as np

from bodycheck.reference.contact.coin import angles
from bodycheck.reference.contact.coin.start import Coin
from bodycheck.reference.contact.problem import NONE
from bodycheck.reference.trajectory import Array
from bodycheck.reference.witness import WideArray


def is_steady(coin: Coin) -> bool:
    """Return whether the tilt of a coin has no rate and no acceleration at its start, within the decimals of the file."""
    start = angles.initial(coin)[None]
    return bool(abs(start[0, angles.P]) <= NONE and abs(angles.accelerated(coin, start).p[0]) <= NONE)


def states(coin: Coin, times: Array) -> WideArray:
    """The states (n, 8) of a steady motion at times (n,), in units of the coin.

    The centre of mass has the velocity q h - s r along the line of nodes, which turns at the rate q / sin theta.
    """
    start = angles.initial(coin)
    t = times.astype(start.dtype)
    theta, q, s, phi, psi = (start[part] for part in (angles.THETA, angles.Q, angles.S, angles.PHI, angles.PSI))
    turning = q / np.sin(theta)
    half = turning * t / 2
    # The chord of the arc is a sine; if the line of nodes does not turn, it is the whole path.
    chord = (q * coin.half_length - s * coin.radius) * t * np.where(half, np.sin(half) / np.where(half, half, 1), 1)
    rows = np.tile(start, (len(t), 1))
    rows[:, angles.P] = 0
    rows[:, angles.PHI], rows[:, angles.PSI] = phi + turning * t, psi + (s - turning * np.cos(theta)) * t
    rows[:, angles.X] = rows[:, angles.X] + chord * np.cos(phi + half)
    rows[:, angles.Y] = rows[:, angles.Y] + chord * np.sin(phi + half)
    return rows
