from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.errors import MessageTimeout
from mavstack.services.command import CommandServer
from mavstack.services.message_request import RequestMessage
from mavstack.services.version import (
    AutopilotVersion,
    FirmwareVersion,
    ProtocolVersion,
    RequestAutopilotVersion,
    RequestProtocolVersion,
    git_hash,
    provide_versions,
)
from tests.services.message_request.harness import RequestHarness
from tests.services.network import VEHICLE

VERSION = AutopilotVersion(
    capabilities=common.MavProtocolCapability.MAVLINK2 | common.MavProtocolCapability.FTP,
    flight=FirmwareVersion(4, 6, 1),
    operating_system=FirmwareVersion(11, 0, 0, 0),
    board_version=9,
    vendor_id=0x1209,
    product_id=0x5741,
    uid=0x1234,
    uid2=bytes(range(18)),
    flight_custom=b"3f7a91bc",
)


class VersionHarness(RequestHarness):
    def provide(self) -> None:
        provide_versions(self.messages, VERSION)


def test_both_versions_are_answered() -> None:
    harness = VersionHarness()
    assert harness.run(RequestAutopilotVersion()).result() == VERSION
    assert harness.run(RequestProtocolVersion()).result() == ProtocolVersion()


def test_request_message_comes_first() -> None:
    harness = VersionHarness()
    harness.run(RequestAutopilotVersion())
    assert harness.received_commands() == [common.MavCmd.REQUEST_MESSAGE]


def test_a_server_answers_the_older_commands_too() -> None:
    harness = VersionHarness()
    harness.commands.support(common.MavCmd.REQUEST_MESSAGE, lambda _: common.MavResult.UNSUPPORTED)
    assert harness.run(RequestAutopilotVersion()).result() == VERSION
    assert harness.run(RequestProtocolVersion()).error is None
    assert set(harness.received_commands()) == {512, 519, 520}


def test_no_client_there_is_a_typed_error() -> None:
    harness = RequestHarness(old=True)
    harness.vehicle.setup = None
    harness.vehicle.restart()
    assert isinstance(harness.run(RequestAutopilotVersion()).error, MessageTimeout)


def test_an_autopilot_without_any_way_denies() -> None:
    harness = RequestHarness(old=True)
    assert isinstance(harness.commands, CommandServer)
    assert harness.run(RequestProtocolVersion()).error.code == common.MavResult.UNSUPPORTED


@pytest.mark.parametrize(
    ("packed", "text"),
    [
        (0x040601FF, "4.6.1"),
        (0x010F0080, "1.15.0-beta"),
        (0x010F00C3, "1.15.0-rc"),
        (0x01000040, "1.0.0-alpha"),
        (0x01000007, "1.0.0-dev"),
    ],
)
def test_a_packed_version(packed: int, text: str) -> None:
    version = FirmwareVersion.unpack(packed)
    assert str(version) == text
    assert version.pack() == packed


@pytest.mark.parametrize(
    ("custom", "text"),
    [
        (b"3F7a91bc", "3f7a91bc"),  # ArduPilot: letters
        (b"3f7a91b\0", "3f7a91b"),
        (bytes.fromhex("8877665544332211"), "1122334455667788"),  # PX4: a number, least byte first
        (bytes(8), ""),
    ],
)
def test_a_git_hash_is_letters_or_a_number(custom: bytes, text: str) -> None:
    assert git_hash(custom) == text


def test_the_view() -> None:
    assert VERSION.can(common.MavProtocolCapability.FTP)
    assert not VERSION.can(common.MavProtocolCapability.FTP | common.MavProtocolCapability.MISSION_FENCE)
    assert VERSION.board == (0x1209, 0x5741, 9)
    assert VERSION.unique_id == bytes(range(18)).hex()
    assert AutopilotVersion(uid=0x1234).unique_id == "0000000000001234"
    assert AutopilotVersion().unique_id == ""
    assert VERSION.git_hash == "3f7a91bc"
    assert AutopilotVersion.read(VERSION.to_message()) == VERSION


def test_any_message_can_be_read() -> None:
    for filling in (b"", b"\xff" * 255, bytes(range(255))):
        AutopilotVersion.read(common.AutopilotVersion.from_payload(filling)).to_message()
        assert str(AutopilotVersion.read(common.AutopilotVersion.from_payload(filling)).flight)
        ProtocolVersion.read(common.ProtocolVersion.from_payload(filling)).to_message()


@pytest.mark.parametrize(
    ("protocol", "expected"),
    [
        (ProtocolVersion(), [1, 2]),
        (ProtocolVersion(200, 200, 200), [2]),
        (ProtocolVersion(100, 100, 100), [1]),
        (ProtocolVersion.read(common.ProtocolVersion(version=200, min_version=100)), [1, 2]),
    ],
)
def test_which_protocols_are_spoken(protocol: ProtocolVersion, expected: list[int]) -> None:
    assert [major for major in (1, 2, 3) if protocol.supports(major)] == expected


def test_a_camera_is_requested_like_an_autopilot() -> None:
    harness = VersionHarness()
    assert harness.client.target == VEHICLE
    assert harness.run(RequestMessage(common.AutopilotVersion)).result() == VERSION.to_message()


@pytest.mark.parametrize(
    ("custom", "identifier", "revision"),
    [
        (b"BTFL", "BTFL", ""),
        (b"INAV\0\0\0\0", "INAV", ""),
        (b"abcd\0\0\0\0", "", "abcd"),
        (b"3f7a91bc", "", "3f7a91bc"),
        (bytes(8), "", ""),
        (b"AB\xff\xff", "", "ffff4241"),
    ],
)
def test_the_identifier_of_a_firmware_that_speaks_msp(custom: bytes, identifier: str, revision: str) -> None:
    version = AutopilotVersion(flight_custom=custom)
    assert (version.identifier, version.git_hash) == (identifier, revision)
