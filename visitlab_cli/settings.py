"""What a setting is: the base of everything that a config declares, and its settings as the YAML has them again.

Writing and reading are inverse: what stands here under a setting's key, sets in order, is what the key may be given.
"""

import json
from collections.abc import Set
from functools import cache
from typing import Any, NamedTuple

from pydantic import AliasChoices, BaseModel, ConfigDict
from pydantic.fields import FieldInfo
from pydantic_core import PydanticUndefined, to_jsonable_python

_SINCE = "since"
WORD, SOME = "<word>", "<some>"
"""What pydantic calls the forms of a setting that is a word, or else a mapping or a list."""


class Settings(BaseModel):
    """A part of a config: frozen, an unknown key is an error, and a default is the value that writing it gives."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False, validate_default=True)


def since(version: str) -> dict[str, Any]:
    """The `json_schema_extra` of a field that came with a `version`: at its default it stays out of a run's hash.

    Else every run made before would get another hash, and be made again, for a setting that changes nothing of it.
    """
    return {_SINCE: version}


def since_of(field: FieldInfo) -> str | None:
    """The version that a field came with; None for one that was always there."""
    extra = field.json_schema_extra
    return str(extra[_SINCE]) if isinstance(extra, dict) and _SINCE in extra else None


def key_of(model: type[BaseModel], name: str) -> str:
    """What the YAML calls a field of `model`: its name, or its alias."""
    field = model.model_fields.get(name)
    alias = field.validation_alias if field is not None else None
    choices = alias.choices if isinstance(alias, AliasChoices) else [alias]
    return next((choice for choice in choices if isinstance(choice, str)), name)


def keys_of(model: type[BaseModel]) -> list[str]:
    """What the YAML calls the fields of `model`."""
    return [key_of(model, name) for name in model.model_fields]


def as_yaml(settings: BaseModel, *, hashed: bool = False) -> dict[str, Any]:
    """Settings as plain values by their keys; those `hashed` are without what came later and is at its default."""
    return _entries(settings, settings.model_dump(mode="json", by_alias=True, serialize_as_any=True), hashed)


def at_default(settings: BaseModel) -> set[str]:
    """The keys of those settings that have the value that leaving them out gives."""
    plain = as_yaml(settings)
    return {field.key for field in _fields(type(settings)) if field.key in plain and plain[field.key] == field.default}


def defaults_of(model: type[BaseModel]) -> dict[str, tuple[bool, Any]]:
    """Whether a setting has a default, and which, as plain values, by its key."""
    return {field.key: (field.default is not PydanticUndefined, field.default) for field in _fields(model)}


class _Field(NamedTuple):
    """A field: its name in Python, in what pydantic makes of it, in the YAML; and whether it came later."""

    name: str
    written: str
    key: str
    later: bool
    default: Any  # as plain values; `PydanticUndefined` where it must be given


@cache
def _fields(model: type[BaseModel]) -> list[_Field]:
    return [
        _Field(
            name,
            field.serialization_alias or name,
            key_of(model, name),
            since_of(field) is not None,
            _default(field),
        )
        for name, field in model.model_fields.items()
    ]


def _default(field: FieldInfo) -> Any:
    if field.is_required():
        return PydanticUndefined
    default = field.get_default(call_default_factory=True)
    return _plain(default, to_jsonable_python(default, by_alias=True, fallback=repr), hashed=True)


def _plain(value: Any, dumped: Any, hashed: bool) -> Any:
    """`dumped`, which pydantic made of `value`, by the keys that are read, and in the same order each time."""
    if isinstance(dumped, dict):
        if isinstance(value, BaseModel):
            return _entries(value, dumped, hashed)
        if isinstance(value, dict) and len(value) == len(dumped):
            pairs = zip(value.values(), dumped.items(), strict=True)
            return {key: _plain(inner, made, hashed) for inner, (key, made) in pairs}
    elif isinstance(dumped, list) and isinstance(value, list | tuple | Set) and len(value) == len(dumped):
        entries = [_plain(inner, made, hashed) for inner, made in zip(value, dumped, strict=True)]
        return sorted(entries, key=json.dumps) if isinstance(value, Set) else entries
    return dumped


def _entries(settings: BaseModel, dumped: dict[str, Any], hashed: bool) -> dict[str, Any]:
    plain = {}
    for field in _fields(type(settings)):
        if field.written in dumped:
            entry = _plain(getattr(settings, field.name), dumped[field.written], hashed)
            if not (hashed and field.later and entry == field.default):
                plain[field.key] = entry
    extra = settings.model_extra or {}  # of what stands for a kind that is not installed
    return plain | {key: _plain(extra[key], dumped[key], hashed) for key in sorted(extra)}
