from __future__ import annotations

from mavstack.msp import FirmwareInfo


def test_names_and_versions() -> None:
    info = FirmwareInfo("BTFL", (25, 12, 1))
    assert (info.firmware, info.version_text, info.is_betaflight, info.is_inav) == (
        "Betaflight",
        "2025.12.1",
        True,
        False,
    )
    assert FirmwareInfo("BTFL", (4, 5, 1)).version_text == "4.5.1"
    assert FirmwareInfo("BTFL", (26, 12, 0), release="2026.12.0-alpha").version_text == "2026.12.0-alpha"
    inav = FirmwareInfo("INAV", (8, 0, 1))
    assert (inav.firmware, inav.version_text, inav.is_inav) == ("iNav", "8.0.1", True)
    assert FirmwareInfo("EMUF").firmware == "EMUF"
