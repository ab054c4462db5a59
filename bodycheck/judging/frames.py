"""The rows of results as tables of PyArrow and of pandas, whose types do not depend on the values."""

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from bodycheck.errors import BadInput
from bodycheck.figures.columns import COLUMNS
from bodycheck.files import columns
from bodycheck.judging import judgement
from bodycheck.judging.judgement import Verdict

if TYPE_CHECKING:
    import pandas as pd
    import pyarrow as pa


def table(verdicts: Iterable[Verdict]) -> "pd.DataFrame":
    """Return a table with one row per run, in the columns and order of `judgement.records`.

    Raises `BadInput` if pandas is not installed.
    """
    import pyarrow as pa

    try:
        import pandas as pd  # it is large, and nothing else needs it
    except ModuleNotFoundError as error:
        raise BadInput("a data frame needs pandas: pip install 'bodycheck[frames]'") from error
    # Numbers with decimals have no nullable type, with which pandas prints small ones as 0.0.
    nullable = {pa.int64(): pd.Int64Dtype(), pa.bool_(): pd.BooleanDtype()}
    frame: pd.DataFrame = arrow(verdicts).to_pandas(types_mapper=nullable.get)
    return frame


def arrow(verdicts: Iterable[Verdict]) -> "pa.Table":
    """Return the rows of `judgement.records` as a table of PyArrow. The types of its columns do not depend on the values."""
    import pyarrow as pa  # it is large, and only results need it

    rows = judgement.records(verdicts)
    names = list(rows[0]) if rows else list(judgement.COLUMNS)
    types = {"boolean": pa.bool_(), "integer": pa.int64(), "number": pa.float64()}
    kinds = {name: types.get(COLUMNS[name].kind, pa.string()) for name in names}
    return pa.table({name: columns.of_values([_value(row.get(name)) for row in rows], kind) for name, kind in kinds.items()})


def _value(value: Any) -> Any:
    """Return a value for a table, in which NaN is a missing value."""
    return None if isinstance(value, float) and math.isnan(value) else value
