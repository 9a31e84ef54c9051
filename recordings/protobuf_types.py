"""Protobuf message types by name, and the descriptors that make a recording explain itself."""

from __future__ import annotations

from functools import cache
from importlib import import_module
from typing import Any

from google.protobuf import descriptor_pb2, descriptor_pool, message_factory


@cache
def message_type(name: str) -> Any:
    """The class of a message type such as "galeway.State" or "foxglove.Grid"."""
    package, _, short = name.partition(".")
    import_module(
        "recordings.galeway_pb2" if package == "galeway" else f"foxglove_schemas_protobuf.{short}_pb2"
    )
    return message_factory.GetMessageClass(descriptor_pool.Default().FindMessageTypeByName(name))


def descriptor_set(name: str) -> bytes:
    """A serialised FileDescriptorSet with all that is needed to read a message type, dependencies first."""
    found = descriptor_pb2.FileDescriptorSet()
    seen = set()

    def add(file: Any) -> None:
        if file.name not in seen:
            seen.add(file.name)
            for dependency in file.dependencies:
                add(dependency)
            file.CopyToProto(found.file.add())

    add(message_type(name).DESCRIPTOR.file)
    content: bytes = found.SerializeToString(deterministic=True)
    return content
