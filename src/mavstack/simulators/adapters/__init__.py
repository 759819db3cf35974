"""Physics of other programs."""
