"""DataFlash logs (`.BIN`) to columns: a generated flight of an ArduCopter, read by Mavstack and by pymavlink.

The log is a cycle of records, repeated with advancing times: the records of one second at the rates of a
usual LOG_BITMASK, with random values. numpy writes it; neither reader takes part.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

import mavstack

from .measure import PYMAVLINK
from .onboard_logs import OnboardLog, measure
from .peers_pymavlink import gather

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    from numpy.typing import NDArray

    from .measure import Row
    from .rows import Bench

SEED: Final = 20150101
SLICE_SIZE: Final = 4_000_000
#: Length of a field by format character.
LENGTHS: Final = {
    **dict.fromkeys("bBM", 1),
    **dict.fromkeys("hHcC", 2),
    **dict.fromkeys("iIeELf", 4),
    "Q": 8,
    "n": 4,
    "N": 16,
    "Z": 64,
}
_HEADER, _FMT, _FIRST_TYPE = b"\xa3\x95", 128, 140


@dataclass(frozen=True, slots=True)
class RecordKind:
    """A record type: its name, its rate in hertz, the format characters and the labels after TimeUS."""

    name: str
    hertz: int
    format: str
    labels: str

    @property
    def length(self) -> int:
        """Length of a record in bytes."""
        return 3 + sum(LENGTHS[character] for character in self.format)


def _floats(name: str, hertz: int, labels: str) -> RecordKind:
    return RecordKind(name, hertz, "Q" + "f" * len(labels.split(",")), labels)


KINDS: Final = (
    RecordKind("IMU", 50, "QBffffffIIfBBHH", "I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ,EG,EA,T,GH,AH,GHz,AHz"),
    RecordKind("ATT", 20, "QccccCCCCB", "DesRoll,Roll,DesPitch,Pitch,DesYaw,Yaw,ErrRP,ErrYaw,AEKF"),
    _floats("RATE", 20, "RDes,R,ROut,PDes,P,POut,YDes,Y,YOut,ADes,A,AOut,AOutSlew"),
    _floats("PIDR", 20, "Tar,Act,Err,P,I,D,FF,DFF,Dmod,SRate"),
    _floats("PIDP", 20, "Tar,Act,Err,P,I,D,FF,DFF,Dmod,SRate"),
    _floats("PIDY", 20, "Tar,Act,Err,P,I,D,FF,DFF,Dmod,SRate"),
    RecordKind("XKF1", 20, "QBccCfffffffccce", "C,Roll,Pitch,Yaw,VN,VE,VD,dPD,PN,PE,PD,GX,GY,GZ,OH"),
    RecordKind("XKF2", 20, "QBccccchhhhhhfff", "C,AX,AY,AZ,VWN,VWE,MN,ME,MD,MX,MY,MZ,IDX,IDY,IS"),
    RecordKind("XKF3", 20, "QBcccccchhhccff", "C,IVN,IVE,IVD,IPN,IPE,IPD,IMX,IMY,IMZ,IYAW,IVT,RErr,ErSc"),
    RecordKind("XKF4", 20, "QBcccccfffHBIHb", "C,SV,SP,SH,SM,SVT,errRP,OFN,OFE,FS,TS,SS,GPS,PI"),
    _floats("XKQ", 20, "Q1,Q2,Q3,Q4"),
    RecordKind("AHR2", 20, "QccCfLLffff", "Roll,Pitch,Yaw,Alt,Lat,Lng,Q1,Q2,Q3,Q4"),
    RecordKind("POS", 20, "QLLfff", "Lat,Lng,Alt,RelHomeAlt,RelOriginAlt"),
    RecordKind("CTUN", 10, "Qffffffefhhf", "ThI,ABst,ThO,ThH,DAlt,Alt,BAlt,DSAlt,SAlt,TAlt,DCRt"),
    RecordKind("BARO", 10, "QBffcfIffB", "I,Alt,Press,Temp,CRt,SMS,Offset,GndTemp,H"),
    RecordKind("MAG", 10, "QBhhhhhhhhhBI", "I,MagX,MagY,MagZ,OfsX,OfsY,OfsZ,MOX,MOY,MOZ,Health,S"),
    RecordKind("BAT", 10, "QBfffffcfB", "Inst,Volt,VoltR,Curr,CurrTot,EnrgTot,Temp,Res,RemPct"),
    RecordKind("VIBE", 10, "QBfffI", "IMU,VibeX,VibeY,VibeZ,Clip"),
    RecordKind("RCIN", 10, "Q" + "H" * 14, ",".join(f"C{number}" for number in range(1, 15))),
    RecordKind("RCOU", 10, "Q" + "H" * 14, ",".join(f"C{number}" for number in range(1, 15))),
    RecordKind("GPS", 5, "QBBIHBcLLeffffB", "I,Status,GMS,GWk,NSats,HDop,Lat,Lng,Alt,Spd,GCrs,VZ,Yaw,U"),
    RecordKind("GPA", 5, "QBCCCCfBIHfHH", "I,VDop,HAcc,VAcc,SAcc,YAcc,VV,SMS,Delta,Und,RTCMFU,RTCMFD"),
    RecordKind("MSG", 1, "QZ", "Message"),
)


def write(path: Path, size: int) -> int:
    """Write a log of about `size` bytes; return its number of records."""
    head = b"".join(_fmt(number, kind) for number, kind in enumerate(KINDS, _FIRST_TYPE))
    cycle, times = _cycle()
    turns = size // len(cycle)
    data = np.tile(cycle, (turns, 1))
    seconds = np.arange(1, turns + 1, dtype="<u8") * 1_000_000
    for number, start in enumerate(times):
        stamps = seconds + np.uint64(number * 1_000_000 // len(times))
        data[:, start : start + 8] = stamps.view(np.uint8).reshape(turns, 8)
    with path.open("wb") as file:
        file.write(head)
        data.tofile(file)
    return len(KINDS) + turns * len(times)


def _fmt(number: int, kind: RecordKind) -> bytes:
    labels = f"TimeUS,{kind.labels}".encode()
    texts = ((kind.name.encode(), 4), (kind.format.encode(), 16), (labels, 64))
    return (
        _HEADER
        + bytes([_FMT, number, kind.length])
        + b"".join(text.ljust(size, b"\0") for text, size in texts)
    )


def _cycle() -> tuple[NDArray[np.uint8], list[int]]:
    """Return the records of one second, and the positions of their times."""
    random = np.random.default_rng(SEED)
    due = sorted(
        (turn / kind.hertz, number) for number, kind in enumerate(KINDS) for turn in range(kind.hertz)
    )
    records, times, end = [], [], 0
    for _, number in due:
        kind = KINDS[number]
        # Small numbers and text: no NaN, which compare unequal, and no header.
        body = random.integers(32, 96, kind.length - 3, np.uint8)
        records.append(np.frombuffer(_HEADER + bytes([_FIRST_TYPE + number]) + body.tobytes(), np.uint8))
        times.append(end + 3)
        end += kind.length
    return np.concatenate(records), times


def pymavlink_columns(path: Path) -> dict[str, dict[str, NDArray[Any]]]:
    """Decode a log to columns with pymavlink: all messages and all fields."""
    from pymavlink import DFReader

    return gather(DFReader.DFReader_binary(str(path)), times=False)


def our_columns(path: Path, threads: int = 0) -> dict[str, Any]:
    """Decode a log to columns: all records and all fields; by default on all cores."""
    log = mavstack.open_log(path, threads=threads)
    log.load()
    return dict(log)


def _count(tables: Mapping[str, Any]) -> int:
    return sum(len(table["Type" if name == "FMT" else "TimeUS"]) for name, table in tables.items())


def _assert_equal(path: Path) -> None:
    """Raise if both readers decode different columns."""
    ours, theirs = our_columns(path), pymavlink_columns(path)
    for name, table in theirs.items():
        for field, column in table.items():
            if column.dtype.kind in "iuf" and not (ours[name][field] == column).all():
                raise RuntimeError(f"{name}.{field} differs")


LOG: Final = OnboardLog(
    ".BIN", SLICE_SIZE, write, _assert_equal, _count, our_columns, PYMAVLINK, pymavlink_columns, 100, "ATT"
)


def rows(bench: Bench, *, quick: bool) -> Iterator[Row]:
    """Compare speed and memory of decoding a log; the peer reads a part of it."""
    return measure(bench, LOG, quick=quick)
