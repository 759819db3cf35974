"""A line between an uploader and a bootloader, in virtual time, whose board may lose its power."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from mavstack.flashing.bootloader_client import flash, identify, reboot
from mavstack.flashing.conversation import Conversation

if TYPE_CHECKING:
    from mavstack.flashing.conversation import Steps, T
    from mavstack.flashing.firmware_file import FirmwareFile
    from mavstack.flashing.progress import ReportProgress
    from mavstack.flashing.simulated_bootloader import SimulatedBootloader
    from tests.flashing.second_bootloader import SecondBootloader


class Device(Protocol):
    def take(self, data: bytes, now: float) -> bytes: ...

    def wait(self, now: float) -> bytes: ...

    def cycle_power(self) -> None: ...


class Ours:
    def __init__(self, bootloader: SimulatedBootloader) -> None:
        self.bootloader = bootloader

    def take(self, data: bytes, now: float) -> bytes:
        self.bootloader.receive(data, now)
        return self.bootloader.output()

    def wait(self, now: float) -> bytes:
        self.bootloader.handle_timeout(now)
        return self.bootloader.output()

    def cycle_power(self) -> None:
        self.bootloader.power_cycle()


class Second:
    """The second bootloader, whose own timeout is a second too."""

    def __init__(self, bootloader: SecondBootloader) -> None:
        self.bootloader = bootloader
        self.heard = 0.0

    def take(self, data: bytes, now: float) -> bytes:
        self.wait(now)
        self.heard = now
        self.bootloader.take(data)
        return self.sent()

    def wait(self, now: float) -> bytes:
        if now >= self.heard + 1:
            self.bootloader.silence()
        return self.sent()

    def cycle_power(self) -> None:
        self.bootloader.switch_on()

    def sent(self) -> bytes:
        data = bytes(self.bootloader.sent)
        self.bootloader.sent.clear()
        return data


class Line:
    """Carries bytes; after `cut_after` bytes the board loses its power, and what is on the way is lost."""

    def __init__(self, device: Device, cut_after: int | None = None) -> None:
        self.device, self.cut_after = device, cut_after
        self.now, self.carried = 0.0, 0
        self.to_board = bytearray()

    def run(self, steps: Steps[T]) -> T:
        conversation = Conversation(steps, self.now)
        while not conversation.done:
            data = conversation.data_to_send()
            answer = self.carry(data) if data else b""
            if answer:
                conversation.receive(answer, self.now)
                continue
            due = conversation.next_timeout()
            assert due is not None
            step = min(due, self.now + 0.5)
            self.now = step
            if answer := self.device.wait(self.now):
                conversation.receive(answer, self.now)
            conversation.handle_timeout(self.now)
        return conversation.result()

    def carry(self, data: bytes) -> bytes:
        left = None if self.cut_after is None else self.cut_after - self.carried
        self.carried += len(data)
        self.to_board += data
        if left is not None and left < len(data):
            self.device.take(data[: max(left, 0)], self.now)
            self.device.cycle_power()
            self.cut_after = None
            return b""
        return self.device.take(data, self.now)

    def flash(self, firmware: FirmwareFile, report: ReportProgress | None = None) -> None:
        board = self.run(identify())
        self.run(flash(firmware, board) if report is None else flash(firmware, board, report))
        self.run(reboot())
