"""A bar of iterations by tqdm."""

from __future__ import annotations

from collections.abc import Callable
from types import TracebackType
from typing import Any


class Bar:
    """Shows every iteration, and passes it on."""

    def __init__(self, name: str, callback: Callable[[dict[str, Any]], Any] | None) -> None:
        try:
            from tqdm.auto import tqdm
        except ImportError as error:
            raise ImportError("progress=True needs tqdm: pip install tqdm") from error
        self._bar = tqdm(desc=name, unit=" iterations")
        self._callback = callback

    def __call__(self, row: dict[str, Any]) -> Any:
        self._bar.set_postfix_str(f"objective {row['objective']:.6g}, optimality {row['optimality']:.1e}", refresh=False)
        self._bar.update()
        return self._callback(row) if self._callback else None

    def __enter__(self) -> Bar:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._bar.close()
