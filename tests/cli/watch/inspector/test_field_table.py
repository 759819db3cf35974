"""The fields of messages as rows."""

from __future__ import annotations

import pytest

from mavstack.cli.watch.inspector.field_table import COURSE_LENGTH, FieldName, field_rows, unit_suffix
from mavstack.cli.watch.inspector.packet_store import StoredPacket
from mavstack.dialects import Dialect, common
from mavstack.wire import Packet, encode
from tests.cli.watch.inspector.watched import ALL, HEARTBEAT, stream


def history(*messages, raw: bytes = b"") -> list[StoredPacket]:
    """Return packets of a stream, newest first."""
    packets = [encode(message, system=1, component=1) for message in messages] or [raw]
    entries = [StoredPacket(0, stream(), 0.0, Packet(data, ALL)) for data in packets]
    return entries[::-1]


def rows(*messages) -> dict[str, tuple[str, str]]:
    return {str(row.name): (row.text, row.raw) for row in field_rows(history(*messages))}


def test_values_with_units_and_raw_values():
    found = rows(common.GlobalPositionInt(lat=473977418, alt=488120, hdg=65535))
    assert found["lat"] == ("47.397742°", "473977418 degE7")
    assert found["alt"] == ("488.12 m", "488120 mm")
    assert found["hdg"] == ("–", "65535 cdeg")  # noqa: RUF001 (a dash)


def test_enums_have_names_and_numbers():
    found = rows(HEARTBEAT)
    assert found["type"] == ("QUADROTOR", "2")
    modes, number = found["base_mode"]
    assert (set(modes.split("|")), number) == ({"CUSTOM_MODE_ENABLED", "SAFETY_ARMED"}, "129")
    assert found["custom_mode"] == ("5", "")


def test_short_arrays_have_a_row_for_each_element():
    found = rows(common.BatteryStatus(voltages=[4100, 4090, *[65535] * 8]))
    assert found["voltages[1]"] == ("4.09 V", "4090 mV")
    assert found["voltages[9]"][0] == "–"  # noqa: RUF001 (a dash)
    assert "voltages" not in found
    assert "pose_covariance" in rows(common.Odometry())


def test_texts_have_one_row_and_no_course():
    (text,) = (
        row for row in field_rows(history(common.Statustext(text="hello"))) if row.name.field == "text"
    )
    assert (text.text, text.raw, text.is_number) == ("hello", "", False)


def test_changed_fields_and_their_course():
    messages = [common.Attitude(roll=index / 10, pitch=float("nan")) for index in range(COURSE_LENGTH + 5)]
    found = {row.name.field: row for row in field_rows(history(*messages))}
    assert (found["roll"].changed, found["yaw"].changed, found["pitch"].changed) == (True, False, False)
    assert len(found["roll"].course) == COURSE_LENGTH
    assert found["roll"].course[-1] == pytest.approx(160.4, abs=0.1)
    assert set(found["pitch"].course) == {None}


def test_secrets_are_hidden():
    found = rows(common.SetupSigning(secret_key=bytes(range(32)), initial_timestamp=99))
    assert found["secret_key"] == found["initial_timestamp"] == ("(hidden)", "")


def test_an_unknown_message_is_shown_as_bytes():
    raw = encode(common.Attitude(), system=1, component=1)
    entry = StoredPacket(0, stream(), 0.0, Packet(raw, Dialect.load("minimal")))
    (row,) = field_rows([entry])
    assert (row.name, row.text) == (FieldName("raw"), raw.hex())
    assert field_rows([]) == []


def test_units():
    (entry,) = history(common.VfrHud())
    assert unit_suffix(entry.packet, FieldName("airspeed")) == " m/s"
    assert unit_suffix(entry.packet, FieldName("no_such")) == ""
