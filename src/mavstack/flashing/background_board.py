"""A simulated board with a bootloader, in a separate thread, for programs and tests without an event loop.

with BackgroundBoard("px4") as board:
my_uploader("firmware.px4", board.port)
assert board.has_firmware
"""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from mavstack.flashing.simulated_board import SimulatedBoard
from mavstack.flashing.simulated_bootloader import board_of
from mavstack.flashing.simulated_port import SimulatedPort
from mavstack.node.blocking_portal import BlockingPortal

if TYPE_CHECKING:
    from types import TracebackType
    from typing import Self


class BackgroundBoard:
    """A board on a pseudo terminal; a context manager. POSIX only.

    Args:
        firmware: The firmware of its autopilot, "px4" or "ardupilot".
        board_id: The number of the board; None: an FMUv5 for PX4, a CubeOrange for ArduPilot.
        has_firmware: Begin with the autopilot; False: in the bootloader, with an empty flash.

    Attributes:
        board: The board.
        port: The path of the terminal, which uploaders open like a serial port.
    """

    def __init__(
        self, firmware: str = "px4", *, board_id: int | None = None, has_firmware: bool = False
    ) -> None:
        self.board = SimulatedBoard(firmware, board_of(firmware, board_id), has_firmware=has_firmware)
        self.port = ""
        self._folder: TemporaryDirectory[str] | None = None
        self._portal: BlockingPortal | None = None
        self._running: SimulatedPort | None = None

    @property
    def has_firmware(self) -> bool:
        """True if the board has a complete firmware."""
        return self.board.bootloader.has_firmware

    async def _open(self, url: str) -> None:
        self._running = await SimulatedPort(self.board, url).__aenter__()

    def __enter__(self) -> Self:
        self._folder = TemporaryDirectory(prefix="mavstack-")
        self.port = str(Path(self._folder.name) / "ttyBL")
        self._portal = BlockingPortal()
        try:
            self._portal.wait(self._open(f"pty://{self.port}"))
        except BaseException:
            self.__exit__(None, None, None)
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        portal, self._portal = self._portal, None
        running, self._running = self._running, None
        if portal is not None:
            if running is not None:
                portal.wait(running.__aexit__(None, None, None))
            portal.close()
        if self._folder is not None:
            self._folder.cleanup()
