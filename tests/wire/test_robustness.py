"""Robustness of the core's hand-laid objects: messages, their classes, and borrowing across calls.

Whatever Python code does to a message, it may raise an exception, but must never read or write outside the
payload; a failure here usually crashes the test process.
"""

from __future__ import annotations

import copy
import decimal
import fractions
import gc
import math
import pickle
import threading
import weakref

import numpy as np
import pytest

import mavstack
from mavstack import _core
from mavstack.dialects import Dialect, Message, common, dialect
from mavstack.errors import FieldNameError, FieldRangeError, FieldTypeError
from mavstack.wire import Packet

RAW = mavstack.encode(common.Attitude(1, 2.0, 3.0), system=1, component=1)


class Plain(common.Attitude):
    """A subclass with a dictionary."""


class Slotted(common.Attitude):
    __slots__ = ()


class Both(common.Heartbeat, common.Attitude):
    """Fields of two messages over the payload of the first."""


class Odd:
    """A number that runs an action when it is converted."""

    def __init__(self, action):
        self.action = action

    def __index__(self):
        return int(self.action())

    def __float__(self):
        return float(self.action())


# classes


def test_a_payload_too_short_for_its_new_class_raises():
    message = common.Heartbeat(1, 2, 3, 4, 5)
    message.__class__ = common.Statustext
    for action in (
        lambda: message.text,
        lambda: message.id,
        lambda: setattr(message, "text", "x" * 50),
        lambda: setattr(message, "id", 1),
        lambda: repr(message),
        message.to_payload,
        lambda: copy.copy(message),
        lambda: pickle.dumps(message),
        lambda: mavstack.encode(message, system=1, component=1),
    ):
        with pytest.raises(TypeError, match="payload of this object does not belong to its class"):
            action()
    assert message != common.Statustext()
    message.severity = 3
    message.__class__ = common.Heartbeat
    assert message.to_payload()[0] == 3


def test_a_payload_longer_than_its_new_class_keeps_its_bytes():
    message = common.Statustext(severity=1, text="a" * 50)
    message.__class__ = common.Heartbeat
    assert (message.custom_mode, message.type) == (0x61616101, 0x61)
    assert message != common.Heartbeat()
    assert len(mavstack.encode(message, system=1, component=1, version=1)) == 17
    message.__class__ = common.Statustext
    assert message.text == "a" * 50


def test_new_bases_of_the_class_of_existing_messages():
    class Changing(common.Attitude):
        __slots__ = ()

    message = Changing(1, 2.0)
    Changing.__bases__ = (common.Statustext,)
    assert Changing(1, "text").text == "text"
    with pytest.raises(TypeError):
        message.to_payload()
    with pytest.raises(TypeError):
        _ = message.text
    Changing.__bases__ = (common.Attitude,)
    assert message.roll == 2.0


def test_a_setter_that_changes_the_class_of_its_own_message():
    message = common.Attitude(1, 2.0, 3.0)

    def become_heartbeat():
        message.__class__ = common.Heartbeat
        return 7

    message.yawspeed = Odd(become_heartbeat)
    assert type(message) is common.Heartbeat
    message.__class__ = common.Attitude
    assert (message.roll, message.yawspeed) == (2.0, 7.0)

    short = common.Heartbeat()

    def become_statustext():
        short.__class__ = common.Statustext
        return 7

    short.custom_mode = Odd(become_statustext)
    with pytest.raises(TypeError):
        short.to_payload()


@pytest.mark.parametrize("kind", [Plain, Slotted])
def test_subclasses_are_messages(kind):
    made = kind(1, roll=2.0)
    assert (made.roll, made) == (2.0, common.Attitude(1, 2.0))
    assert mavstack.encode(made, system=1, component=1) == mavstack.encode(
        common.Attitude(1, 2.0), system=1, component=1
    )
    assert type(kind.from_payload(b"\x01")) is type(copy.copy(made)) is type(made.replace(roll=1)) is kind
    assert pickle.loads(pickle.dumps(made)) == made
    assert repr(made).startswith(kind.__name__)


def test_a_subclass_with_a_dictionary_is_garbage_collected():
    class Node(common.Attitude):
        pass

    node = Node(1)
    node.self = node
    node.probe = probe = Odd(int)
    reference = weakref.ref(probe)
    del node, probe
    gc.collect()
    assert reference() is None


def test_subclasses_cannot_add_slots():
    with pytest.raises(TypeError, match="nonempty __slots__"):
        type(common.Attitude)("Wide", (common.Attitude,), {"__slots__": ("x",)})


def test_a_class_with_two_message_bases_reads_only_its_payload():
    message = Both(type=1)
    assert len(message.to_payload(1)) == 9
    assert message.roll != 0.0, "bytes 4 to 7 of the heartbeat"
    for action in (lambda: message.yawspeed, lambda: setattr(message, "pitch", 1.0)):
        with pytest.raises(TypeError):
            action()
    with pytest.raises(FieldNameError):
        Both(roll=1.0)


def test_subclasses_may_override_new():
    class Turned(common.Attitude):
        def __new__(cls, degrees):
            return super().__new__(cls, yaw=math.radians(degrees))

        def __init__(self, degrees):
            self.degrees = degrees

    assert (Turned(180).yaw, Turned(90).degrees) == (pytest.approx(math.pi), 90)


def test_other_classes_create_no_messages():
    class Empty(Message):
        __slots__ = ()

    base = _core.MessageBase
    for action in (
        base,
        Message,
        Empty,
        lambda: base.from_payload(b""),
        lambda: Message.from_payload(b""),
        lambda: Empty.from_payload(b""),
        lambda: base.__new__(int),
        base.__new__,
        lambda: object.__new__(common.Attitude),
        lambda: int.__new__(common.Attitude),
        lambda: base.to_payload(5),
        lambda: base.to_payload(object()),
        lambda: _core.MessageMeta(common.Attitude),
        lambda: _core.MessageMeta("X", (object,), {})(1),
        lambda: mavstack.encode(object(), system=1, component=1),
        lambda: mavstack.encode(common.Attitude, system=1, component=1),
        lambda: mavstack.encode(None, system=1, component=1),
        lambda: Plain.__class__.__call__(base),
    ):
        with pytest.raises(TypeError):
            action()
    message = Slotted(1)
    message.__class__ = Empty
    with pytest.raises(TypeError):
        message.to_payload()
    assert _core.MessageMeta("Five", (int,), {})(5) == 5


def test_descriptors_accept_only_messages_of_their_class():
    roll = common.Attitude.roll
    assert roll.__get__(common.Attitude(roll=2.0)) == 2.0
    for other in (common.Heartbeat(), 5, None, common.Attitude):
        with pytest.raises(TypeError):
            roll.__get__(other)
        with pytest.raises(TypeError):
            roll.__set__(other, 1.0)


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


def test_wrong_arguments_raise():
    with pytest.raises(FieldNameError, match="7 fields, got 8 arguments"):
        common.Attitude(*range(8))
    with pytest.raises(FieldNameError, match="time_boot_ms twice"):
        common.Attitude(1, time_boot_ms=1)
    with pytest.raises(FieldNameError, match=r"no field rol; .* time_boot_ms, roll"):
        common.Attitude(rol=1)
    with pytest.raises(FieldNameError):
        common.Attitude(**{f"field_{number}": 1 for number in range(300)})
    with pytest.raises(TypeError):
        common.Attitude(**{1: 2})
    message = common.Attitude()
    with pytest.raises(AttributeError):
        message.rol = 1
    with pytest.raises(AttributeError, match="cannot be deleted"):
        del message.roll
    with pytest.raises(TypeError):
        hash(message)
    with pytest.raises(TypeError):
        _ = message < message
    assert message != 5


# values

GOOD = [
    ("time_boot_ms", True, 1),
    ("time_boot_ms", np.uint32(5), 5),
    ("time_boot_ms", np.array(5), 5),
    ("time_boot_ms", 2**32 - 1, 2**32 - 1),
    ("roll", True, 1.0),
    ("roll", 3, 3.0),
    ("roll", np.float32(1.5), 1.5),
    ("roll", np.float64(1.5), 1.5),
    ("roll", decimal.Decimal("1.5"), 1.5),
    ("roll", fractions.Fraction(1, 2), 0.5),
    ("roll", -math.inf, -math.inf),
    ("roll", 3.4028234e38, 3.4028234663852886e38),
]
BAD = [
    ("time_boot_ms", -1, FieldRangeError),
    ("time_boot_ms", 2**32, FieldRangeError),
    ("time_boot_ms", 10**400, FieldRangeError),
    ("time_boot_ms", np.int64(-1), FieldRangeError),
    ("time_boot_ms", 5.0, FieldTypeError),
    ("time_boot_ms", np.float64(5), FieldTypeError),
    ("time_boot_ms", decimal.Decimal(1), FieldTypeError),
    ("time_boot_ms", "5", FieldTypeError),
    ("time_boot_ms", None, FieldTypeError),
    ("time_boot_ms", np.array([5, 6]), FieldTypeError),
    ("roll", 1e39, FieldRangeError),
    ("roll", "1", FieldTypeError),
    ("roll", b"1", FieldTypeError),
    ("roll", None, FieldTypeError),
    ("roll", 1j, FieldTypeError),
]


@pytest.mark.parametrize(("field", "value", "expected"), GOOD)
def test_numbers_of_other_types_are_accepted(field, value, expected):
    message = common.Attitude()
    setattr(message, field, value)
    assert getattr(message, field) == expected == getattr(common.Attitude(**{field: value}), field)


@pytest.mark.parametrize(("field", "value", "error"), BAD)
def test_values_out_of_range_raise_and_change_nothing(field, value, error):
    message = common.Attitude(7, 7.0)
    with pytest.raises(error, match=rf"Attitude\.{field}"):
        setattr(message, field, value)
    with pytest.raises(error):
        common.Attitude(**{field: value})
    assert message == common.Attitude(7, 7.0)


def test_a_number_too_long_to_print_is_refused():
    with pytest.raises(FieldRangeError, match="the value is outside 0"):
        common.Attitude(time_boot_ms=10**5000)


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (np.arange(3, dtype="u1"), b"\0\1\2"),
        (bytearray(b"abc"), b"abc"),
        (memoryview(b"a-b-c")[::2], b"abc"),
        ([1, 2, 3], b"\1\2\3"),
        ((number for number in (1, 2)), b"\1\2\0"),
        (range(3), b"\0\1\2"),
        ([True, np.uint8(2)], b"\1\2\0"),
        (b"", b"\0\0\0"),
    ],
)
def test_byte_arrays_accept_any_bytes(value, expected):
    assert common.GpsRtcmData(data=value).data == expected.ljust(180, b"\0")


@pytest.mark.parametrize(
    "value", ["abc", 5, None, [256], [-1], [None], ["a"], b"x" * 181, [0] * 181, np.zeros(3, "f4"), object()]
)
def test_byte_arrays_refuse_other_values(value):
    message = common.GpsRtcmData(data=b"kept")
    with pytest.raises((FieldTypeError, FieldRangeError), match=r"GpsRtcmData\.data"):
        message.data = value
    assert message.data.startswith(b"kept\0")


def test_an_iterator_that_raises_or_changes_the_message():
    message = common.AttitudeTarget(q=(1, 2, 3, 4))

    def raising():
        yield 9.0
        raise KeyError("mine")

    def changing():
        message.q = (5, 6, 7, 8)
        yield 9.0
        message.__class__ = common.Heartbeat
        yield 9.0
        message.__class__ = common.AttitudeTarget

    with pytest.raises(KeyError, match="mine"):
        message.q = raising()
    assert message.q == (1.0, 2.0, 3.0, 4.0)
    message.q = changing()
    assert message.q == (9.0, 9.0, 0.0, 0.0)


def test_a_number_that_changes_the_message_when_converted():
    message = common.Attitude(1, 2.0)

    def change():
        message.roll = 5.0
        message.pitch = 6.0
        return 9.0

    message.roll = Odd(change)
    assert (message.roll, message.pitch) == (9.0, 6.0)


@pytest.mark.parametrize("error", [KeyError, MemoryError, KeyboardInterrupt])
def test_the_exception_of_a_conversion_is_raised(error):
    def fail():
        raise error

    with pytest.raises(error):
        common.Attitude(roll=Odd(fail))


@pytest.mark.parametrize("value", [None, 5, bytearray(b"a"), "x" * 51, "é" * 26, b"x" * 51])
def test_texts_refuse_long_and_other_values(value):
    with pytest.raises((FieldTypeError, FieldRangeError), match=r"Statustext\.text"):
        common.Statustext(text=value)


def test_texts_refuse_surrogates():
    with pytest.raises(FieldTypeError, match="UTF-8"):
        common.Statustext(text="\ud800")


def test_keywords_and_reserved_names_as_fields(tmp_path):
    path = tmp_path / "names.xml"
    names = ("class", "def", "from", "definition", "to_dict", "None", "__init__", "_enum_values", "x", "x_")
    fields = "".join(f'<field type="uint8_t" name="{name}"/>' for name in names)
    path.write_text(f'<mavlink><messages><message id="1" name="KEYS">{fields}</message></messages></mavlink>')
    made = Dialect.from_xml(path)
    message = made["KEYS"](*range(1, len(names) + 1))
    assert list(message.to_dict().values()) == list(range(1, len(names) + 1))
    assert list(message.to_dict()) == list(names)
    assert made["KEYS"].from_dict(message.to_dict()) == message
    attributes = message.__match_args__
    assert len(set(attributes)) == len(names)
    assert [getattr(message, name) for name in attributes] == list(range(1, len(names) + 1))
    assert eval(repr(message), {"Keys": made["KEYS"]}) == message
    (packet,) = mavstack.Parser(made).feed(mavstack.encode(message, system=1, component=1))
    assert packet.message.class_ == 1


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
        parser.feed(RAW, Odd(lambda: len(parser.feed(RAW))))
    assert len(parser.feed(RAW)) == 1


def test_recursive_encoding_raises():
    encoder = mavstack.Encoder(1, 1)
    with pytest.raises(RuntimeError, match="borrowed"):
        encoder.encode(common.Heartbeat(), Odd(lambda: len(encoder.encode(common.Heartbeat()))))
    assert encoder.encode(common.Heartbeat())[4] == 0


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


@pytest.mark.parametrize(
    "use",
    [
        _nothing,
        _make,
        _parse,
        _read_enum,
    ],
)
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
