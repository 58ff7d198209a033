"""Which cells a config asks for, on what they depend, what they cost, and what a finished one holds."""
