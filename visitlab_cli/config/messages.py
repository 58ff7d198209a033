"""Pydantic's errors in our words, with paths as the YAML has them."""

from collections.abc import Iterator
from functools import cache
from typing import Any, Literal, get_args, get_origin

from pydantic import BaseModel, Tag, ValidationError
from pydantic_core import ErrorDetails

from visitlab_cli.config.labs import FORMS, MapError
from visitlab_cli.config.model import Config
from visitlab_cli.config.names import MODULE_PATTERN, MODULE_RULE, NAME_RULE
from visitlab_cli.kinds import KIND, UNSAID
from visitlab_cli.settings import SOME, WORD, key_of, keys_of
from visitlab_cli.wording import MEANT, or_else, shown
from visitlab_cli.yaml.problems import Issue, Path

EXTRA_KEYS: dict[str, tuple[str, ...]] = {"": ("include",), "humans": ("like",), "labs": ("like",), "agents": ("like",)}
"""Keys that are resolved before validation."""

TAGS = (WORD, SOME)
"""Of what may be a word or else."""
OF_OTHERS = "; for one of somebody else's install its package, or name its file by --plugin"
_BOUNDS = {
    "greater_than_equal": ("at least", "ge"),
    "greater_than": ("more than", "gt"),
    "less_than_equal": ("at most", "le"),
    "less_than": ("less than", "lt"),
    "multiple_of": ("a multiple of", "multiple_of"),
}
_TYPES = {
    "int_type": "a whole number",
    "float_type": "a number",
    "finite_number": "a finite number",
    "bool_type": "true or false",
    "list_type": "a list",
    "tuple_type": "a list",
    "dict_type": "a mapping",
    "model_type": "a mapping",
    "model_attributes_type": "a mapping",
}


def issues_of(error: ValidationError, model: type[Config] = Config) -> list[Issue]:
    """What pydantic found wrong with a config of the type `model`, as issues of the config."""
    found = [each for each in error.errors(include_url=False) if not _is_echo(each)]
    return [
        issue for each in found for issue in (_of_map(each, model) or _of_no_form(each, model) or [_issue(each, model)])
    ]


def _of_map(error: ErrorDetails, config: type[Config]) -> list[Issue]:
    """The faults of a map, each where it stands in it; none of what is no map."""
    cause = error.get("ctx", {}).get("error")
    faults = cause.faults if isinstance(cause, MapError) else ()
    path = _without_tags(error["loc"], config)
    return [Issue(path, fault.message, within=(fault.line, fault.column)) for fault in faults]


def _of_no_form(error: ErrorDetails, config: type[Config]) -> list[Issue]:
    """What is wrong with a lab that says neither a map nor rooms, and so is of no form."""
    path = error["loc"]
    if error["type"] != "union_tag_not_found" or path[:-1] != ("labs",):
        return []
    forms = [*_models(config.model_fields["labs"].annotation)]
    known = sorted({key for form in forms for key in keys_of(form)} | set(EXTRA_KEYS["labs"]))
    unknown = [
        Issue((*path, key), f"unknown{or_else(key, known)}", at="key") for key in error["input"] if key not in known
    ]
    return [*unknown, Issue(path, f"must have {' or '.join(FORMS)}", at="key")]


def _is_echo(error: ErrorDetails) -> bool:
    """Whether a list is only called too short because entries of it are wrong, which is told anyway."""
    return error["type"] == "too_short" and len(error["input"]) >= error["ctx"]["min_length"]


def _issue(error: ErrorDetails, config: type[Config]) -> Issue:
    kind, loc = error["type"], error["loc"]
    path = _without_tags(loc, config)
    if kind == "missing":
        return Issue(path, "missing")
    if kind == "extra_forbidden":
        name, known = loc[-1], sorted(_known_keys(loc[:-1], config))
        why = getattr(_model_at(loc[:-1], config), "never", {}).get(name)
        instead = f" of this kind: {why}; leave it out" if why else or_else(name, known)
        return Issue(path, f"unknown{instead}", at="key")
    if kind in ("union_tag_not_found", "union_tag_invalid"):
        return _wrong_tag(error, path)
    left_out = _left_out(loc, config) if error["input"] is None else ""
    message = _message(error, f"{shown(error['input'])}{left_out}")
    return Issue(path[:-1], message, at="key") if loc[-1:] == ("[key]",) else Issue(path, message)


def _left_out(loc: Path, config: type[Config]) -> str:
    """What a key stands for that is not there, where it may be left out: who says nothing probably means that."""
    model = _model_at(loc[:-1], config)
    default = next(
        (field.default for name, field in model.model_fields.items() if key_of(model, name) == loc[-1]), None
    )
    return f"; left out it is {shown(default)}" if isinstance(default, bool | int | float | str) else ""


def _message(error: ErrorDetails, got: str) -> str:
    kind, context, given = error["type"], error.get("ctx", {}), error["input"]
    if kind in _BOUNDS:
        words, bound = _BOUNDS[kind]
        return f"must be {words} {context[bound]:.15g} (got {got})"
    if kind in _TYPES:
        return f"must be {_TYPES[kind]} (got {got})"
    if kind == "string_type":
        quoted = "" if isinstance(given, dict | list) or given is None else "; put it in quotes"
        return f"must be text (got {got}{quoted})"
    if kind == "string_pattern_mismatch":
        rule = MODULE_RULE if context["pattern"] == MODULE_PATTERN else NAME_RULE
        return f"{rule} (got {got})"
    if kind in ("too_short", "too_long"):
        words, bound = ("at least", "min_length") if kind == "too_short" else ("at most", "max_length")
        return f"must have {words} {_entries(context[bound])} (got {len(given)})"
    if kind == "literal_error":
        return f"must be {context['expected'].replace(chr(39), '')} (got {got})"
    if kind == "value_error":
        return str(context["error"])
    return f"{error['msg']} (got {got})"


def _entries(count: int) -> str:
    return "1 entry" if count == 1 else f"{count} entries"


def _wrong_tag(error: ErrorDetails, path: Path) -> Issue:
    tag = error["ctx"]["discriminator"].strip("'()")
    if tag not in error["input"]:
        return Issue((*path, tag), "missing")
    known = [each for each in error["ctx"]["expected_tags"].replace("'", "").split(", ") if each != UNSAID]
    given = error["input"][tag]
    instead = or_else(given, known)
    is_theirs = tag == KIND and isinstance(given, str) and not instead.startswith(MEANT)
    return Issue((*path, tag), f"no such {tag}: {shown(given)}{instead}{OF_OTHERS if is_theirs else ''}")


def _without_tags(loc: Path, config: type[Config]) -> Path:
    """Pydantic puts the tag of a union after the name of what may be of several forms; the YAML has no such level."""
    if loc and loc[0] in _tagged_sections(config) and loc[2:] != ("[key]",):
        loc = loc[:2] + loc[3:]
    return tuple(part for part in loc if part not in TAGS)


def _known_keys(loc: Path, config: type[Config]) -> Iterator[str]:
    """The keys that the mapping at `loc` (with tags) may have."""
    yield from keys_of(_model_at(loc, config))
    yield from EXTRA_KEYS.get(str(loc[0]) if loc else "", ())


def _model_at(loc: Path, config: type[Config]) -> type[BaseModel]:
    """The model of the mapping at `loc` (with tags)."""
    model: type[BaseModel] = config
    for part in loc:
        field = next((found for name, found in model.model_fields.items() if key_of(model, name) == part), None)
        fitting = list(_models(field.annotation if field else None))
        if not fitting and loc[0] in _tagged_sections(config):
            annotation = config.model_fields[str(loc[0])].annotation
            fitting = [found for found, tag in _tagged(annotation) if part == tag or _has_tag(found, part)]
        if len(fitting) == 1:
            model = fitting[0]
    return model


def _models(annotation: Any) -> Iterator[type[BaseModel]]:
    for model, _ in _tagged(annotation):
        yield model


def _tagged(annotation: Any, tag: str | None = None) -> Iterator[tuple[type[BaseModel], str | None]]:
    """The models in a type, each with the tag that it is given there; None where its own fields say it."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation, tag
    elif get_origin(annotation) is not Literal:
        inner = get_args(annotation)
        tags = [each.tag for each in inner if isinstance(each, Tag)]
        for each in inner:
            yield from _tagged(each, tags[0] if tags else tag)


def _has_tag(model: type[BaseModel], tag: str | int) -> bool:
    if tag == UNSAID:
        return KIND not in model.model_fields
    return any(
        get_origin(field.annotation) is Literal and get_args(field.annotation) == (tag,)
        for field in model.model_fields.values()
    )


@cache
def _tagged_sections(config: type[Config]) -> list[str]:
    """Where the name of an entry is followed by which of several models it is of, in pydantic's paths."""
    sections = ("humans", "labs", "agents", "experiments")
    return [section for section in sections if len(list(_models(config.model_fields[section].annotation))) > 1]
