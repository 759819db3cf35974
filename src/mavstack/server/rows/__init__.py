"""Rows of values from sources that do not speak MAVLink: lines of text with separated values."""
