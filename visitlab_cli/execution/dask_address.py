"""Where a Dask scheduler is, in words of a user, and whether others reach what listens there."""

import ipaddress
import json
import re
from pathlib import Path
from typing import NamedTuple

from visitlab_cli.errors import NotFoundError, RunError, UsageError, reason
from visitlab_cli.wording import printable

_LABEL = r"[A-Za-z0-9_]([A-Za-z0-9_-]{0,61}[A-Za-z0-9_])?"
_ADDRESS = re.compile(
    rf"(?P<scheme>tcp|tls)://(?P<host>{_LABEL}(\.{_LABEL})*\.?|\[[0-9A-Fa-f:.]+\]):(?P<port>[0-9]{{1,5}})", re.ASCII
)
LARGEST_PORT = 65535


class At(NamedTuple):
    """Where the scheduler is: its address, or the file in which it wrote that; neither: a cluster of our own."""

    address: str = ""
    scheduler_file: Path | None = None

    def resolved(self) -> str:
        """The address; empty where the cluster is to be our own.

        Raises:
            UsageError: it is none.
            NotFoundError: there is no such file.
            RunError: the file is not a scheduler's.
        """
        if self.scheduler_file is None:
            if self.address and _parts(self.address) is None:
                form = f"tcp://HOST:PORT or tls://HOST:PORT, with a port from 1 to {LARGEST_PORT}"
                raise UsageError(f"--address {printable(self.address)}: must be {form}")
            return self.address
        name = printable(str(self.scheduler_file))
        try:
            address = json.loads(self.scheduler_file.read_text(encoding="utf-8"))["address"]
        except FileNotFoundError:
            raise NotFoundError(f"{name}: no such file; dask scheduler --scheduler-file writes it") from None
        except OSError as error:
            raise RunError(f"{name}: can't be read: {reason(error)}") from error
        except (ValueError, KeyError, TypeError):
            address = None
        if not isinstance(address, str) or _parts(address) is None:
            raise RunError(f"{name}: is no scheduler file of Dask")
        return address


def _parts(address: str) -> "re.Match[str] | None":
    """The scheme, host and port of an address; None where it can be none."""
    found = _ADDRESS.fullmatch(address)
    if found is None or not 0 < int(found["port"]) <= LARGEST_PORT:
        return None
    host = found["host"].strip("[]")
    if ":" in host or host.replace(".", "").isdigit():
        try:
            ipaddress.ip_address(host)
        except ValueError:
            return None
    return found


def is_exposed(address: str) -> bool:
    """Whether others than those on this machine may reach an address, unencrypted."""
    found = _parts(address)
    if found is None or found["scheme"] == "tls" or found["host"] == "localhost":
        return found is None
    try:
        return not ipaddress.ip_address(found["host"].strip("[]")).is_loopback
    except ValueError:
        return True
