"""Pitfalls: frequent errors in articles about MAVLink and in implementations, one test each.

Packets are built by `raw_packets`, which shares no code with the code under test. The pitfalls of routing and
of the microservices have tests in their own folders. The Rust tests of `rust/core` cover some pitfalls too:
`scan_tests.rs` framing, `signing_tests.rs` signing, `sequence.rs` packet loss.
"""

from __future__ import annotations

import hashlib
import struct

import pytest

import mavstack
from mavstack.dialects import Dialect, common
from mavstack.errors import DialectError, EncodeError, FieldRangeError
from mavstack.security.timestamps import timestamp_at
from mavstack.wire import crc16

from . import raw_packets

HEARTBEAT = bytes([5, 0, 0, 0, 2, 3, 81, 4, 3])
HEARTBEAT_EXTRA = 50
UNKNOWN_ID = 0x7A1234
KEY = bytes(range(32))


def heartbeat(sequence=0, version=2, **header):
    make = raw_packets.version_2 if version == 2 else raw_packets.version_1
    return make(0, HEARTBEAT, HEARTBEAT_EXTRA, sequence=sequence, **header)


def parse(data, dialect=common):
    parser = mavstack.Parser(dialect)
    return parser.feed(data) + parser.flush(), parser.statistics


# contradictions between articles and the wire


def test_version_1_ids_above_255_raise():
    assert common.OpenDroneIdBasicId.definition.id > 255
    with pytest.raises(EncodeError, match="over 255 and needs MAVLink 2"):
        mavstack.encode(common.OpenDroneIdBasicId(), system=1, component=1, version=1)
    with pytest.raises(EncodeError):
        mavstack.Encoder(1, 1, version=1).encode(common.OpenDroneIdBasicId())
    assert mavstack.encode(common.Debug(ind=1), system=1, component=1, version=1)[5] == 254


def test_version_2_ids_are_three_bytes_little_endian_and_system_and_component_one_each():
    raw = mavstack.encode(common.OpenDroneIdBasicId(), system=250, component=251)
    assert raw[5:10] == bytes([250, 251]) + (12900).to_bytes(3, "little")
    packets, _ = parse(raw_packets.version_2(UNKNOWN_ID, b"x", 1, system=255, component=254))
    assert (packets[0].message_id, packets[0].system, packets[0].component) == (UNKNOWN_ID, 255, 254)
    for outside in ({"system": 256, "component": 1}, {"system": 1, "component": -1}):
        with pytest.raises(EncodeError, match=r"outside 0\.\.255"):
            mavstack.encode(common.Heartbeat(), **outside)


def test_version_1_header_is_magic_length_sequence_system_component_id():
    raw = mavstack.encode(common.Heartbeat(), system=7, component=8, sequence=9, version=1)
    assert list(raw[:6]) == [0xFE, 9, 9, 7, 8, 0]


def test_payloads_are_limited_to_255_bytes_in_both_versions(tmp_path):
    for length, is_valid in ((255, True), (256, False)):
        fields = f'<field type="uint8_t[{length - 1}]" name="a"/><field type="uint8_t" name="b"/>'
        path = tmp_path / f"of_{length}.xml"
        path.write_text(
            f'<mavlink><messages><message id="200" name="BIG">{fields}</message></messages></mavlink>'
        )
        if not is_valid:
            with pytest.raises(DialectError):
                mavstack.Dialect.from_xml(path)
            continue
        dialect = mavstack.Dialect.from_xml(path)
        for version in (1, 2):
            raw = mavstack.encode(dialect["BIG"](b=1), system=1, component=1, version=version)
            packets, _ = parse(raw, dialect)
            assert (raw[1], packets[0].message.b) == (255, 1)


def test_the_crc_is_mcrf4xx_over_length_to_payload_without_the_magic():
    assert crc16(b"123456789") == raw_packets.crc(b"123456789") == 0x6F91
    for version in (1, 2):
        ours = mavstack.encode(common.Heartbeat(2, 3, 81, 5, 4, 3), system=1, component=1, version=version)
        assert ours == heartbeat(version=version)
        assert ours[-2:] == raw_packets.crc(ours[1:-2] + bytes([HEARTBEAT_EXTRA])).to_bytes(2, "little")


def test_crc_extra_is_appended_and_not_xored():
    raw = heartbeat()
    xored = raw[:-2] + (raw_packets.crc(raw[1:-2]) ^ HEARTBEAT_EXTRA).to_bytes(2, "little")
    without = raw[:-2] + raw_packets.crc(raw[1:-2]).to_bytes(2, "little")
    for wrong in (xored, without):
        packets, statistics = parse(wrong)
        assert (packets, statistics.bad_checksum) == ([], 1)


def test_the_signature_is_sha256_over_key_packet_link_id_and_timestamp():
    signing = mavstack.Signing(KEY, 7, timestamp=1000)
    raw = mavstack.encode(common.Heartbeat(), system=1, component=1, signing=signing)
    link_and_time = bytes([7]) + (1001).to_bytes(6, "little")
    assert raw[-13:-6] == link_and_time
    assert raw[-6:] == hashlib.sha256(KEY + raw[:-6]).digest()[:6]
    # Signatures are not chained: the same packet differs only in its timestamp.
    again = mavstack.encode(common.Heartbeat(), system=1, component=1, signing=signing)
    assert again == raw_packets.signed(raw[:-13], KEY, 7, 1002)


def test_signing_timestamps_count_ten_microseconds_since_2015():
    signing = mavstack.Signing(KEY)
    raw = mavstack.encode(
        common.Heartbeat(), system=1, component=1, signing=signing, now=1_420_070_400.0 + 2.5
    )
    assert raw[-12:-6] == (250_000).to_bytes(6, "little")
    assert timestamp_at(1_420_070_402.5) == 250_000
    assert timestamp_at(0.0) == 0
    assert timestamp_at(1e12) == 2**48 - 1


def test_attitude_is_uint32_milliseconds_and_float32_radians():
    raw = mavstack.encode(common.Attitude(2**32 - 1, 1.5, -2.5, 3.5, 0.1, 0.2, 0.3), system=1, component=1)
    assert raw[10:-2] == struct.pack("<I6f", 2**32 - 1, 1.5, -2.5, 3.5, 0.1, 0.2, 0.3)
    with pytest.raises(FieldRangeError):
        common.Attitude(time_boot_ms=2**32)


def test_the_text_message_is_statustext_253():
    assert Dialect.load("common")[253].definition.name == "STATUSTEXT"
    assert "STATUS_TEXT" not in Dialect.load("common")


# framing


@pytest.mark.parametrize("version", [1, 2])
def test_a_false_magic_hides_no_packet(version):
    stream = b"\xfd\xc8" + b"".join(heartbeat(number, version) for number in range(10))
    parser = mavstack.Parser(common)
    assert [packet.sequence for packet in parser.feed(stream)] == list(range(10))
    assert parser.statistics.bad_bytes == 2


def test_after_a_bad_checksum_the_search_continues_one_byte_later():
    # The damaged packet claims a length of 40 bytes, which contains two valid packets.
    damaged = b"\xfe\x20\x00\x01\x01\x00"
    packets, statistics = parse(damaged + heartbeat(1) + heartbeat(2) + bytes(20))
    assert [packet.sequence for packet in packets] == [1, 2]
    assert statistics.bad_checksum == 1


def test_a_checksum_byte_equal_to_a_magic_starts_no_packet():
    found = 0
    for number in range(256):
        for mode in range(12):
            payload = bytes([mode]) + HEARTBEAT[1:]
            raw = raw_packets.version_2(0, payload, HEARTBEAT_EXTRA, sequence=number)
            if raw[-1] not in (0xFD, 0xFE):
                continue
            found += 1
            packets, statistics = parse(raw + raw)
            assert (len(packets), statistics.bad_bytes) == (2, 0)
    assert found


def test_packets_of_unknown_ids_are_returned_with_their_bytes():
    raw = raw_packets.version_2(UNKNOWN_ID, b"opaque", 77, sequence=3, compat=9)
    (packet,), statistics = parse(raw)
    assert packet.raw == raw
    assert packet.message is None
    assert packet.name is None
    assert (packet.payload, packet.sequence, packet.compat_flags) == (b"opaque", 3, 9)
    assert (statistics.packets, statistics.unknown) == (1, 1)
    assert (statistics.bad_checksum, statistics.bad_bytes) == (0, 0)
    assert "unknown" in repr(packet)


def test_packets_of_unknown_version_1_ids_are_returned():
    raw = raw_packets.version_1(255, b"opaque", 77)
    assert 255 not in Dialect.load("common")
    (packet,), statistics = parse(raw)
    assert (packet.raw, packet.message, statistics.unknown) == (raw, None, 1)


def test_unknown_incompatibility_flags_discard_the_packet():
    packets, statistics = parse(heartbeat(incompat=2) + heartbeat(5))
    assert [packet.sequence for packet in packets] == [5]
    assert statistics.bad_flags == 1


def test_unknown_compatibility_flags_are_ignored_and_kept():
    raw = heartbeat(compat=0xFF)
    (packet,), _ = parse(raw)
    assert (packet.raw, packet.compat_flags, packet.name) == (raw, 0xFF, "HEARTBEAT")


def test_a_packet_keeps_its_bytes():
    untrimmed = raw_packets.version_2(0, HEARTBEAT + bytes(5), HEARTBEAT_EXTRA, compat=1)
    longer = raw_packets.version_2(30, bytes(range(60)), 39)
    junk_behind_the_nul = raw_packets.version_1(253, b"\x01" + b"a\0junk".ljust(50, b"?"), 83)
    packets, _ = parse(untrimmed + longer + junk_behind_the_nul)
    assert [packet.raw for packet in packets] == [untrimmed, longer, junk_behind_the_nul]
    for packet in packets:
        repr(packet.message)
    assert [packet.raw for packet in packets] == [untrimmed, longer, junk_behind_the_nul]


def test_version_1_sends_the_exact_length_and_never_extensions():
    message = common.Statustext(severity=1, text="", id=9, chunk_seq=9)
    raw = mavstack.encode(message, system=1, component=1, version=1)
    assert (raw[1], len(raw)) == (51, 6 + 51 + 2)
    assert message.to_payload(1) == raw[6:-2]
    (packet,), _ = parse(raw)
    assert (packet.message.id, packet.message.chunk_seq) == (0, 0)


def test_version_1_packets_shorter_than_their_message_are_refused():
    packets, statistics = parse(raw_packets.version_1(0, HEARTBEAT[:5], HEARTBEAT_EXTRA))
    assert (packets, statistics.bad_length) == ([], 1)


def test_version_2_trims_trailing_zeros_but_keeps_the_first_byte():
    assert mavstack.encode(common.Attitude(), system=1, component=1)[1] == 1
    assert mavstack.encode(common.Attitude(time_boot_ms=256), system=1, component=1)[1] == 2
    assert common.Attitude().to_payload() == b"\0"
    assert common.Attitude().to_payload(1) == bytes(28)


@pytest.mark.parametrize("length", [0, 1, 5, 28, 40])
def test_trimmed_untrimmed_and_empty_payloads_are_accepted(length):
    payload = struct.pack("<I", 7)[:length].ljust(length, b"\0")
    (packet,), _ = parse(raw_packets.version_2(30, payload, 39))
    assert packet.payload == payload
    assert packet.message == common.Attitude(time_boot_ms=7 if length else 0)


def test_short_payloads_are_zero_filled_extensions_included():
    (packet,), _ = parse(raw_packets.version_2(253, b"\x03hi", 83))
    message = packet.message
    assert (message.severity, message.text, message.id, message.chunk_seq) == (3, "hi", 0, 0)


def test_payloads_longer_than_known_are_decoded_and_kept():
    payload = struct.pack("<I6f", 9, 1, 2, 3, 4, 5, 6) + b"newer extension"
    (packet,), _ = parse(raw_packets.version_2(30, payload, 39))
    assert packet.message == common.Attitude(9, 1, 2, 3, 4, 5, 6)
    assert packet.payload == payload


def test_fields_are_sorted_by_size_and_extensions_follow_unsorted(tmp_path):
    path = tmp_path / "order.xml"
    fields = (
        '<field type="uint8_t" name="a"/><field type="uint16_t[2]" name="b"/>'
        '<field type="uint8_t[3]" name="c"/>'
        '<field type="double" name="d"/><field type="uint16_t" name="e"/><extensions/>'
        '<field type="uint8_t" name="x"/><field type="uint32_t" name="y"/>'
    )
    path.write_text(
        f'<mavlink><messages><message id="9" name="ORDER">{fields}</message></messages></mavlink>'
    )
    dialect = mavstack.Dialect.from_xml(path)
    order = dialect["ORDER"](a=1, b=(2, 3), c=b"\4\5\6", d=7.0, e=8, x=9, y=10)
    assert order.to_payload() == struct.pack("<dHHHB3BBI", 7.0, 2, 3, 8, 1, 4, 5, 6, 9, 10).rstrip(b"\0")
    assert dialect["ORDER"].definition.base_length == 18


def test_crc_extra_uses_wire_order_array_lengths_and_no_extensions():
    words = b"HEARTBEAT uint32_t custom_mode uint8_t type uint8_t autopilot uint8_t base_mode "
    value = raw_packets.crc(words + b"uint8_t system_status uint8_t mavlink_version ")
    assert (value & 0xFF) ^ value >> 8 == HEARTBEAT_EXTRA == common.Heartbeat.definition.crc_extra
    # An array adds its length as a byte; fields after <extensions/> (id, chunk_seq) are excluded.
    value = raw_packets.crc(b"STATUSTEXT uint8_t severity char text \x32")
    assert (value & 0xFF) ^ value >> 8 == 83 == common.Statustext.definition.crc_extra


def test_bytes_after_the_nul_of_a_char_field_are_ignored():
    assert common.ParamValue(param_id="SIXTEEN_LETTERS_").param_id == "SIXTEEN_LETTERS_"
    with pytest.raises(FieldRangeError, match="16 bytes"):
        common.ParamValue(param_id="SEVENTEEN_LETTERS")
    junk = raw_packets.version_1(253, b"\x01" + b"text\0JUNK".ljust(50, b"!"), 83)
    (packet,), _ = parse(junk)
    assert packet.message.text == "text"
    assert packet.message == common.Statustext(severity=1, text="text")


def test_utf8_truncated_inside_a_character_is_read():
    cut = ("x" * 49 + "é").encode()[:50]
    (packet,), _ = parse(raw_packets.version_1(253, b"\x01" + cut, 83))
    assert packet.message.text == "x" * 49
    assert packet.message.to_payload()[1:] == cut


def test_a_text_truncated_inside_a_character_can_be_written_again():
    (packet,), _ = parse(raw_packets.version_1(253, b"\x01" + ("x" * 49 + "é").encode()[:50], 83))
    message = packet.message
    assert common.Statustext.from_json(message.to_json()).severity == 1
    assert message.replace(text=message.text).severity == 1


def test_a_count_larger_than_its_array_reads_only_the_array():
    message = common.GpsRtcmData(len=255, data=b"x" * 180)
    (packet,), _ = parse(mavstack.encode(message, system=1, component=1))
    assert (packet.message.len, len(packet.message.data[: packet.message.len])) == (255, 180)


def test_sequence_numbers_count_per_link_and_source():
    vehicle, camera = mavstack.Encoder(1, 1), mavstack.Encoder(1, 100)
    for number in range(300):
        assert vehicle.encode(common.Heartbeat())[4] == number % 256
    assert camera.encode(common.Heartbeat())[4] == 0
    assert mavstack.Encoder(1, 1).encode(common.Heartbeat())[4] == 0, "each link has its own sequence numbers"
    with pytest.raises(EncodeError):
        mavstack.Encoder(1, 1, version=1).encode(common.OpenDroneIdBasicId())
    assert vehicle.sequence == 300 % 256


def test_a_failed_encoding_uses_no_sequence_number():
    encoder = mavstack.Encoder(1, 1, version=1)
    with pytest.raises(EncodeError):
        encoder.encode(common.OpenDroneIdBasicId())
    assert encoder.encode(common.Heartbeat())[2] == 0


def test_loss_is_counted_per_link_and_source():
    stream = b"".join(heartbeat(number) for number in (254, 255, 3, 4))
    stream += b"".join(heartbeat(number, component=100) for number in (0, 1, 2))
    one, other = mavstack.Parser(common), mavstack.Parser(common)
    one.feed(stream)
    other.feed(heartbeat(77))
    assert {key: (item.received, item.lost) for key, item in one.sources.items()} == {
        (1, 1): (4, 3),
        (1, 100): (3, 0),
    }
    assert one.sources[1, 1].loss == pytest.approx(3 / 7)
    assert other.sources[1, 1].lost == 0
