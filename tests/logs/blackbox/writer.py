"""Blackbox logs written by the tests, as Betaflight encodes them."""

from __future__ import annotations

import random
import struct

SIGNED, UNSIGNED, NEGATIVE, SVB8, S32, S16, NOTHING, VARIABLE = 0, 1, 3, 6, 7, 8, 9, 10
ZERO, PREVIOUS, LINE, AVERAGE, THROTTLE, MOTOR, INCREMENT, HOME, CENTRE, BATTERY, TIME, LOW = range(12)
LOW_MOTOR, BATTERY_REFERENCE = 48, 1600

#: (name, signed, predictor and encoding in I frames, those in P frames)
MAIN = (
    ("loopIteration", 0, ZERO, UNSIGNED, INCREMENT, NOTHING),
    ("time", 0, ZERO, UNSIGNED, LINE, SIGNED),
    *((f"axisP[{axis}]", 1, ZERO, SIGNED, PREVIOUS, SIGNED) for axis in range(3)),
    *((f"axisI[{axis}]", 1, ZERO, SIGNED, PREVIOUS, S32) for axis in range(3)),
    *((f"axisF[{axis}]", 1, ZERO, SIGNED, PREVIOUS, VARIABLE) for axis in range(3)),
    *((f"rcCommand[{axis}]", 1, ZERO, SIGNED, PREVIOUS, S16) for axis in range(4)),
    ("vbatLatest", 0, BATTERY, NEGATIVE, PREVIOUS, SVB8),
    ("amperageLatest", 1, ZERO, SIGNED, PREVIOUS, SVB8),
    ("rssi", 0, ZERO, UNSIGNED, PREVIOUS, SVB8),
    *((f"gyroADC[{axis}]", 1, ZERO, SIGNED, AVERAGE, SIGNED) for axis in range(3)),
    ("motor[0]", 0, LOW, UNSIGNED, AVERAGE, SIGNED),
    *((f"motor[{number}]", 0, MOTOR, SIGNED, AVERAGE, SIGNED) for number in range(1, 4)),
)
SLOW = (
    ("flightModeFlags", 0, ZERO, UNSIGNED),
    ("stateFlags", 0, ZERO, UNSIGNED),
    ("failsafePhase", 0, ZERO, S32),
    ("rxSignalReceived", 0, ZERO, S32),
    ("rxFlightChannelsValid", 0, ZERO, S32),
)
GPS = (
    ("time", 0, TIME, UNSIGNED),
    ("GPS_numSat", 0, ZERO, UNSIGNED),
    ("GPS_coord[0]", 1, HOME, SIGNED),
    ("GPS_coord[1]", 1, HOME, SIGNED),
    ("GPS_altitude", 0, ZERO, UNSIGNED),
    ("GPS_speed", 0, ZERO, UNSIGNED),
    ("GPS_ground_course", 0, ZERO, UNSIGNED),
)
HOME_FIELDS = (("GPS_home[0]", 1, ZERO, SIGNED), ("GPS_home[1]", 1, ZERO, SIGNED))
HOME_PLACE = (473_977_418, 85_455_938)
START_UTC = "2023-11-14T22:13:20.000+00:00"


def unsigned(value):
    value &= 0xFFFFFFFF
    out = bytearray()
    while value > 127:
        out.append(value & 127 | 128)
        value >>= 7
    return bytes([*out, value])


def signed(value):
    return unsigned((value << 1) ^ (value >> 31))


def _sized(values):
    sizes = [next(size for size in range(4) if _fits([value], 8 * size + 8)) for value in values]
    tag = 3 << 6 | sizes[0] | sizes[1] << 2 | sizes[2] << 4
    return bytes([tag]) + b"".join(
        value.to_bytes(size + 1, "little", signed=True) for value, size in zip(values, sizes, strict=True)
    )


def _fits(values, *bits):
    return all(-1 << (size - 1) <= value < 1 << (size - 1) for value, size in zip(values, bits, strict=True))


def _packed(tag, values, bits, width):
    number = tag
    for value, size in zip(values, bits, strict=True):
        number = number << size | value & ((1 << size) - 1)
    return number.to_bytes(width, "big")


def tag2_3s32(values):
    a, b, c = values
    if _fits(values, 2, 2, 2):
        return _packed(0, values, (2, 2, 2), 1)
    if _fits(values, 4, 4, 4):
        return bytes([1 << 6 | a & 15, (b & 15) << 4 | c & 15])
    if _fits(values, 6, 6, 6):
        return bytes([2 << 6 | a & 63, b & 255, c & 255])
    return _sized(values)


def tag2_3svariable(values):
    if _fits(values, 2, 2, 2):
        return _packed(0, values, (2, 2, 2), 1)
    if _fits(values, 5, 5, 4):
        return _packed(1, values, (5, 5, 4), 2)
    if _fits(values, 8, 7, 7):
        return _packed(2, values, (8, 7, 7), 3)
    return _sized(values)


def tag8_4s16(values):
    sizes = [next(size for size in (4, 8, 16) if _fits([value], size)) if value else 0 for value in values]
    tag = sum((0, 4, 8, 16).index(size) << 2 * number for number, size in enumerate(sizes))
    nibbles = "".join(
        f"{value & ((1 << size) - 1):0{size // 4}x}"
        for value, size in zip(values, sizes, strict=True)
        if size
    )
    return bytes([tag]) + bytes.fromhex(nibbles + "0" * (len(nibbles) % 2))


def tag8_8svb(values):
    if len(values) == 1:
        return signed(values[0])
    tag = sum(1 << number for number, value in enumerate(values) if value)
    return bytes([tag]) + b"".join(signed(value) for value in values if value)


SINGLE = {SIGNED: signed, UNSIGNED: unsigned, NEGATIVE: lambda value: unsigned(-value & 0x3FFF)}
GROUPED = {SVB8: tag8_8svb, S32: tag2_3s32, S16: tag8_4s16, VARIABLE: tag2_3svariable}


def encoded(values, encodings):
    """Return the values of a frame in their encodings."""
    out, index = b"", 0
    while index < len(values):
        encoding, end = encodings[index], index + 1
        if encoding in SINGLE:
            out += SINGLE[encoding](values[index])
        elif encoding in GROUPED:
            size = {SVB8: 8, S32: 3, S16: 4, VARIABLE: 3}[encoding]
            while end < min(index + size, len(values)) and encodings[end] == encoding:
                end += 1
            out += GROUPED[encoding](values[index:end])
        index = end
    return out


class FlightWriter:
    """A flight in memory, with the rows that a reader must find."""

    def __init__(self, *, main=MAIN, gps=True, headers=(), start=START_UTC, interval="1/2"):
        self.main_fields = main
        self.rows = {"MAIN": [], "SLOW": [], "GPS": [], "HOME": [], "EVENT": []}
        self.previous = self.before = None
        self.marks = []
        lines = [
            "Product:Blackbox flight data recorder by Nicholas Sherlock",
            "Data version:2",
            "I interval:32",
            f"P interval:{interval}",
            *_definitions("I", main),
            f"Field P predictor:{','.join(str(field[4]) for field in main)}",
            f"Field P encoding:{','.join(str(field[5]) for field in main)}",
            *_definitions("S", SLOW),
            *((*_definitions("G", GPS), *_definitions("H", HOME_FIELDS)) if gps else ()),
            "Firmware type:Cleanflight",
            "Firmware revision:Betaflight 4.4.2 (23d066d08) STM32F405",
            "Board information:MTKS MATEKF405",
            f"Log start datetime:{start}",
            "Craft name:test",
            "minthrottle:1070",
            f"motorOutput:{LOW_MOTOR},2047",
            f"vbatref:{BATTERY_REFERENCE}",
            "gyro_scale:0x3f800000",
            "acc_1G:2048",
            "motor_poles:14",
            "rollPID:45,80,40",
            *headers,
        ]
        self.data = bytearray("".join(f"H {line}\n" for line in lines).encode())

    def _frame(self, letter, body, table, row):
        self.marks.append(len(self.data))
        self.data += letter + body
        self.rows[table].append(row)

    def main(self, values, *, intra):
        """Write a main frame of true values."""
        fields = self.main_fields
        raw = list(values)
        constants = {ZERO: 0, LOW: LOW_MOTOR, BATTERY: BATTERY_REFERENCE}
        motor = next((number for number, field in enumerate(fields) if field[0] == "motor[0]"), 0)
        for number, field in enumerate(fields):
            predictor = field[2 if intra else 4]
            if predictor in (PREVIOUS, LINE, AVERAGE):
                last, before = self.previous[number], self.before[number]
                total = last + before
                mean = total // 2 if total >= 0 else -(-total // 2)
                raw[number] -= {PREVIOUS: last, LINE: 2 * last - before, AVERAGE: mean}[predictor]
            elif predictor != INCREMENT:
                raw[number] -= values[motor] if predictor == MOTOR else constants[predictor]
        encodings = [field[3 if intra else 5] for field in fields]
        self._frame(b"I" if intra else b"P", encoded(raw, encodings), "MAIN", list(values))
        self.before = list(values) if intra else self.previous
        self.previous = list(values)

    def slow(self, *values):
        """Write a slow frame."""
        body = encoded(list(values), [field[3] for field in SLOW])
        self._frame(b"S", body, "SLOW", list(values))

    def home(self):
        """Write the home position."""
        self._frame(b"H", encoded(list(HOME_PLACE), [SIGNED, SIGNED]), "HOME", list(HOME_PLACE))

    def gps(self, time, satellites, latitude, longitude, *rest):
        """Write a position."""
        values = [time, satellites, latitude, longitude, *rest]
        place = latitude - HOME_PLACE[0], longitude - HOME_PLACE[1]
        raw = [time - self.previous[1], satellites, *place, *rest]
        self._frame(b"G", encoded(raw, [field[3] for field in GPS]), "GPS", values)

    def event(self, kind, body=b""):
        """Write an event."""
        self._frame(b"E", bytes([kind]) + body, "EVENT", [kind])

    def end(self):
        """Write the last event, and return the bytes."""
        self.event(255, b"End of log\0")
        return bytes(self.data)


def _definitions(letter, fields):
    names = ("name", "signed", "predictor", "encoding")
    return [
        f"Field {letter} {name}:{','.join(str(field[number]) for field in fields)}"
        for number, name in enumerate(names)
    ]


def flight(seed=1, frames=200, *, start_us=5_000_000, events=True, **options):
    """Return a flight with frames of all kinds and random values; other readers know fewer events."""
    rng = random.Random(seed)
    writer = FlightWriter(**options)
    gps = options.get("gps", True)
    if events:
        writer.slow(1, 3, 0, 1, 1)
    values = None
    for number in range(frames):
        iteration = 2 * number
        if values is None or rng.random() < 0.2:
            values = [rng.choice([0, 1, -1, 5, -30, 100, -200, 3000, -20000]) for _ in writer.main_fields]
        else:
            values = [value + rng.choice([0, 0, 1, -1, 3, -9, 40]) for value in values]
        values[0], values[1] = iteration, start_us + number * 250 + rng.randrange(5)
        for index, field in enumerate(writer.main_fields):
            if index > 1 and not field[1]:
                values[index] = abs(values[index]) % 2000
        writer.main(values, intra=iteration % 32 == 0)
        if gps:
            _write_gps(writer, number, values[1])
        if number % 60 == 59:
            writer.slow(number, 3, rng.randrange(4), 1, 1)
        _write_events(writer, number, values[1])
        if events and number == 50:
            writer.event(30, unsigned(3) + unsigned(1))
    if events:
        writer.event(15, unsigned(4))
    writer.end()
    return writer


def _write_gps(writer, number, time):
    if number == 3:
        writer.home()
    if number > 3 and number % 20 == 5:
        place = HOME_PLACE[0] + number * 90, HOME_PLACE[1] - number
        writer.gps(time + 7, 12, *place, 5000 + number, 300, 1800)


def _write_events(writer, number, time):
    if number == 60:
        writer.event(13, bytes([4]) + signed(-12))
    if number == 61:
        writer.event(13, bytes([0x80 | 5]) + struct.pack("<f", 1.5))
    if number == 70:
        writer.event(0, unsigned(time))
