"""The commands: one file each, which parses, calls and prints; nothing heavy is imported at module level."""
