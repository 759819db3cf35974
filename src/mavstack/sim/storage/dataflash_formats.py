"""Formats of an ArduPilot log: names, fields, units and multipliers of ArduPilot 4.6 and later.

A format has one letter per field. Letters that imply a factor (`c`, `C`, `e`, `E`: hundredths; `L`: degrees
times 1e7) are integers in the file. Units and multipliers have one letter per field too; the tables of these
letters are written into each log.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass

HEADER = b"\xa3\x95"
FORMAT_TYPE = 128

_CODES = {
    "n": "4s", "N": "16s", "Z": "64s", "a": "64s",
    "c": "h", "C": "H", "e": "i", "E": "I", "L": "i", "M": "B",
}  # fmt: skip

UNITS = {
    "-": "", "?": "UNKNOWN", "A": "A", "a": "Ah", "d": "deg", "b": "B", "k": "deg/s", "D": "deglatitude",
    "e": "deg/s/s", "E": "rad/s", "G": "Gauss", "h": "degheading", "i": "A.s", "J": "W.s", "l": "l",
    "L": "rad/s/s", "m": "m", "n": "m/s", "o": "m/s/s", "O": "degC", "%": "%", "S": "satellites", "s": "s",
    "q": "rpm", "r": "rad", "U": "deglongitude", "u": "ppm", "v": "V", "P": "Pa", "w": "Ohm", "W": "Watt",
    "X": "W.h", "y": "l/s", "Y": "us", "z": "Hz", "#": "instance",
}  # fmt: skip
MULTIPLIERS = {
    "-": 0.0, "?": 1.0, "2": 1e2, "1": 1e1, "0": 1.0, "A": 1e-1, "B": 1e-2, "C": 1e-3, "D": 1e-4, "E": 1e-5,
    "F": 1e-6, "G": 1e-7, "I": 1e-9, "!": 3.6, "/": 3600.0,
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class LogFormat:
    """The format of one type of record."""

    type: int
    name: str
    format: str
    labels: str
    units: str
    multipliers: str

    @property
    def codes(self) -> str:
        """Fields as a struct format."""
        return "".join(_CODES.get(letter, letter) for letter in self.format)

    @property
    def length(self) -> int:
        """Length of a record in bytes."""
        return struct.calcsize("<3s" + self.codes)

    @property
    def header(self) -> bytes:
        """First three bytes of each record."""
        return HEADER + bytes([self.type])


_CHANNELS = ",".join(f"C{number}" for number in range(1, 15))
_IMU = "TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ,EG,EA,T,GH,AH,GHz,AHz"
_GPS = "TimeUS,I,Status,GMS,GWk,NSats,HDop,Lat,Lng,Alt,Spd,GCrs,VZ,Yaw,U"
_GPA = "TimeUS,I,VDop,HAcc,VAcc,SAcc,YAcc,VV,SMS,Delta,AEl,RTCMFU,RTCMFD"
_BARO = "TimeUS,I,Alt,AltAMSL,Press,Temp,CRt,SMS,Offset,GndTemp,H,CPress"
_BAT = "TimeUS,Inst,Volt,VoltR,Curr,CurrTot,EnrgTot,Temp,Res,RemPct,H,SH"
_MAG = "TimeUS,I,MagX,MagY,MagZ,OfsX,OfsY,OfsZ,MOX,MOY,MOZ,Health,S"
_ARSP = "TimeUS,I,Airspeed,DiffPress,Temp,RawPress,Offset,U,H,Hp,TR,Pri"
_XKF1 = "TimeUS,C,Roll,Pitch,Yaw,VN,VE,VD,dPD,PN,PE,PD,GX,GY,GZ,OH"
_XKF4 = "TimeUS,C,SV,SP,SH,SM,SVT,errRP,OFN,OFE,FS,TS,SS,GPS,PI"
_VER = "TimeUS,BT,BST,Maj,Min,Pat,FWT,GH,FWS,APJ,BU,FV,IMI,ICI"
_CMD = "TimeUS,CTot,CNum,CId,Prm1,Prm2,Prm3,Prm4,Lat,Lng,Alt,Frame"

FORMATS = {
    name: LogFormat(number, name, *rest)
    for number, name, *rest in (
        (128, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns", "-b---", "-----"),
        (64, "UNIT", "QbZ", "TimeUS,Id,Label", "s--", "F--"),
        (65, "MULT", "Qbd", "TimeUS,Id,Mult", "s--", "F--"),
        (66, "FMTU", "QBNN", "TimeUS,FmtType,UnitIds,MultIds", "s---", "F---"),
        (67, "PARM", "QNff", "TimeUS,Name,Value,Default", "s---", "F---"),
        (68, "MSG", "QZ", "TimeUS,Message", "s-", "F-"),
        (69, "VER", "QBHBBBBIZHBBII", _VER, "s-------------", "F-------------"),
        (70, "MODE", "QMBB", "TimeUS,Mode,ModeNum,Rsn", "s---", "F---"),
        (71, "ARM", "QBIBB", "TimeUS,ArmState,ArmChecks,Forced,Method", "s----", "F----"),
        (72, "EV", "QB", "TimeUS,Id", "s-", "F-"),
        (73, "ERR", "QBB", "TimeUS,Subsys,ECode", "s--", "F--"),
        (74, "CMD", "QHHHffffLLfB", _CMD, "s-------DUm-", "F-------GG0-"),
        (75, "ORGN", "QBLLe", "TimeUS,Type,Lat,Lng,Alt", "s#DUm", "F-GGB"),
        (76, "ATT", "QffffffB", "TimeUS,DesRoll,Roll,DesPitch,Pitch,DesYaw,Yaw,AEKF", "sddddhh-", "F000000-"),
        (77, "POS", "QLLfff", "TimeUS,Lat,Lng,Alt,RelHomeAlt,RelOriginAlt", "sDUmmm", "FGG000"),
        (78, "IMU", "QBffffffIIfBBHH", _IMU, "s#EEEooo--O--zz", "F-000000-----00"),
        (79, "XKF1", "QBccCfffffffccce", _XKF1, "s#ddhnnnnmmmkkkm", "F-BBB0000000BBBB"),
        (80, "XKF4", "QBHHHHHfffHBIHb", _XKF4, "s#------mm-----", "F-BBBBB-??-----"),
        (81, "RCOU", "Q" + 14 * "H", "TimeUS," + _CHANNELS, "s" + 14 * "Y", "F" + 14 * "-"),
        (82, "RCIN", "Q" + 14 * "H", "TimeUS," + _CHANNELS, "s" + 14 * "Y", "F" + 14 * "-"),
        (83, "GPS", "QBBIHBcLLeffffB", _GPS, "s#-s-S-DUmnhnh-", "F--C-0BGGB000--"),
        (84, "GPA", "QBCCCCfBIHeHH", _GPA, "s#-mmnd-ssm--", "F-BBBB0-CCB--"),
        (85, "BARO", "QBfffcfIffBf", _BARO, "s#mmPOnsmO-P", "F-000B0C?0-0"),
        (86, "BAT", "QBfffffcfBBB", _BAT, "s#vvAaXOw%-%", "F-000C0?0000"),
        (87, "MAG", "QBhhhhhhhhhBI", _MAG, "s#GGGGGGGGG-s", "F-CCCCCCCCC-F"),
        (88, "ARSP", "QBffcffBBffB", _ARSP, "s#nPOPP-----", "F-00B00-----"),
    )
}  # fmt: skip
