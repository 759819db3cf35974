"""Robustness of the core's objects that have a manual memory layout: messages and their classes.

Python code that misuses a message may cause an exception, but must never read or write outside the payload; a
failure here usually crashes the test process.
"""

from __future__ import annotations

import copy
import decimal
import fractions
import gc
import math
import pickle
import weakref

import numpy as np
import pytest

import mavstack
from mavstack import _core
from mavstack.dialects import Dialect, Message, common
from mavstack.errors import FieldNameError, FieldRangeError, FieldTypeError

from .callback_number import CallbackNumber

RAW = mavstack.encode(common.Attitude(1, 2.0, 3.0), system=1, component=1)


class Plain(common.Attitude):
    """A subclass with a dictionary."""


class Slotted(common.Attitude):
    __slots__ = ()


class Both(common.Heartbeat, common.Attitude):
    """Fields of two messages over the payload of the first."""


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

    message.yawspeed = CallbackNumber(become_heartbeat)
    assert type(message) is common.Heartbeat
    message.__class__ = common.Attitude
    assert (message.roll, message.yawspeed) == (2.0, 7.0)

    short = common.Heartbeat()

    def become_statustext():
        short.__class__ = common.Statustext
        return 7

    short.custom_mode = CallbackNumber(become_statustext)
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
    node.probe = probe = CallbackNumber(int)
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
        lambda: base.__new__(int),  # type: ignore[type-var]
        base.__new__,
        lambda: object.__new__(common.Attitude),
        lambda: int.__new__(common.Attitude),  # type: ignore[type-var]
        lambda: base.to_payload(5),
        lambda: base.to_payload(object()),
        lambda: _core.MessageMeta(common.Attitude),
        lambda: _core.MessageMeta("X", (object,), {})(1),
        lambda: mavstack.encode(object(), system=1, component=1),
        lambda: mavstack.encode(common.Attitude, system=1, component=1),
        lambda: mavstack.encode(None, system=1, component=1),
        lambda: Plain.__class__.__call__(base),  # type: ignore[operator]
    ):
        with pytest.raises(TypeError):
            action()  # type: ignore[call-arg]
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


def test_wrong_arguments_raise():
    with pytest.raises(FieldNameError, match="7 fields, got 8 arguments"):
        common.Attitude(*range(8))
    with pytest.raises(FieldNameError, match="time_boot_ms twice"):
        common.Attitude(1, time_boot_ms=1)
    with pytest.raises(FieldNameError, match=r"no field rol; .* time_boot_ms, roll"):
        common.Attitude(rol=1)  # type: ignore[call-arg]
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
        _ = message < message  # type: ignore[operator]
    assert message != 5


# values

ACCEPTED_VALUES = [
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
REFUSED_VALUES = [
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


@pytest.mark.parametrize(("field", "value", "expected"), ACCEPTED_VALUES)
def test_numbers_of_other_types_are_accepted(field, value, expected):
    message = common.Attitude()
    setattr(message, field, value)
    assert getattr(message, field) == expected == getattr(common.Attitude(**{field: value}), field)


@pytest.mark.parametrize(("field", "value", "error"), REFUSED_VALUES)
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

    message.roll = CallbackNumber(change)
    assert (message.roll, message.pitch) == (9.0, 6.0)


@pytest.mark.parametrize("error", [KeyError, MemoryError, KeyboardInterrupt])
def test_the_exception_of_a_conversion_is_raised(error):
    def fail():
        raise error

    with pytest.raises(error):
        common.Attitude(roll=CallbackNumber(fail))


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
