"""Many vehicles in one process: the CPU time, the memory and the losses of their receiver.

`python -m benchmarks.fleets` prints a row for each fleet: a program that follows all vehicles and reads their
positions, beside a bare reader of the same datagrams. `--growth` prints the CPU time of a packet by the
number of vehicles and of subscriptions, `--plot FILE` draws it too.
"""
