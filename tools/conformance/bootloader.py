"""Conversations with bootloaders of PX4 and ArduPilot, for clients in other languages: `bootloader.jsonl`."""

from __future__ import annotations

import json
import zlib
from base64 import b64encode
from dataclasses import dataclass, replace
from random import Random
from typing import TYPE_CHECKING, Any, Final

from mavstack.flashing.bootloader_client import flash, identify, reboot
from mavstack.flashing.conversation import Conversation
from mavstack.flashing.failures import FlashingError
from mavstack.flashing.firmware_file import FirmwareKind
from mavstack.flashing.firmware_reader import parse_firmware
from mavstack.flashing.json_container import make_container
from mavstack.flashing.simulated_bootloader import ARDUPILOT_BOARD, PX4_BOARD, SimulatedBootloader

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.flashing.board import Board
    from mavstack.flashing.conversation import Steps
    from mavstack.flashing.firmware_file import FirmwareFile

_SEED: Final = 32
_SIZE: Final = 1001
_SMALL: Final = replace(PX4_BOARD, flash_size=4096)
_CUBE: Final = replace(ARDUPILOT_BOARD, flash_size=4096, external_size=2048)


@dataclass(frozen=True, slots=True)
class _Case:
    """A board, and the file that is flashed."""

    name: str
    board: Board
    file: bytes
    is_broken: bool = False
    has_secure_boot: bool = False
    is_valid: bool = True


def bootloader_text() -> str:
    """Return the content of `bootloader.jsonl`."""
    return "".join(f"{json.dumps(_vector(case))}\n" for case in _cases())


def _file(
    board_id: int = 50,
    size: int = _SIZE,
    kind: FirmwareKind = FirmwareKind.PX4,
    *,
    external: bytes = b"",
    **fields: object,
) -> bytes:
    image = b"\x00\x10\x00\x20" + Random(_SEED).randbytes(size - 4)
    content = json.loads(make_container(image, board_id, kind, external=external, **fields))
    content |= {"image": _packed(image)} | ({"extf_image": _packed(external)} if external else {})
    return json.dumps(content).encode("ascii")


def _packed(image: bytes) -> str:
    """Return an image as in a file, but not compressed: libraries of zlib compress differently."""
    return b64encode(zlib.compress(image, 0)).decode("ascii")


def _cases() -> Iterator[_Case]:
    for revision in range(2, 7):
        yield _Case(f"flash/revision-{revision}", replace(_SMALL, bootloader=revision), _file())
    external = Random(_SEED).randbytes(700)
    yield _Case("flash/external", _CUBE, _file(140, kind=FirmwareKind.APJ, external=external))
    yield _Case("flash/signed", _SMALL, _file(image_signed=True), has_secure_boot=True)
    yield _Case("flash/signed-apj", _CUBE, _file(140, kind=FirmwareKind.APJ, signed_firmware=True))
    yield _Case("refused/signature", _SMALL, _file(image_signed=True), has_secure_boot=True, is_valid=False)
    yield _Case("refused/no-secure-boot", _SMALL, _file(image_signed=True))
    yield _Case("refused/verification", _SMALL, _file(), is_broken=True)
    yield _Case("refused/board", _SMALL, _file(9))
    yield _Case("refused/size", _SMALL, _file(size=5000))
    yield _Case("refused/size-of-the-file", _SMALL, _file(image_maxsize=500))
    yield _Case("refused/external", _SMALL, _file(external=external))
    yield _Case("refused/revision", replace(_SMALL, bootloader=7), _file())


def _vector(case: _Case) -> dict[str, Any]:
    firmware = parse_firmware(case.file)
    verify = (lambda _: case.is_valid) if case.has_secure_boot else None
    bootloader = SimulatedBootloader(case.board, verify)
    bootloader.internal.broken = case.is_broken
    steps: list[list[str]] = []
    error = _flash(bootloader, firmware, steps)
    return {
        "name": case.name,
        "file": b64encode(case.file).decode("ascii"),
        "board": case.board.board_id,
        "steps": steps,
        "error": error,
    }


def _flash(bootloader: SimulatedBootloader, firmware: FirmwareFile, steps: list[list[str]]) -> str | None:
    try:
        board = _run(identify(), bootloader, steps)
        _run(flash(firmware, board), bootloader, steps)
        _run(reboot(), bootloader, steps)
    except FlashingError as error:
        return str(error)
    return None


def _run(requests: Steps[Any], bootloader: SimulatedBootloader, steps: list[list[str]]) -> Any:  # noqa: ANN401
    conversation = Conversation(requests, now := 0.0)
    while not conversation.done:
        data = conversation.data_to_send()
        bootloader.receive(data, now)
        answer = bootloader.output()
        steps.append([data.hex(), answer.hex()])
        if answer:
            conversation.receive(answer, now)
        else:
            now = conversation.next_timeout() or now
            conversation.handle_timeout(now)
    return conversation.result()
