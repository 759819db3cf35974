"""Recording of packets to files that survive a crash: tlogs, and captures for Wireshark."""

from __future__ import annotations

from mavstack.logs.recorder.formats import PCAP, RECORD_FORMATS, TLOG, RecordFormat
from mavstack.logs.recorder.recorder import Recorder

__all__ = ["PCAP", "RECORD_FORMATS", "TLOG", "RecordFormat", "Recorder"]
