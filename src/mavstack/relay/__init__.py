"""A relay: a rendezvous server for vehicles and ground stations that both only dial out.

    rooms     who is in which room, places, paces and queues, without sockets and clock
    server    the WebSockets

A relay forwards datagrams between the host of a room and its guests. It needs the extra `web`, and
neither keys of vehicles nor any knowledge of MAVLink.
"""

from __future__ import annotations

from mavstack.relay.rooms import Limits, Rooms

__all__ = ["Limits", "Rooms"]
