"""A step in 3D: one HTML page."""
