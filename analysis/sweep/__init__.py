"""Sweeps: one configuration at many points, each a process and a result file; Snakemake schedules."""
