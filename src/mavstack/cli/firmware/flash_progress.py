"""The progress of flashing: one line on a terminal, nothing in a pipe."""

from __future__ import annotations

from typing import TYPE_CHECKING, Self

from mavstack.cli.common.transfer_progress import TransferProgress

if TYPE_CHECKING:
    from types import TracebackType

    from mavstack.flashing import Phase


class FlashProgress:
    """Shows the present phase by a line of its transfer."""

    def __init__(self) -> None:
        self._phase: Phase | None = None
        self._shown: TransferProgress | None = None

    def __call__(self, phase: Phase, done: int, total: int) -> None:
        """Report the units done of a phase; a total of 0 is unknown."""
        if phase is not self._phase or self._shown is None:
            self._end()
            self._phase, self._shown = phase, TransferProgress(str(phase))
        self._shown(done, total)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._end()

    def _end(self) -> None:
        if self._shown is not None:
            self._shown.__exit__(None, None, None)
