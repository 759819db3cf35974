"""Tests of the languages of `mav gen`."""
