"""Benchmarks of Mavstack against its peers: `python -m benchmarks`; README.md describes them."""

from tools.child_processes import end_children_with_this_process

# Here, since each module of the package can be run alone and starts vehicles or peers.
end_children_with_this_process()
