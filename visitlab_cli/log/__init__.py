"""The log of a cell: its columns as a schema, writer and readers; in `recovery/` what is whole of a damaged one."""
