"""What a number means: which units are independent, their mean with its interval, curves, tables, pairs, the matrix."""
