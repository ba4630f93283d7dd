"""Tables from results, without matplotlib: what a notebook wants."""
