"""A second, independent reading of the rules, in plain Python: it replays the package's logs.

Nothing here imports the package, except the enums.
"""
