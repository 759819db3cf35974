"""Attacks on a router from outside, with figures: ours beside MAVProxy and mavlink-router.

`python -m tools.attacks` runs each attack over real sockets against a router between a vehicle without
signing and a ground station that signs, and prints a table. Routers that are not installed are left out. It
needs Linux.
"""
