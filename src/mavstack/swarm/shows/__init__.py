"""Shows: trajectories of many vehicles on one clock, read from files, checked, and written for vehicles."""
