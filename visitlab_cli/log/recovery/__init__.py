"""Saving what is whole of a log that was cut or damaged."""
