"""The inputs of the corpus: every message with several values, and streams with damage and attacks.

A name is `<category>/<subject>`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import count
from random import Random
from typing import TYPE_CHECKING, Final

from tools.conformance.packets import (
    MAX_PAYLOAD,
    SIGNED,
    V1,
    V2,
    Sender,
    maximum,
    minimum,
    packet_v1,
    packet_v2,
    payload,
    random_values,
    signature,
    trimmed,
    zeros,
)

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.dialects.model import DialectDefinition, MessageDefinition

#: Defined by no dialect.
UNKNOWN_ID, UNKNOWN_ID_V1, UNKNOWN_EXTRA = 0xABCDEF, 0xEC, 123
KEY: Final = bytes(range(7, 39))
OTHER_KEY: Final = bytes(range(8, 40))
#: 2026-01-01 in units of 10 us since 2015-01-01.
NOW: Final = 34_719_840_000_000
MINUTE: Final = 6_000_000
_EXTENDED_BY: Final = 7
#: Input of the hash of a signature without key and payload, in bytes.
_HEADER_AND_CRC, _LINK_AND_TIMESTAMP = 12, 7
#: Lengths around the end of a block of SHA-256, and around 56 bytes, after which its padding takes another.
_HASHED_LENGTHS: Final = (*range(119, 124), 127, 128)


@dataclass(frozen=True)
class Case:
    """One input.

    Attributes:
        name: Category and subject.
        data: The bytes of the stream.
        key: The key of the receiver, or None.
        now: The receiver's time in units of 10 us since 2015-01-01, or None if unknown.
    """

    name: str
    data: bytes
    key: bytes | None = None
    now: int | None = None


class Cases:
    """The inputs for one dialect.

    Args:
        definition: All messages of the dialect.
        version: Its version, the value of HEARTBEAT.mavlink_version.
    """

    def __init__(self, definition: DialectDefinition, version: int) -> None:
        self._messages = sorted(definition.messages, key=lambda message: message.id)
        self._by_name = definition.messages_by_name
        self._version = version

    def all(self) -> Iterator[Case]:
        """Yield all inputs."""
        for message in self._messages:
            yield Case(f"message/{message.name}", b"".join(self._variants(message)))
        yield from self._texts()
        yield from self._headers()
        yield from self._corrupt()
        yield from self._unknown()
        yield from self._false_magics()
        yield from self._signatures()
        yield from self._cut_signatures()

    def _packet(self, name: str, sender: Sender | None = None, *, version: int = 2, seed: str = "") -> bytes:
        """Return a valid packet with random values that contains no magic after its first byte."""
        message = self._by_name[name]
        for attempt in count():
            data = payload(message, random_values(Random(f"{name} {seed} {attempt}")), version=self._version)
            packet = self._assembled(message, data, sender or Sender(), version)
            if not {V1, V2} & set(packet[1:]):
                return packet
        raise AssertionError

    def _assembled(self, message: MessageDefinition, data: bytes, sender: Sender, version: int) -> bytes:
        if version == 1:
            return packet_v1(message.id, message.crc_extra, data[: message.base_length], sender)
        return packet_v2(message.id, message.crc_extra, trimmed(data), sender)

    def _variants(self, message: MessageDefinition) -> Iterator[bytes]:
        """Yield packets of a message: limits, random values, MAVLink 1, any length."""
        random = Random(message.name)
        number, extra, length = message.id, message.crc_extra, message.length
        makers = (zeros, minimum, maximum, random_values(random))
        values = [payload(message, make, version=self._version) for make in makers]
        senders = (
            Sender(random.randrange(1, 256), random.randrange(1, 256), random.randrange(256)) for _ in count()
        )
        for data in dict.fromkeys(values):
            yield packet_v2(number, extra, trimmed(data), next(senders))
        data = values[-1]
        if number < 256:
            yield packet_v1(number, extra, data[: message.base_length], next(senders))
        cut = self._cut(message, data, random.randrange(length))
        yield packet_v2(number, extra, trimmed(cut), next(senders))
        yield packet_v2(number, extra, cut.ljust(length, b"\0"), next(senders))
        if length + _EXTENDED_BY <= MAX_PAYLOAD:
            yield packet_v2(number, extra, data + random.randbytes(_EXTENDED_BY - 1) + b"\1", next(senders))

    def _cut(self, message: MessageDefinition, data: bytes, length: int) -> bytes:
        """Return the beginning of a payload that still has its protocol version."""
        kept = next((item.offset + 1 for item in message.fields if item.protocol_version), 0)
        return data[: max(length, kept)]

    def _texts(self) -> Iterator[Case]:
        message = self._by_name["STATUSTEXT"]
        texts = {"empty": b"", "full": b"x" * 50, "utf8": "Höhe 10 m, 高度, 🚁".encode(), "one": b"!"}
        for name, text in texts.items():
            data = (b"\6" + text).ljust(message.length, b"\0")
            versions = (self._assembled(message, data, Sender(1, 2, 3), version) for version in (1, 2))
            yield Case(f"text/{name}", b"".join(versions))

    def _headers(self) -> Iterator[Case]:
        """Yield the limits of the header fields, and headers that are refused."""
        heartbeat, limits = self._by_name["HEARTBEAT"], (Sender(255, 255, 255), Sender(0, 0, 0))
        for version in (1, 2):
            data = [self._packet("HEARTBEAT", sender, version=version) for sender in limits]
            yield Case(f"header/limits v{version}".replace(" ", "_"), b"".join(data))
        for flags in (0x02, 0x80, 0x03, 0xFF):
            packet = self._packet("HEARTBEAT", Sender(flags=flags))
            yield Case(f"header/incompat_flags_{flags:02x}", packet + self._packet("ATTITUDE"))
        packet = self._packet("HEARTBEAT", Sender(compatibility=0xA5))
        yield Case("header/compat_flags", packet + self._packet("ATTITUDE"))
        for length in (0, heartbeat.base_length - 1):
            packet = packet_v1(heartbeat.id, heartbeat.crc_extra, bytes(length), Sender())
            yield Case(f"header/v1_too_short_{length}", packet + self._packet("ATTITUDE", version=1))
        attitude = self._by_name["ATTITUDE"]
        packet = packet_v2(attitude.id, attitude.crc_extra, b"", Sender())
        yield Case("header/v2_empty_payload", self._packet("HEARTBEAT") + packet + self._packet("HEARTBEAT"))

    def _corrupt(self) -> Iterator[Case]:
        """Yield packets with each byte wrong in turn, between valid ones."""
        for version in (1, 2):
            packet = self._packet("ATTITUDE", Sender(3, 4, 5), version=version)
            for index in range(len(packet)):
                before, after = (
                    self._packet("HEARTBEAT", Sender(sequence=n), version=version) for n in (1, 2)
                )
                wrong = bytearray(packet)
                wrong[index] ^= 0x20
                yield Case(
                    f"corrupt/v{version}_byte_{index}",
                    before + bytes(wrong) + after + self._packet("HEARTBEAT") * 2,
                )
        packets = [self._packet("SYSTEM_TIME", Sender(sequence=n), seed=str(n)) for n in range(4)]
        yield Case("corrupt/missing_bytes", packets[0] + packets[1][:15] + packets[2] + packets[3])
        yield Case("corrupt/wrong_crc_extra", self._wrong_extra() + packets[0])

    def _wrong_extra(self) -> bytes:
        """Return a packet of another version of its message."""
        message = self._by_name["ATTITUDE"]
        return packet_v2(message.id, message.crc_extra ^ 0x5A, b"\1" * message.length, Sender())

    def _unknown(self) -> Iterator[Case]:
        known = self._packet("HEARTBEAT", Sender(sequence=9))
        v2 = packet_v2(UNKNOWN_ID, UNKNOWN_EXTRA, b"\1\2\3\4\5", Sender())
        v1 = packet_v1(UNKNOWN_ID_V1, UNKNOWN_EXTRA, b"\1\2\3\4\5", Sender())
        yield Case("unknown/v2", known + v2 + known)
        yield Case("unknown/v1", known + v1 + known)
        inside = packet_v2(UNKNOWN_ID, UNKNOWN_EXTRA, b"\0" * 20 + known + b"\0" * 20, Sender())
        yield Case("unknown/with_a_packet_inside", inside + known)
        for damage in count(1):
            wrong = bytearray(v2)
            wrong[11] ^= damage
            wrong[12] ^= 0x55
            if not any(
                packet_v2(UNKNOWN_ID, extra, bytes(wrong[10:15]), Sender())[-2:] == wrong[-2:]
                for extra in range(256)
            ):
                yield Case("unknown/no_crc_extra_fits", known + bytes(wrong) + known)
                return

    def _false_magics(self) -> Iterator[Case]:
        """Yield garbage with magics before and between packets of both versions."""
        packets = [
            self._packet("ATTITUDE", Sender(sequence=n), version=1 + n % 2, seed=str(n)) for n in range(6)
        ]
        starts = {
            "v2": bytes([V2]),
            "v1": bytes([V1]),
            "long_v2": bytes([V2, 0xFF, 0, 0, 0, 1, 1, 30, 0, 0]),
            "long_v1": bytes([V1, 0xFF, 0, 1, 1, 30]),
            "many_v2": bytes([V2]) * 40,
            "many_v1": bytes([V1]) * 40,
            "both": bytes([V2, 0x1C, 0, V1, 0x1C, V2, 9, 0, 0]),
        }
        for name, start in starts.items():
            stream = b"".join(start + packet for packet in packets)
            yield Case(f"false_magic/{name}", stream)
        random = Random("garbage")
        for number in range(4):
            garbage = [random.randbytes(random.randrange(1, 60)) for _ in packets]
            mixed = b"".join(junk + packet for junk, packet in zip(garbage, packets, strict=True))
            yield Case(f"garbage/{number}", mixed)
        yield Case("garbage/only", random.randbytes(600))

    def _signed(
        self,
        timestamp: int,
        *,
        sender: Sender | None = None,
        link_id: int = 1,
        key: bytes = KEY,
        name: str = "ATTITUDE",
    ) -> bytes:
        """Return a signed packet whose signature contains no magic."""
        sender = replace(sender or Sender(), flags=SIGNED)
        for seed in count():
            packet = self._packet(name, sender, seed=str(seed))
            signed = packet + signature(key, packet, link_id, timestamp)
            if not {V1, V2} & set(signed[1:]):
                return signed
        raise AssertionError

    def _signatures(self) -> Iterator[Case]:
        first, second, third = (self._signed(NOW + 10 * n, sender=Sender(sequence=n)) for n in range(3))

        def case(name: str, *packets: bytes, key: bytes | None = KEY, now: int | None = NOW) -> Case:
            return Case(f"signed/{name}", b"".join(packets), key, now)

        yield case("accepted", first, second, third)
        yield case("without_a_key", first, second, first, key=None, now=None)
        yield case("time_unknown", first, second, now=None)
        yield case("replayed", first, second, first, second, third)
        yield case("same_timestamp", first, self._signed(NOW, sender=Sender(sequence=7)))
        yield case("older_in_its_stream", second, first, third)
        yield case("other_key", self._signed(NOW, key=OTHER_KEY), second)
        yield case("forged_does_not_advance", self._signed(NOW + 50 * MINUTE, key=OTHER_KEY), first, second)
        for index in range(len(first) - 13, len(first)):
            wrong = bytearray(first)
            wrong[index] ^= 0x40
            yield case(f"wrong_signature_byte_{index - len(first) + 13}", bytes(wrong), second)
        unsigned = self._packet("HEARTBEAT")
        yield case("unsigned_with_a_key", unsigned, first, unsigned, second)
        yield case("v1_with_a_key", self._packet("HEARTBEAT", version=1), first)
        yield case("corrupt", first[:15] + bytes([first[15] ^ 1]) + first[16:], second)
        long = self._by_name["ENCAPSULATED_DATA"]
        data = bytes(range(1, 0xFC)) + b"\1\1\1\1"
        packet = packet_v2(long.id, long.crc_extra, data[: long.length], Sender(flags=SIGNED))
        yield case("longest", packet + signature(KEY, packet, 2, NOW + 1), second)
        unknown = packet_v2(UNKNOWN_ID, UNKNOWN_EXTRA, b"\1\2\3", Sender(flags=SIGNED))
        signatures = [signature(key, unknown, 1, NOW + 5) for key in (OTHER_KEY, KEY)]
        plain = packet_v2(UNKNOWN_ID, UNKNOWN_EXTRA, b"\1\2\3", Sender())
        yield case("unknown_id", *(unknown + item for item in signatures), plain, first, second)
        yield case("hash_padding", *map(self._signed_length, _HASHED_LENGTHS))
        yield from self._streams()

    def _signed_length(self, hashed: int) -> bytes:
        """Return a signed packet without magics inside, of whose hash the input has a length in bytes."""
        message = self._by_name["LOG_DATA"]
        filled = b"\1" * (hashed - len(KEY) - _HEADER_AND_CRC - _LINK_AND_TIMESTAMP)
        for sequence in range(0x80):
            sender = Sender(sequence=sequence, flags=SIGNED)
            packet = packet_v2(message.id, message.crc_extra, filled, sender)
            signed = packet + signature(KEY, packet, 1, NOW + hashed)
            if not {V1, V2} & set(signed[1:]):
                return signed
        raise AssertionError

    def _streams(self) -> Iterator[Case]:
        """Yield streams that begin at different times."""

        def case(name: str, *packets: bytes, now: int | None = NOW) -> Case:
            return Case(f"signed/{name}", b"".join(packets), KEY, now)

        others = (Sender(2, 1), Sender(1, 2), Sender(1, 1))
        links = (1, 1, 2)
        streams = [
            self._signed(NOW - 5, sender=sender, link_id=link)
            for sender, link in zip(others, links, strict=True)
        ]
        yield case("several_streams", self._signed(NOW), *streams, *streams)
        for name, age in (("young", MINUTE - 1000), ("a_minute_old", MINUTE), ("too_old", MINUTE + 1)):
            yield case(f"new_stream_{name}", self._signed(NOW - age))
            later = self._signed(NOW - age + 10, sender=Sender(9, 9))
            yield case(f"second_stream_{name}", self._signed(NOW + 10), later, now=None)
        yield case(
            "old_stream_goes_on",
            self._signed(NOW - 100),
            self._signed(NOW + 3 * MINUTE, sender=Sender(5, 5)),
            self._signed(NOW - 99),
        )
        yield case("first_of_all_very_old", self._signed(1000), self._signed(1001), now=None)

    def _cut_signatures(self) -> Iterator[Case]:
        """Yield signed packets that lost bytes of their signature, in whose place the next packet begins."""
        next_packets = [self._packet("HEARTBEAT", Sender(sequence=n), version=v) for n, v in ((1, 1), (2, 2))]
        signed = self._signed(NOW)
        for missing in (1, 6, 13):
            for version, packet in enumerate(next_packets, 1):
                data = signed[:-missing] + packet + self._packet("SYSTEM_TIME")
                yield Case(f"cut_signature/{missing}_bytes_v{version}", data)
            following = self._signed(NOW + 1) + self._signed(NOW + 2)
            yield Case(f"cut_signature/{missing}_bytes_with_a_key", signed[:-missing] + following, KEY, NOW)
