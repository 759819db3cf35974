"""The clocks in logs of packets: receive time, time since boot, and UTC of the vehicle."""

from __future__ import annotations

import numpy as np
import pytest

import mavstack
from mavstack.dialects import common
from mavstack.errors import LogError
from tests.logs.files import START, encoded, stamped

UTC_OF_BOOT = 1_600_000_000_000_000
MESSAGES = [
    message
    for second in range(10)
    for message in (
        common.Attitude(time_boot_ms=second * 1000),
        common.VfrHud(),
        common.SystemTime(time_boot_ms=second * 1000, time_unix_usec=UTC_OF_BOOT + second * 1_000_000),
    )
]


def open_packets(path, messages, *, timestamped=True):
    packets = encoded(messages)
    # Three packets a second; each second's arrive together.
    stamps = [START + number // 3 * 1_000_000 for number in range(len(packets))]
    path.write_bytes(
        b"".join(
            (stamp.to_bytes(8, "big") if timestamped else b"") + raw
            for stamp, raw in zip(stamps, packets, strict=True)
        )
    )
    return mavstack.open_log(path, "common", timestamped=timestamped)


def test_each_clock_of_a_tlog(tmp_path):
    log = open_packets(tmp_path / "flight", MESSAGES)
    assert (log.time_base.kind, log.time_base.offset_us, log.time_base.source) == (
        "received",
        UTC_OF_BOOT,
        "SYSTEM_TIME",
    )
    for name in ("ATTITUDE", "VFR_HUD"):  # which has no time of its own
        np.testing.assert_allclose(log.times(name) - START / 1e6, np.arange(10), atol=1e-5)
        np.testing.assert_allclose(log.times(name, "boot"), np.arange(10), atol=1e-5)
        np.testing.assert_allclose(log.times(name, "utc") - UTC_OF_BOOT / 1e6, np.arange(10), atol=1e-5)


def test_each_clock_of_a_raw_stream(tmp_path):
    log = open_packets(tmp_path / "flight", MESSAGES, timestamped=False)
    assert log.time_base.kind == "boot"
    assert log.start is None
    np.testing.assert_allclose(log.times("ATTITUDE"), np.arange(10))
    np.testing.assert_allclose(log.times("ATTITUDE", "utc") - UTC_OF_BOOT / 1e6, np.arange(10))
    with pytest.raises(LogError, match="the boot time of VFR_HUD is not known"):
        log.times("VFR_HUD")
    with pytest.raises(LogError, match="the received time of ATTITUDE is not known"):
        log.times("ATTITUDE", "received")


def test_without_system_time_utc_is_the_receive_time(tmp_path):
    log = open_packets(tmp_path / "flight", [*MESSAGES[:2], common.VfrHud()])
    assert log.time_base.source == "receive time"
    np.testing.assert_array_equal(log.times("ATTITUDE", "utc"), log.times("ATTITUDE"))


def test_a_time_usec_that_is_utc_is_no_time_since_boot(tmp_path):
    log = open_packets(tmp_path / "flight", [common.RawImu(time_usec=UTC_OF_BOOT)], timestamped=False)
    with pytest.raises(LogError, match="not known"):
        log.times("RAW_IMU", "boot")


def test_vehicles_have_clocks_of_their_own(tmp_path):
    path = tmp_path / "flight"
    path.write_bytes(
        b"".join(
            stamped(encoded([common.Attitude(time_boot_ms=boot)], system=system))
            for system, boot in ((1, 1000), (2, 9000))
        )
    )
    log = mavstack.open_log(path, timestamped=True)
    assert log.times("ATTITUDE", "boot").tolist() == [1, 9]
    assert log.select(system=2).time_base.offset_us == START - 9_000_000


def test_each_boot_has_a_clock_of_its_own(tmp_path):
    """A vehicle that reboots after 600 s: its second boot begins at 605 s, and is seen from 608 s on."""
    path = tmp_path / "flight"
    records = []
    for second in [*range(0, 600, 10), *range(608, 900, 10)]:
        boot_ms = second * 1000 if second < 600 else (second - 605) * 1000
        utc = UTC_OF_BOOT + second * 1_000_000
        messages = [common.VfrHud(), common.Attitude(time_boot_ms=boot_ms)]
        # The clock of a companion computer is another one.
        companion = encoded([common.SystemTime(time_boot_ms=7, time_unix_usec=utc)], component=191)
        if second % 50 < 10:
            messages.append(common.SystemTime(time_boot_ms=boot_ms, time_unix_usec=utc))
        records.append(stamped([*encoded(messages), *companion], START + second * 1_000_000, 0))
    path.write_bytes(b"".join(records))
    log = mavstack.open_log(path, "common")
    for name in ("VFR_HUD", "ATTITUDE"):
        received = log.times(name) - START / 1e6
        np.testing.assert_allclose(log.times(name, "utc") - UTC_OF_BOOT / 1e6, received, atol=1e-4)
        boot = np.where(received < 600, received, received - 605)
        np.testing.assert_allclose(log.times(name, "boot"), boot, atol=1e-4)
    assert log.time_base.offset_us == UTC_OF_BOOT, "of the longer boot"


def test_a_late_packet_is_no_reboot(tmp_path):
    path = tmp_path / "flight"
    boots = [0, 1, 2, 3, 0, 4, 5, 6]
    messages = [
        common.SystemTime(time_boot_ms=s * 1000, time_unix_usec=UTC_OF_BOOT + s * 10**6) for s in boots
    ]
    path.write_bytes(stamped(encoded([*messages, common.VfrHud()]), step=1_000_000))
    log = mavstack.open_log(path, "common")
    assert log.times("SYSTEM_TIME", "utc") - UTC_OF_BOOT / 1e6 == pytest.approx(boots)
