"""An agent plays a task: the loop, and the visit in which three modules act as one."""
