"""A plug-in that prints, goes to another folder, and ends the process that it is in."""

import os
import signal
from typing import Literal

import numpy as np

from visitlab_cli import AgentParameters

print("imported")
os.chdir("/")


class RudeParameters(AgentParameters):
    kind: Literal["rude"]
    does: Literal["leave", "crash", "wander"]

    def agent(self, setting):
        return Rude(self.does)


class Rude:
    def __init__(self, does):
        self.does = does

    def act(self, state, random, step):
        if step == 1:
            print(self.does, flush=True)
            os.write(1, b"past Python\n")
            if self.does == "leave":
                os._exit(0)
            if self.does == "crash":
                signal.signal(signal.SIGSEGV, signal.SIG_DFL)
                os.kill(os.getpid(), signal.SIGSEGV)
            os.chdir("/")
        return 0

    def learn(self, *transition):
        pass

    def arrays(self):
        return {"table": np.zeros(2)}

    def restore(self, arrays):
        pass
