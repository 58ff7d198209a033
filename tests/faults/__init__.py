"""What goes wrong around a run, done for real and counted: `python -m tests.faults`."""
