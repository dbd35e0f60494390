"""Runs, sweeps, results and parameter searches of any study."""
