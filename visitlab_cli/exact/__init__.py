"""What is possible at all: the exact values of tasks in which only the robot moves, no simulation."""
