"""Satellite navigation beside MAVLink, sans-IO: RTCM frames, NTRIP, NMEA sentences, u-blox bases."""

from mavstack.gnss.nmea import Fix, NmeaFramer, format_gga, format_rmc, sentence
from mavstack.gnss.ntrip import CasterError, NtripClient, NtripURL, SourceTableEntry
from mavstack.gnss.rtcm import RtcmFrame, RtcmFramer, crc24q

__all__ = [
    "CasterError",
    "Fix",
    "NmeaFramer",
    "NtripClient",
    "NtripURL",
    "RtcmFrame",
    "RtcmFramer",
    "SourceTableEntry",
    "crc24q",
    "format_gga",
    "format_rmc",
    "sentence",
]
