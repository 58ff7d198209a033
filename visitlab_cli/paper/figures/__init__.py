"""The figures of the paper from a run's data."""
