"""Exact numbers, rounded to the floating-point types that a mechanism can be followed in."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference.exact.numbers import DIGITS, MP, Real, real, wide

#: An array of any floating-point type; the types of heyoka are not NumPy's own.
WideArray = NDArray[Any]


@dataclass(frozen=True)
class FloatType:
    """A floating-point type: NumPy's double precision or `longdouble`, or heyoka's `real128`, or its `real` with some bits."""

    dtype: Any = np.longdouble
    bits: int | None = None

    def number(self, value: Real) -> Any:
        """The number of this type that is nearest to an exact one or to a double."""
        value = real(value)
        if self.bits is not None:
            return self.dtype(MP.nstr(value, DIGITS), self.bits)
        if self.dtype is np.float64:
            return np.float64(float(value))
        if self.dtype is np.longdouble:
            return wide(value)
        return self.dtype(MP.nstr(value, DIGITS))

    def array(self, values: Iterable[Real]) -> WideArray:
        """Exact numbers or doubles as an array of this type."""
        return np.array([self.number(value) for value in values])
