"""Tests of the documentation site: its code, its commands and its generated pages."""
