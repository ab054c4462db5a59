"""Convert values to columns of Arrow tables, and columns to arrays, without pandas.

PyArrow's own conversions import pandas if it is installed, which takes as long as all other imports of most commands.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray


def of_numbers(numbers: NDArray[np.float64]) -> Any:
    """Return a column with numbers (n,)."""
    import pyarrow as pa  # it is large, and only what writes and reads tables needs it

    values = np.ascontiguousarray(numbers, dtype=np.float64)
    return pa.Array.from_buffers(pa.float64(), len(values), [None, pa.py_buffer(values)])


def of_values(values: Sequence[Any], kind: Any) -> Any:
    """Return a column with values of a type: booleans, 64-bit integers, 64-bit floats or strings; None if missing."""
    import pyarrow as pa

    missing = np.array([value is None for value in values], dtype=bool)
    validity = pa.py_buffer(np.packbits(~missing, bitorder="little")) if missing.any() else None
    if kind == pa.string():
        texts = [b"" if value is None else value.encode("utf-8") for value in values]
        ends = np.cumsum([0, *map(len, texts)]).astype(np.int32)
        return pa.Array.from_buffers(kind, len(values), [validity, pa.py_buffer(ends), pa.py_buffer(b"".join(texts))])
    numbers = np.array([0 if value is None else value for value in values], dtype=kind.to_pandas_dtype())
    buffer = np.packbits(numbers, bitorder="little") if kind == pa.bool_() else numbers
    return pa.Array.from_buffers(kind, len(values), [validity, pa.py_buffer(buffer)])


def numbers_of(column: Any) -> NDArray[np.float64]:
    """Return the numbers (n,) of a column of 64-bit floats without missing values, as a read-only array."""
    parts = [
        np.frombuffer(chunk.buffers()[1], np.float64, len(chunk), chunk.offset * np.dtype(np.float64).itemsize)
        for chunk in column.chunks
        if len(chunk)
    ]
    return parts[0] if len(parts) == 1 else np.concatenate([np.empty(0), *parts])
