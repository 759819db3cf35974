"""Files of ground stations: mission plans and parameter sets."""
