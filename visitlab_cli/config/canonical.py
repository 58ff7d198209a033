"""One text for one config: what is hashed, and what a run folder keeps."""

import hashlib
import json
from typing import Any

import yaml

from visitlab_cli.config.model import Config
from visitlab_cli.settings import as_yaml
from visitlab_cli.yaml.scalars import meaning

NOT_HASHED = ("name", "seeds", "expected", "figure")
HASH_DIGITS = 8


def canonical(config: Config) -> dict[str, Any]:
    """The whole config as plain values: `like` and `include` resolved, defaults filled in.

    Planning options of a visit whose social module does not plan are left out: there they may not be written.
    So is the `start_from` of a training that starts with nothing.
    """
    return _without_the_idle(config, as_yaml(config))


def _without_the_idle(config: Config, plain: dict[str, Any]) -> dict[str, Any]:
    for name, experiment in config.experiments.items():
        for setting in experiment.idle(config.agents):
            plain["experiments"][name].pop(setting, None)
    return plain


def hashed(config: Config) -> dict[str, Any]:
    """What decides a result: the canonical config without what is `NOT_HASHED` and later settings' defaults."""
    plain = _without_the_idle(config, as_yaml(config, hashed=True))
    return {key: value for key, value in plain.items() if key not in NOT_HASHED}


def canonical_json(config: Config) -> str:
    """The text that is hashed: keys sorted, no white space."""
    return json.dumps(hashed(config), sort_keys=True, separators=(",", ":"), allow_nan=False)


def config_hash(config: Config) -> str:
    """8 hex digits: configs that differ only in name, number of seeds, expected values or figure share them."""
    return hashlib.sha256(canonical_json(config).encode()).hexdigest()[:HASH_DIGITS]


class _Dumper(yaml.SafeDumper):
    """Writes so that our reader, which reads YAML 1.2, reads the same; no anchors."""

    def ignore_aliases(self, data: Any) -> bool:
        return True


def _text(dumper: yaml.SafeDumper, text: str) -> yaml.ScalarNode:
    quoted = not isinstance(_meaning(text), str)
    style = "|" if "\n" in text else '"' if quoted else None
    return dumper.represent_scalar("tag:yaml.org,2002:str", text, style=style)


def _meaning(text: str) -> Any:
    try:
        return meaning(text)
    except ValueError:
        return None


_Dumper.add_representer(str, _text)


def dump_yaml(config: Config) -> str:
    """A config file that loads as an equal config with the same hash; the same text for equal configs."""
    return _dump(canonical(config))


def hashed_yaml(config: Config) -> str:
    """What decides a result, as YAML: the same whatever the number of seeds."""
    return _dump(hashed(config))


def _dump(plain: dict[str, Any]) -> str:
    return yaml.dump(
        plain,
        Dumper=_Dumper,
        sort_keys=False,
        default_flow_style=None,
        allow_unicode=True,
        width=110,
    )
