"""The analysis of a flight: signals that every format has, and rules that look for faults in them."""

from __future__ import annotations

from mavstack.logs.analysis.findings import Finding, Severity
from mavstack.logs.analysis.flight import Flight, flights
from mavstack.logs.analysis.rules import Rule, all_rules, analyse
from mavstack.logs.analysis.signals import SIGNALS, Signal, read_signal

__all__ = [
    "SIGNALS",
    "Finding",
    "Flight",
    "Rule",
    "Severity",
    "Signal",
    "all_rules",
    "analyse",
    "flights",
    "read_signal",
]
