"""Reads result files and turns them into tables, plots and reports. Sees the HDF5 file only."""
