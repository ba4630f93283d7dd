"""Figures of errors: against cost, by kind; and of what methods cost besides time."""
