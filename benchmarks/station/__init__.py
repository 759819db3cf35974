"""The ground station under load: processor time, clients that do not read, and the delay of a command."""
