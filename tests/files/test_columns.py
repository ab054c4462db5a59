"""Columns hold the values that PyArrow's own conversion gives, and their making imports no pandas."""

import subprocess
import sys
from typing import Any

import numpy as np
import pyarrow as pa
import pytest

from bodycheck.files import columns

VALUES = {
    "string": (pa.string(), ["a", None, "ä€😀", "", "b"]),
    "boolean": (pa.bool_(), [True, None, False, True] * 5),
    "integer": (pa.int64(), [1, None, -(2**60)]),
    "number": (pa.float64(), [None, 1.5, float("inf"), -0.0]),
}


@pytest.mark.parametrize("kind", VALUES)
@pytest.mark.parametrize("part", [slice(None), slice(0, 0), slice(0, 1), slice(1, 2)])
def test_columns_hold_the_values(kind: str, part: slice) -> None:
    type_, values = VALUES[kind]
    made = columns.of_values(values[part], type_)
    made.validate(full=True)
    assert made.equals(pa.array(values[part], type_))


def test_numbers_return_as_they_were() -> None:
    numbers = np.arange(12.0).reshape(6, 2)[:, 1]  # not contiguous
    made = columns.of_numbers(numbers)
    made.validate(full=True)
    for chunks in ([made], [made.slice(2)], [made[:1], made[1:1], made[1:]], []):
        column: Any = pa.chunked_array(chunks, pa.float64())
        assert columns.numbers_of(column).tolist() == column.to_pylist()


def test_pandas_is_not_imported() -> None:
    """It may be installed; a command that needs no data frame does not wait for it."""
    script = (
        "import sys, numpy, pyarrow as pa\n"
        "from bodycheck.files import columns\n"
        "made = pa.table({'a': columns.of_numbers(numpy.arange(3.0)), 'b': columns.of_values(['x', None, 'y'], pa.string())})\n"
        "columns.numbers_of(made['a'])\n"
        "sys.exit('pandas' in sys.modules)\n"
    )
    assert subprocess.run([sys.executable, "-c", script], check=False, env={"PYTHONPATH": ":".join(sys.path)}).returncode == 0
