"""Measurements of Mavstack against its peers; `python -m benchmarks`, read README.md first."""
