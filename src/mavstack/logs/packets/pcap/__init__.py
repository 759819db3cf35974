"""Captures of network traffic (pcap and pcapng) as logs of packets."""

from __future__ import annotations

from mavstack.logs.packets.pcap.capture_log import CaptureLog
from mavstack.logs.packets.pcap.flows import Flow, FlowKey

__all__ = ["CaptureLog", "Flow", "FlowKey"]
