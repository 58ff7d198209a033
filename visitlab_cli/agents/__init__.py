"""The agents: one file an algorithm, each with its parameters, its record of arrays and its kernels."""
