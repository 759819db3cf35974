"""Benchmarks of Mavstack against its peers: `python -m benchmarks`; README.md describes them."""
