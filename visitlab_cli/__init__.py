"""visitlab: run, record and replay the 'visit the lab' task (Chartouny, Amini, Khamassi and Girard, 2024)."""

__version__ = "0.1.0"
