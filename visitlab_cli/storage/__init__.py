"""Run folders and cells on the disk."""
