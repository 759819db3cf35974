"""DataFlash logs written by the tests, record by record."""

from __future__ import annotations

import random
import struct

HEADER = b"\xa3\x95"
FMT, FMTU, UNIT, MULT = 128, 129, 130, 131
CODES = {
    "a": "64s", "b": "b", "B": "B", "h": "h", "H": "H", "i": "i", "I": "I", "q": "q", "Q": "Q", "g": "e",
    "f": "f", "d": "d", "n": "4s", "N": "16s", "Z": "64s", "c": "h", "C": "H", "e": "i", "E": "I", "L": "i",
    "M": "B",
}  # fmt: skip
#: (type number, name, format, labels, characters of units, characters of multipliers)
TYPES = (
    (FMTU, "FMTU", "QBNN", "TimeUS,FmtType,UnitIds,MultIds", "s---", "F---"),
    (UNIT, "UNIT", "QbZ", "TimeUS,Id,Label", "s--", "F--"),
    (MULT, "MULT", "Qbd", "TimeUS,Id,Mult", "s--", "F--"),
    (1, "GPS", "QBBIHBcLLefff", "TimeUS,I,Status,GMS,GWk,NSats,HDop,Lat,Lng,Alt,Spd,GCrs,VZ", "s#---SmDUmnhn",
     "F----0-GGB000"),
    (2, "IMU", "QBffffff", "TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ", "s#EEEooo", "F-000000"),
    (3, "ATT", "QccccCC", "TimeUS,DesRoll,Roll,DesPitch,Pitch,DesYaw,Yaw", "sddddhh", "FBBBBBB"),
    (4, "PARM", "QNff", "TimeUS,Name,Value,Default", "s---", "F---"),
    (5, "MSG", "QZ", "TimeUS,Message", "s-", "F-"),
    (6, "MODE", "QMBB", "TimeUS,Mode,ModeNum,Rsn", "s---", "F---"),
    (7, "ALL", "QbBhHiIqdfgnNZcCeELMa", "TimeUS,b,B,h,H,i,I,q,d,f,g,n,N,Z,c,C", "s", "F"),
    (8, "ISBD", "QHa", "TimeUS,N,x", "s--", "F--"),
    (9, "BAT", "QBfHe", "TimeUS,Inst,Volt,Res,Curr", "s#v%A", "F-0AB"),
    (10, "FILE", "NIBZ", "FileName,Offset,Length,Data", "----", "----"),
    (11, "MORE", "QceELMgq", "TimeUS,c,e,E,L,M,g,q", "s", "F"),
    (12, "NVF", "QNf", "TimeUS,Name,Value", "s#-", "F--"),
)  # fmt: skip
UNITS = {
    "s": "s", "d": "deg", "h": "degheading", "D": "deglatitude", "U": "deglongitude", "m": "m", "n": "m/s",
    "E": "rad/s", "o": "m/s/s", "v": "V", "%": "%", "A": "A", "#": "instance", "S": "satellites",
    "?": "UNKNOWN", "-": "",
}  # fmt: skip
FACTORS = {"-": 0.0, "?": 1.0, "0": 1.0, "A": 0.1, "B": 0.01, "F": 1e-6, "G": 1e-7}
GPS_EPOCH_US = 315_964_800_000_000


class LogWriter:
    """A log in memory.

    Args:
        types: The types to define at the beginning, as in `TYPES`; formats are cut to 16 characters.
    """

    def __init__(self, types=TYPES):
        self.data = bytearray()
        self.structs = {}
        self.numbers = {}
        self.define(FMT, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns")
        for number, name, characters, labels, *_ in types:
            self.define(number, name, characters[:16], labels)
        if any(kind[1] == "FMTU" for kind in types):
            self._units(types)

    def _units(self, types):
        for letter, name in UNITS.items():
            self.write("UNIT", 900, ord(letter), name)
        for letter, factor in FACTORS.items():
            self.write("MULT", 900, ord(letter), factor)
        for number, _, _, _, units, factors in types:
            self.write("FMTU", 900, number, units, factors)

    def define(self, number, name, characters, labels, length=None):
        """Write an FMT record; the records of `name` are written by it from here on."""
        body = struct.Struct("<" + "".join(CODES.get(letter, "B") for letter in characters))
        self.structs[name], self.numbers[name] = body, number
        length = 3 + body.size if length is None else length
        record = struct.pack(
            "<BB4s16s64s", number, length, name.encode(), characters.encode(), labels.encode()
        )
        self.data += HEADER + bytes([FMT]) + record

    def write(self, name, *values):
        """Write a record."""
        raw = [value.encode() if isinstance(value, str) else value for value in values]
        self.data += HEADER + bytes([self.numbers[name]]) + self.structs[name].pack(*raw)

    def gps(self, time_us, boot_utc_us, instance=0, status=3):
        """Write a GPS record at a time since boot, of a vehicle that booted at `boot_utc_us`."""
        since_epoch = boot_utc_us + time_us - GPS_EPOCH_US + 18_000_000
        week, rest = divmod(since_epoch, 604_800_000_000)
        place = (473977418, 85455938, 48800)
        self.write("GPS", time_us, instance, status, rest // 1000, week, 12, 81, *place, 5.5, 90.0, -0.5)


def random_values(rng, characters):
    """Return values for a record's body: extreme ones, and texts with characters behind the NUL."""
    values = []
    for letter in characters:
        code = CODES[letter]
        if code.endswith("s"):
            size = int(code[:-1])
            text = bytes(rng.choice(b"abcXYZ 0123_") for _ in range(rng.randrange(size + 1))).strip()
            values.append(rng.randbytes(size) if letter == "a" else text)
        elif code in "efd":
            values.append(
                rng.choice([0.0, -1.5, 1.0 / 3.0, float("nan"), float("inf"), rng.uniform(-6e4, 6e4)])
            )
        else:
            size = struct.calcsize(code)
            # pymavlink reads the unsigned byte of "M" as a signed one.
            raw = rng.randrange(128) if letter == "M" else int.from_bytes(rng.randbytes(size), "little")
            values.append(struct.unpack("<" + code, raw.to_bytes(size, "little"))[0])
    return values


def flight(seed=1, records=2000, boot_utc_us=1_700_000_000_000_000):
    """Return a log with all kinds of records, and random values except for times."""
    rng = random.Random(seed)
    log = LogWriter()
    log.write("MSG", 1000, "ArduCopter V4.5.7 (2a3dc4b7)")
    log.write("PARM", 1000, "SYSID_THISMAV", 7.0, 1.0)
    log.write("MODE", 1100, 5, 5, 1)
    kinds = [kind for kind in TYPES if kind[0] < FMT and kind[1] not in ("GPS", "MSG")]
    for number in range(records):
        time_us = 2000 + number * 2500
        if number % 80 == 40:
            log.gps(time_us, boot_utc_us, instance=number // 80 % 2)
            continue
        _, name, characters, *_ = rng.choice(kinds)
        values = random_values(rng, characters[:16])
        if name != "FILE":
            values[0] = time_us
        log.write(name, *values)
    return log
