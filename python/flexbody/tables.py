"""Tables of pandas, where it is installed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


def frame(columns: Mapping[str, Any], index: tuple[str, Any] | None = None) -> Any:
    """A `pandas.DataFrame` of columns, with a named index if one is given."""
    try:
        import pandas
    except ImportError as error:
        raise ImportError("to_pandas needs pandas: pip install pandas") from error
    rows = None if index is None else pandas.Index(index[1], name=index[0])
    return pandas.DataFrame(dict(columns), index=rows)
