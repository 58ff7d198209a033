"""A run as the jobs of a cluster's queue: how many cells a job does, the script of a job, handing it in."""
