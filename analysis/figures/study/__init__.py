"""Sections of the report on studies of integrators."""
