"""Recorded bytes of packets that carry a secret."""

from __future__ import annotations

import pytest

import mavstack
from mavstack.dialects import ardupilotmega, common, minimal
from mavstack.dialects.secrets import SECRET_FIELDS, SECRET_IDS
from mavstack.security import redact, strip_signature

SECRET = b"K" * 32
SETUP = common.SetupSigning(target_system=1, target_component=2, secret_key=SECRET, initial_timestamp=99)


def packet_of(message, dialect=common, **header):
    raw = mavstack.encode(message, **{"system": 255, "component": 190, "sequence": 5, **header})
    (packet,) = mavstack.Parser(dialect).feed(raw)
    return packet


def test_packets_without_secrets_are_unchanged():
    for packet in (packet_of(common.Heartbeat()), packet_of(common.Attitude(), minimal)):
        assert redact(packet) == packet.raw


# `minimal` lacks the message, which is redacted by its id.
@pytest.mark.parametrize("dialect", [common, ardupilotmega, minimal])
@pytest.mark.parametrize("signing", [None, mavstack.Signing(bytes(32))])
def test_a_key_is_blanked_for_any_dialect_and_signature(dialect, signing):
    packet = packet_of(SETUP, dialect, signing=signing)
    recorded = redact(packet)
    assert SECRET[:2] not in recorded
    (again,) = mavstack.Parser(common).feed(recorded)
    blanked = (
        common.SetupSigning() if dialect is minimal else SETUP.replace(secret_key=b"", initial_timestamp=0)
    )
    assert again.message == blanked
    assert (again.system, again.component, again.sequence, again.signed) == (255, 190, 5, False)
    assert packet.raw != recorded, "the packet itself is unchanged"


def test_an_id_of_another_message_in_a_custom_dialect_is_not_redacted(tmp_path):
    path = tmp_path / "mine.xml"
    path.write_text(
        '<mavlink><messages><message id="256" name="MINE"><field type="uint8_t[32]" name="a"/></message>'
        "</messages></mavlink>"
    )
    dialect = mavstack.Dialect.from_xml(path)
    packet = packet_of(dialect["MINE"](a=SECRET), dialect)
    assert redact(packet) == packet.raw


def test_only_secret_fields_are_blanked():
    packet = packet_of(common.WifiConfigAp(ssid="drone", password="hunter2secret"))
    (again,) = mavstack.Parser(common).feed(redact(packet))
    assert again.message == common.WifiConfigAp(ssid="drone")
    assert "hunter2secret" not in repr(packet.message)


def test_secret_fields_and_ids_match_the_definitions():
    dialect = mavstack.Dialect.load("all")
    definitions = [dialect[name].definition for name in SECRET_FIELDS]
    assert {definition.id for definition in definitions} == SECRET_IDS
    for definition in definitions:
        assert SECRET_FIELDS[definition.name] <= {field.name for field in definition.fields}


# `minimal` lacks the message, whose CRC_EXTRA follows from the CRC.
@pytest.mark.parametrize("dialect", [common, minimal])
@pytest.mark.parametrize("text", ["", "low battery", "x" * 50])
def test_a_signature_is_removed(dialect, text):
    message = common.Statustext(severity=2, text=text)
    packet = packet_of(message, dialect, signing=mavstack.Signing(bytes(32), link_id=3))
    assert packet.signed
    assert redact(packet) == strip_signature(packet) == packet_of(message).raw


def test_an_unsigned_packet_has_no_signature_to_remove():
    packet = packet_of(common.Heartbeat(), version=1)
    assert strip_signature(packet) == packet.raw
