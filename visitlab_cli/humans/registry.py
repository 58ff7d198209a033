"""Every kind of human, found by listing this folder: what the config and the documentation ask."""

from visitlab_cli.humans.six_parameters import SixParameters

AnyHuman = SixParameters
