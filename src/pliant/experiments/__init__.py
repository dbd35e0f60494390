"""The engine: runs, sweeps, results, searches, for any study."""
