"""The schemas of Foxglove that an export uses, under their published names and numbers (docs.foxglove.dev, protobuf).

Whole schemas, also the fields that stay empty: a viewer may expect them.
"""

from functools import cache
from typing import Any

from google.protobuf import duration_pb2, timestamp_pb2
from google.protobuf.descriptor_pb2 import DescriptorProto, FieldDescriptorProto, FileDescriptorProto, FileDescriptorSet
from google.protobuf.descriptor_pool import DescriptorPool
from google.protobuf.message_factory import GetMessageClass

PACKAGE = "foxglove"
SCENE_UPDATE, FRAME_TRANSFORMS, LOG = "SceneUpdate", "FrameTransforms", "Log"

_SCALARS = {
    "double": FieldDescriptorProto.TYPE_DOUBLE,
    "fixed32": FieldDescriptorProto.TYPE_FIXED32,
    "bool": FieldDescriptorProto.TYPE_BOOL,
    "string": FieldDescriptorProto.TYPE_STRING,
    "bytes": FieldDescriptorProto.TYPE_BYTES,
}
_WELL_KNOWN = {"Timestamp": timestamp_pb2, "Duration": duration_pb2}
_ENUMS = {
    "SceneEntityDeletion": ("MATCHING_ID", "ALL"),
    "LinePrimitive": ("LINE_STRIP", "LINE_LOOP", "LINE_LIST"),
    "Log": ("UNKNOWN", "DEBUG", "INFO", "WARNING", "ERROR", "FATAL"),
}
_REPEATED = "*"
# Each field is its type and its name; the first has the number 1.
_MESSAGES = {
    "Vector3": "double x, double y, double z",
    "Point3": "double x, double y, double z",
    "Quaternion": "double x, double y, double z, double w",
    "Color": "double r, double g, double b, double a",
    "Pose": "Vector3 position, Quaternion orientation",
    "KeyValuePair": "string key, string value",
    "ArrowPrimitive": "Pose pose, double shaft_length, double shaft_diameter, double head_length, "
    "double head_diameter, Color color",
    "CubePrimitive": "Pose pose, Vector3 size, Color color",
    "SpherePrimitive": "Pose pose, Vector3 size, Color color",
    "CylinderPrimitive": "Pose pose, Vector3 size, double bottom_scale, double top_scale, Color color",
    "LinePrimitive": "Type type, Pose pose, double thickness, bool scale_invariant, Point3* points, Color color, "
    "Color* colors, fixed32* indices",
    "TriangleListPrimitive": "Pose pose, Point3* points, Color color, Color* colors, fixed32* indices",
    "TextPrimitive": "Pose pose, bool billboard, double font_size, bool scale_invariant, Color color, string text",
    "ModelPrimitive": "Pose pose, Vector3 scale, Color color, bool override_color, string url, string media_type, "
    "bytes data",
    "SceneEntity": "Timestamp timestamp, string frame_id, string id, Duration lifetime, bool frame_locked, "
    "KeyValuePair* metadata, ArrowPrimitive* arrows, CubePrimitive* cubes, SpherePrimitive* spheres, "
    "CylinderPrimitive* cylinders, LinePrimitive* lines, TriangleListPrimitive* triangles, TextPrimitive* texts, "
    "ModelPrimitive* models",
    "SceneEntityDeletion": "Timestamp timestamp, Type type, string id",
    "SceneUpdate": "SceneEntityDeletion* deletions, SceneEntity* entities",
    "FrameTransform": "Timestamp timestamp, string parent_frame_id, string child_frame_id, Vector3 translation, "
    "Quaternion rotation",
    "FrameTransforms": "FrameTransform* transforms",
    "Log": "Timestamp timestamp, Level level, string message, string name, string file, fixed32 line",
}


def file_descriptor() -> FileDescriptorProto:
    """All the messages as one .proto file."""
    return FileDescriptorProto(
        name="foxglove.proto",
        package=PACKAGE,
        syntax="proto3",
        dependency=[module.DESCRIPTOR.name for module in _WELL_KNOWN.values()],
        message_type=[_message(name, fields) for name, fields in _MESSAGES.items()],
    )


def schema_bytes() -> bytes:
    """The schema as MCAP carries it, with what it imports."""
    files = [FileDescriptorProto.FromString(module.DESCRIPTOR.serialized_pb) for module in _WELL_KNOWN.values()]
    return FileDescriptorSet(file=[*files, file_descriptor()]).SerializeToString(deterministic=True)


@cache
def message_class(name: str) -> Any:
    """The class of a message."""
    pool = DescriptorPool()
    for file in FileDescriptorSet.FromString(schema_bytes()).file:
        pool.Add(file)
    return GetMessageClass(pool.FindMessageTypeByName(f"{PACKAGE}.{name}"))


def _message(name: str, fields: str) -> DescriptorProto:
    descriptor = DescriptorProto(name=name)
    enum = ""
    for number, words in enumerate(fields.split(", "), 1):
        kind, field_name = words.split()
        field = descriptor.field.add(name=field_name, number=number)
        repeated, kind = kind.endswith(_REPEATED), kind.removesuffix(_REPEATED)
        field.label = FieldDescriptorProto.LABEL_REPEATED if repeated else FieldDescriptorProto.LABEL_OPTIONAL
        if kind in _SCALARS:
            field.type = _SCALARS[kind]
        elif kind in _WELL_KNOWN:
            field.type, field.type_name = FieldDescriptorProto.TYPE_MESSAGE, f".google.protobuf.{kind}"
        elif kind in _MESSAGES:
            field.type, field.type_name = FieldDescriptorProto.TYPE_MESSAGE, f".{PACKAGE}.{kind}"
        else:
            enum = kind
            field.type, field.type_name = FieldDescriptorProto.TYPE_ENUM, f".{PACKAGE}.{name}.{kind}"
    if enum:
        values = descriptor.enum_type.add(name=enum).value
        for number, value in enumerate(_ENUMS[name]):
            values.add(name=value, number=number)
    return descriptor
