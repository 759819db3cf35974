"""The inspector of `mav watch --tui`: a model that is fed by packets, and the window that draws it."""
