"""Lifetime of the core's objects: copies, borrowing across calls, threads, and memory."""

from __future__ import annotations

import copy
import gc
import pickle
import sys
import threading
import weakref

import pytest

import mavstack
from mavstack._core import MessageBase, new_message_class
from mavstack.dialects import Dialect, common, dialect
from mavstack.wire import Packet, Parser

from .callback_number import CallbackNumber

ALL = Dialect.load("all")
RAW = mavstack.encode(common.Attitude(1, 2.0, 3.0), system=1, component=1)


# copies


def test_packets_can_be_pickled_and_copied():
    (packet,) = mavstack.Parser(common).feed(RAW)
    for protocol in range(2, pickle.HIGHEST_PROTOCOL + 1):
        again = pickle.loads(pickle.dumps(packet, protocol))
        assert (again, again.message) == (packet, packet.message)
    assert copy.copy(packet) == copy.deepcopy(packet) == packet
    assert packet.message is packet.message


def test_copies_share_nothing():
    message = common.Attitude(1, 2.0)
    for other in (
        copy.copy(message),
        copy.deepcopy(message),
        pickle.loads(pickle.dumps(message)),
        message.replace(),
    ):
        other.roll = 9.0
    assert message.roll == 2.0


@pytest.mark.parametrize("name", ["Parser", "Signing", "Encoder", "Statistics"])
def test_objects_with_link_state_cannot_be_pickled(name):
    state = {
        "Parser": mavstack.Parser(common),
        "Signing": mavstack.Signing(bytes(32)),
        "Encoder": mavstack.Encoder(1, 1),
        "Statistics": mavstack.Parser(common).statistics,
    }[name]
    with pytest.raises(TypeError):
        pickle.dumps(state)


# borrowing and threads


def test_recursive_feeding_raises():
    parser = mavstack.Parser(common)
    with pytest.raises(RuntimeError, match="borrowed"):
        parser.feed(RAW, CallbackNumber(lambda: len(parser.feed(RAW))))
    assert len(parser.feed(RAW)) == 1


def test_recursive_encoding_gives_each_packet_its_number():
    encoder, inner = mavstack.Encoder(1, 1), []
    now = CallbackNumber(lambda: inner.append(encoder.encode(common.Heartbeat())) or 0)
    outer = encoder.encode(common.Heartbeat(), now)
    assert (inner[0][4], outer[4], encoder.sequence) == (0, 1, 2)


def test_encode_takes_its_arguments_in_every_form():
    encoder, message = mavstack.Encoder(1, 1), common.Heartbeat()
    packets = [
        encoder.encode(message),
        encoder.encode(message=message),
        encoder.encode(message, None),
        encoder.encode(now=1e9, message=message),
    ]
    assert [packet[4] for packet in packets] == [0, 1, 2, 3]
    for arguments in ((), (b"",), (message, 1.0, 2)):
        with pytest.raises(TypeError):
            encoder.encode(*arguments)
    with pytest.raises(TypeError, match="other"):
        encoder.encode(message, other=1)  # type: ignore[call-arg]


class AtCollection:
    """Runs an action when the cycle collector frees it, which may be inside any call that creates objects."""

    def __init__(self, action, caught):
        self.cycle, self.action, self.caught = self, action, caught

    def __del__(self):
        try:
            self.caught.append(self.action())
        except BaseException as error:  # noqa: BLE001 - the test examines its type
            self.caught.append(type(error).__mro__)


def _inside_feed(action, parser):
    """Return the result of the action when a collection runs inside `feed`, as before Python 3.12."""
    caught, data, threshold = [], RAW * 50, gc.get_threshold()
    gc.collect()
    gc.disable()
    AtCollection(action, caught)
    gc.set_threshold(1)
    gc.enable()
    found = parser.feed(data)
    gc.set_threshold(*threshold)
    gc.collect()
    assert len(found) == 50
    return caught[0]


def test_a_finalizer_inside_feed_returns_or_raises():
    parser = mavstack.Parser(common)
    outcome = _inside_feed(lambda: parser.feed(RAW), parser)
    assert isinstance(outcome, list) or Exception in outcome
    assert len(parser.feed(RAW)) == 1


def test_a_finalizer_inside_feed_that_signs_returns_or_raises():
    signing = mavstack.Signing(bytes(32), accept_unsigned=True)
    parser = mavstack.Parser(common, signing=signing)
    outcome = _inside_feed(
        lambda: mavstack.encode(common.Heartbeat(), system=1, component=1, signing=signing), parser
    )
    assert isinstance(outcome, bytes) or Exception in outcome


def test_threads_with_separate_parsers_and_encoders():
    failures = []

    def work(number):
        encoder, parser = mavstack.Encoder(number, 1), mavstack.Parser(common)
        try:
            for step in range(500):
                (packet,) = parser.feed(encoder.encode(common.Attitude(step, number)))
                assert (packet.system, packet.message.time_boot_ms, packet.message.roll) == (
                    number,
                    step,
                    number,
                )
        except BaseException as error:  # noqa: BLE001 - passed to the test
            failures.append(error)

    _in_threads(work, 4)
    assert failures == []


def test_threads_with_one_parser_lose_no_packets():
    parser, counts = mavstack.Parser(common), []

    def work(_number):
        found = 0
        for _ in range(200):
            found += len(parser.feed(RAW * 5))
        counts.append(found)

    _in_threads(work, 4)
    assert sum(counts) == 4 * 200 * 5 == parser.statistics.packets


def test_threads_create_a_class_once():
    made = Dialect(dialect.Dialect.load("minimal").table, ())
    classes = []
    _in_threads(lambda _number: classes.append(made["HEARTBEAT"]), 8)
    parsers = [mavstack.Parser(made) for _ in range(4)]
    raw = mavstack.encode(classes[0](), system=1, component=1)
    _in_threads(lambda number: classes.append(type(parsers[number - 1].feed(raw)[0].message)), 4)
    assert len(set(classes)) == 1


def _in_threads(work, count):
    threads = [threading.Thread(target=work, args=(number,)) for number in range(1, count + 1)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()


# leaks


def xml_dialect(folder, number):
    path = folder / f"mine_{number}.xml"
    path.write_text(
        f'<mavlink><enums><enum name="MY_KIND"><entry value="{number}" name="MY_KIND_A"/>'
        f'<entry value="{number + 1}" name="MY_KIND_B"/></enum></enums>'
        '<messages><message id="200" name="MINE">'
        f'<field type="uint8_t" name="kind" enum="MY_KIND"/><field type="uint32_t" name="v{number}"/>'
        "</message></messages></mavlink>"
    )
    return Dialect.from_xml(path)


def clear_caches():
    """Clear the bounded caches of recently created dialects."""
    dialect._from_definition.cache_clear()
    gc.collect()


def _nothing(_dialect):
    pass


def _make(made):
    repr(made["MINE"].definition)
    made["MINE"](5).replace(kind=6)


def _parse(made):
    mavstack.Parser(made).feed(mavstack.encode(made["MINE"](5), system=1, component=1))


def _read_enum(made):
    assert isinstance(made["MINE"](250).kind, int)


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("use", [_parse, _nothing, _make, _read_enum])
def test_unreferenced_custom_dialects_are_freed(tmp_path, use):
    clear_caches()
    alive = []
    for number in range(80):
        made = xml_dialect(tmp_path, number)
        use(made)
        alive.append(weakref.ref(made))
        del made
    gc.collect()
    kept = sum(reference() is not None for reference in alive)
    clear_caches()
    left = sum(reference() is not None for reference in alive)
    assert (kept <= 64, left) == (True, 0)


def test_packets_and_messages_leak_no_memory():
    def use():
        parser = mavstack.Parser(common)
        for packet in parser.feed(RAW * 20 + b"\xfd\xff junk" + RAW[:9]):
            repr(packet.message)
            pickle.dumps(packet)
        parser.flush()
        for wrong in ({"roll": "x"}, {"rol": 1}):
            with pytest.raises(TypeError):
                common.Attitude(**wrong)
        with pytest.raises(ValueError, match="exactly one valid"):
            Packet(b"junk", common)

    use()
    gc.collect()
    before = len(gc.get_objects())
    for _ in range(20):
        use()
    gc.collect()
    assert len(gc.get_objects()) - before < 50


def test_descriptors_keep_their_class_alive(tmp_path):
    made = xml_dialect(tmp_path, 1)
    field = made["MINE"].v1
    message = made["MINE"](5, 6)
    del made
    clear_caches()
    assert field.__get__(message) == 6
    del message
    gc.collect()
    assert field.__objclass__(1, 2).v1 == 2


def test_memory_of_freed_messages_holds_those_of_other_classes():
    names = ("HEARTBEAT", "ATTITUDE", "PARAM_VALUE", "GPS_RAW_INT", "STATUSTEXT", "PING")
    classes = [ALL[name] for name in names]
    raw = [cls.from_payload(bytes(range(1, 60))).to_payload() for cls in classes]
    for turn in range(300):
        kept = [(cls, payload, cls.from_payload(payload)) for cls, payload in zip(classes, raw, strict=True)]
        kept = kept[turn % 5 :: 2]
        assert all(cls().to_payload() == cls().to_payload() for cls in classes)
        assert all(type(message) is cls and message.to_payload() == payload for cls, payload, message in kept)


def test_messages_whose_class_was_assigned_are_freed():
    class Plain(common.Attitude):
        __slots__ = ()

    class Finalized(common.Attitude):
        __slots__ = ()

        def __del__(self):
            freed.append(self.roll)

    freed: list[float] = []
    for number in range(100):
        message = Plain(roll=number)
        message.__class__ = common.Attitude
        other = common.Attitude(roll=number)
        other.__class__ = Finalized
        assert (message.roll, other.roll) == (number, number)
        del message, other
    assert freed == list(range(100))
    assert [common.Attitude(roll=number).roll for number in range(100)] == list(range(100))


def test_each_message_of_a_class_with_a_finalizer_is_finalized(monkeypatch):
    freed: list[float] = []
    monkeypatch.setattr(common.Attitude, "__del__", lambda self: freed.append(self.roll), raising=False)
    for number in range(10):
        common.Attitude(roll=number)
    assert freed == list(range(10))


def test_a_message_that_a_finalizer_keeps_is_not_overwritten(monkeypatch):
    def keep(message):
        kept.append(message)

    kept: list[common.Attitude] = []
    monkeypatch.setattr(common.Attitude, "__del__", keep, raising=False)
    for number in range(10):
        common.Attitude(roll=number)
    monkeypatch.undo()
    others = [common.Attitude(roll=50) for _ in range(20)]
    assert [message.roll for message in kept] == list(range(10))
    kept.clear()
    assert {message.roll for message in others} == {50}


def packets_of(count):
    """Return packets of ATTITUDE with their number as roll."""
    sent = b"".join(
        mavstack.encode(common.Attitude(roll=number), system=1, component=1) for number in range(count)
    )
    return Parser(common).feed(sent)


def test_a_message_is_finalized_once_when_its_packet_is_freed(monkeypatch):
    freed: list[float] = []
    packets = packets_of(10)
    rolls = [packet.message.roll for packet in packets]
    monkeypatch.setattr(common.Attitude, "__del__", lambda self: freed.append(self.roll), raising=False)
    del packets
    assert sorted(freed) == rolls


def test_a_message_that_outlives_its_packet_is_unchanged():
    kept = [packet.message for packet in packets_of(100)]
    others = [packet.message for packet in packets_of(100)]
    assert [message.roll for message in kept] == list(range(100))
    assert [message.roll for message in others] == list(range(100))


def test_messages_and_packets_keep_no_reference_to_their_classes_after_them():
    def use():
        for packet in packets_of(500):
            assert packet.message.roll >= 0

    use()
    before = sys.getrefcount(common.Attitude), sys.getrefcount(Packet)
    for _ in range(5):
        use()
    assert (sys.getrefcount(common.Attitude), sys.getrefcount(Packet)) == before


def test_a_message_of_a_packet_whose_class_was_assigned_is_finalized():
    class Finalized(common.Attitude):
        __slots__ = ()

        def __del__(self):
            freed.append(self.roll)

    freed: list[float] = []
    packets = packets_of(10)
    for packet in packets:
        packet.message.__class__ = Finalized
    del packet, packets
    assert sorted(freed) == list(range(10))


def test_a_message_class_with_a_dictionary_is_refused():
    class WithDictionary:
        pass

    row = (77_777, "EXTRA", 1, 1, 1, [("value", "uint8_t", 0, 0, False)])
    with pytest.raises(TypeError, match="must not have a dictionary"):
        new_message_class("Extra", (MessageBase, WithDictionary), {}, row)
