"""The largest possible amplification of an error by the motion of a free body, known before any integration."""

import numpy as np

from bodycheck.reference.exact.start import Start
from bodycheck.reference.flight.torque_free import half_period, polhode_of
from bodycheck.reference.trajectory import Array


def amplification(begin: Start, times: Array) -> Array:
    """Upper estimate of the attitude error (n,), rad, at times (n,) >= 0, s, per unit of relative error made at earlier times.

    The error is one of the rates relative to |Omega|, or of the inertia tensor relative to the largest moment. It causes an
    error of the angles proportional to the angle of turning times the ratio of the largest to the smallest moment. Near the
    separatrix it also changes E2 (see `torque_free`), which determines how long the body stays near the unstable axis: the
    phase of each half period changes by the error divided by k'^2, and the attitude near the unstable axis by at most the
    exponential growth of the error. For a spin about the axis of the middle moment, only the exponential growth applies.
    """
    moments = sorted(float(moment / max(begin.moments)) for moment in begin.moments)
    speed = float(np.sqrt(sum(float(rate) ** 2 for rate in begin.rates)))
    turning = speed * times
    if not speed:
        return np.ones(len(times))
    motion = polhode_of(begin)
    low, middle, high = moments
    exponent = 2 * np.sqrt(max(0.0, (middle - low) * (high - middle) / (low * high)))
    with np.errstate(over="ignore"):
        escaped = np.exp(exponent * turning)
        if motion is None:
            spins = {moment for moment, rate in zip(begin.moments, begin.rates, strict=True) if rate}
            unstable = len(spins) == 1 and min(begin.moments) < next(iter(spins)) < max(begin.moments)
            swings = escaped if unstable else np.ones(len(times))
        else:
            kc = float(motion.kc)
            passages = 1 + times / float(half_period(motion))
            swings = np.minimum(escaped, 1 + passages / kc**2) if kc else escaped
        return np.asarray((1 + turning) * swings / low)
