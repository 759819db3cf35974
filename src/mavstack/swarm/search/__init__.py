"""Search and survey: patterns, areas, shares of several vehicles, and the missions that fly them."""
