"""A number whose conversion runs code of the test."""

from __future__ import annotations


class CallbackNumber:
    """A number that calls a function when it is converted."""

    def __init__(self, action):
        self.action = action

    def __index__(self):
        return int(self.action())

    def __float__(self):
        return float(self.action())
