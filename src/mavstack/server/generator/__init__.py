"""The generator of libraries in a process of its own: bounded in time, memory and number."""
