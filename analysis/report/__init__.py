"""The report: one HTML page of findings, figures and tables."""
