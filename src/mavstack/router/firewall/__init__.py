"""The firewall of the router: rules that deny by default, detectors of attacks, assigned ids."""

from __future__ import annotations

from mavstack.router.firewall.alerts import Alert
from mavstack.router.firewall.config import FirewallConfig, FirewallRule, read_firewall
from mavstack.router.firewall.detector import Detector, Traffic, detector_names, make_detector
from mavstack.router.firewall.firewall import Firewall
from mavstack.router.firewall.ids import IdAssignment
from mavstack.router.peer import Peer

__all__ = [
    "Alert",
    "Detector",
    "Firewall",
    "FirewallConfig",
    "FirewallRule",
    "IdAssignment",
    "Peer",
    "Traffic",
    "detector_names",
    "make_detector",
    "read_firewall",
]
