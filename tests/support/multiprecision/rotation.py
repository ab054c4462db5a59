"""Rotation of a rigid body without torque in closed form.

Along the principal axes 1, 2, 3 (ascending moments, right-handed, with L1 >= 0 and L3 >= 0 at t = 0), the angular momentum L
encircles the axis p: the axis of the largest moment where L^2 > 2 T I2, else that of the least; r is the other of these two.
With u = u0 + lambda t it is

    Lp = Mp dn u,  L2 = M2 sn u,  Lr = Mr cn u,

where Mp, M2, Mr follow from L^2 and 2 T, and lambda and k from Euler's equations dL/dt = L x Omega at u = 0 and u = K.
The world sees L at rest and the axis p at the longitude phi about it,

    dphi/dt = L (L2^2/I2 + Lr^2/Ir) / (L2^2 + Lr^2) = L/Ip + L (1/Ir - 1/Ip) / (1 + nu sn^2 u),   nu = (M2/Mr)^2 - 1,

whose integral is Legendre's third kind, taken as Carlson's R_J. The attitude is the rotation that takes L and the axis p to
where they are seen.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from tests.support.multiprecision.arithmetic import MP, Matrix, Real, Vector, columns, cross, dot, norm, unit, vector
from tests.support.multiprecision.attitudes import turned

#: A ratio below which a quantity that is zero in exact arithmetic is taken for zero, and one below which it must not be
#: otherwise, for then the digits would not do.
ZERO, SMALLEST = MP.mpf("1e-100"), MP.mpf("1e-40")


def rotation(inertia: Matrix, attitude: Matrix, rates: Vector, times: Sequence[float]) -> list[tuple[Matrix, Vector]]:
    """Attitudes (3, 3), body to world, and angular velocities (3, 1) in the body frame, rad/s, at times (s).

    Parameters
    ----------
    inertia
        Inertia tensor (3, 3), kg m^2, about the centre of mass along the axes of the body frame.
    attitude
        Rotation matrix at t = 0, body to world.
    rates
        Angular velocity at t = 0 in the body frame (rad/s).
    times
        Times in any order (s).
    """
    momentum = inertia * rates
    if not _is_zero(norm(cross(rates, momentum)), norm(rates) * norm(momentum)):
        moments, axes = _principal_axes(inertia, momentum)
        polhode = Polhode(moments, axes.T * momentum)
        start = attitude * axes * polhode.attitude(MP.zero).T
        found = []
        for t in map(MP.mpf, times):
            seen = polhode.momentum(t)
            turning = vector([each / moment for each, moment in zip(seen, moments, strict=True)])
            found.append((start * polhode.attitude(t) * axes.T, axes * turning))
        return found
    return [(attitude * turned(rates * MP.mpf(t)), rates) for t in times]


def _is_zero(size: Real, scale: Real) -> bool:
    """Whether a quantity is zero in exact arithmetic. Raises `ValueError` where the digits do not tell."""
    if ZERO * scale < size < SMALLEST * scale:
        raise ValueError(f"{MP.nstr(size / scale, 3)} is too small a ratio for {MP.dps} digits")
    return bool(size <= ZERO * scale)


def _principal_axes(inertia: Matrix, momentum: Vector) -> tuple[list[Real], Matrix]:
    """Principal moments, ascending, and right-handed principal axes as columns, with L1 >= 0 and L3 >= 0."""
    moments, axes = MP.eigsy(inertia)
    first, third = (axes[:, n] if dot(axes[:, n], momentum) >= 0 else -axes[:, n] for n in (0, 2))
    return list(moments), columns(first, cross(third, first), third)


@dataclass(frozen=True)
class Polhode:
    """The motion of a body that tumbles, seen along its principal axes and, in the world, about its angular momentum.

    Attributes
    ----------
    moments
        Principal moments I1 <= I2 <= I3 (kg m^2).
    start
        Angular momentum at t = 0 along these axes, the first and the third component >= 0 (kg m^2/s).
    """

    moments: list[Real]
    start: Vector

    @cached_property
    def size(self) -> Real:
        """|L|, kg m^2/s."""
        return norm(self.start)

    @cached_property
    def p(self) -> int:
        """Index of the axis that L encircles: 2 or 0."""
        i1, i2, i3 = self.moments
        l1, _, l3 = self.start
        return 2 if l3**2 * (i3 - i2) / i3 >= l1**2 * (i2 - i1) / i1 else 0

    @cached_property
    def amplitudes(self) -> list[Real]:
        """M1, M2, M3 (kg m^2/s)."""
        square = self.size**2
        energy = MP.fsum(each**2 / i for each, i in zip(self.start, self.moments, strict=True))  # 2 T
        p, r, i = self.p, 2 - self.p, self.moments
        found = [MP.zero] * 3
        found[p] = MP.sqrt(i[p] * (square - energy * i[r]) / (i[p] - i[r]))
        found[r] = MP.sqrt(i[r] * (square - energy * i[p]) / (i[r] - i[p]))
        found[1] = MP.sqrt(i[1] * (square - energy * i[p]) / (i[1] - i[p]))
        return found

    @cached_property
    def rate(self) -> Real:
        """lambda (rad/s)."""
        p, r, i = self.p, 2 - self.p, self.moments
        return self.amplitudes[p] * MP.sqrt((1 / i[p] - 1 / i[1]) * (1 / i[p] - 1 / i[r]))

    @cached_property
    def k(self) -> Real:
        """The modulus."""
        p, r, i = self.p, 2 - self.p, self.moments
        return MP.sqrt(self.amplitudes[1] * self.amplitudes[r] * abs(1 / i[1] - 1 / i[r]) / (self.rate * self.amplitudes[p]))

    @cached_property
    def kc(self) -> Real:
        """The complementary modulus; zero exactly on the separatrix."""
        square = (1 - self.k) * (1 + self.k)
        return MP.zero if _is_zero(abs(square), MP.one) else MP.sqrt(square)

    @cached_property
    def nu(self) -> Real:
        """The characteristic of the integral of the third kind, with the sign that makes it positive."""
        return (self.amplitudes[1] / self.amplitudes[2 - self.p]) ** 2 - 1

    @cached_property
    def means(self) -> tuple[list[Real], list[Real]]:
        """The arithmetic-geometric mean of 1 and k': the a_n and the c_n / a_n."""
        a, b, ratios, all_a = MP.one, self.kc, [self.k], [MP.one]
        while ratios[-1] > MP.eps:
            a, b, c = (a + b) / 2, MP.sqrt(a * b), (a - b) / 2
            all_a.append(a)
            ratios.append(c / a)
        return all_a, ratios

    @cached_property
    def quarter(self) -> Real:
        """The quarter period K; infinite on the separatrix."""
        return MP.pi / (2 * self.means[0][-1]) if self.kc else MP.inf

    @cached_property
    def u0(self) -> Real:
        """The argument at t = 0, in [-K, K]."""
        sn, cn, dn = (self.start[n] / self.amplitudes[n] for n in (1, 2 - self.p, self.p))
        return sn * MP.elliprf(cn**2, dn**2, 1) if self.kc else MP.asinh(sn / cn)

    @cached_property
    def third_kind_at_start(self) -> Real:
        """The integral of the third kind from 0 to u0."""
        return self._third_kind(self.u0)

    def momentum(self, t: Real) -> Vector:
        """The angular momentum along the principal axes at time t (s), kg m^2/s."""
        u, half_periods = self._reduced(self.u0 + self.rate * t)
        sn, cn, dn = self._jacobi(u)
        sign = -1 if half_periods % 2 else 1
        found = [self.amplitudes[1] * sign * sn] * 3
        found[self.p] = self.amplitudes[self.p] * dn
        found[2 - self.p] = self.amplitudes[2 - self.p] * sign * cn
        return vector(found)

    def attitude(self, t: Real) -> Matrix:
        """The rotation (3, 3) at time t (s) from the principal axes to axes at rest whose third one is along L."""
        i, r = self.moments, 2 - self.p
        integral = self._third_kind(self.u0 + self.rate * t) - self.third_kind_at_start
        phi = self.size * (t / i[self.p] + (1 / i[r] - 1 / i[self.p]) * integral / self.rate)
        along, axis = self.momentum(t) / self.size, MP.zeros(3, 1)
        axis[self.p] = MP.one
        across = unit(cross(along, axis))
        sideways = vector([-MP.sin(phi), MP.cos(phi), 0])
        up = vector([0, 0, 1])
        return columns(up, sideways, cross(up, sideways)) * columns(along, across, cross(along, across)).T

    def _reduced(self, u: Real) -> tuple[Real, int]:
        """An argument less the nearest number of half periods 2 K, and that number."""
        if not self.kc:
            return u, 0
        count = int(MP.nint(u / (2 * self.quarter)))
        return u - 2 * self.quarter * count, count

    def _jacobi(self, u: Real) -> tuple[Real, Real, Real]:
        """sn u, cn u and dn u for |u| <= K, from the amplitude by descending Landen transformations."""
        if not self.kc:
            return MP.tanh(u), MP.sech(u), MP.sech(u)
        a, ratios = self.means
        angle = 2 ** (len(a) - 1) * a[-1] * u
        for ratio in reversed(ratios[1:]):
            angle = (angle + MP.asin(ratio * MP.sin(angle))) / 2
        sn, cn = MP.sin(angle), MP.cos(angle)
        return sn, cn, MP.sqrt(self.kc**2 + (self.k * cn) ** 2)

    def _third_kind(self, u: Real) -> Real:
        """The integral of 1 / (1 + nu sn^2) from 0 to u."""
        if not self.kc:
            root = MP.sqrt(self.nu)
            return (u + root * MP.atan(root * MP.tanh(u))) / (1 + self.nu)
        part, half_periods = self._reduced(u)
        sn, cn, dn = self._jacobi(part)
        whole = 2 * half_periods * self._third_kind_of_quarter if half_periods else MP.zero
        return whole + part - self.nu / 3 * sn**3 * MP.elliprj(cn**2, dn**2, 1, 1 + self.nu * sn**2)

    @cached_property
    def _third_kind_of_quarter(self) -> Real:
        """The integral of the third kind from 0 to K."""
        return self.quarter - self.nu / 3 * MP.elliprj(0, self.kc**2, 1, 1 + self.nu)
