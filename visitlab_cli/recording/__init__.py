"""The log of a cell: schema, MCAP writer and reader."""
