"""Fleets over Zenoh: vehicles of many gateways as one tree of keys, and as a link that shows all of them."""
