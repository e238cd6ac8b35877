"""Writes ONNX files, so that the tests need neither published networks nor the onnx package."""

from __future__ import annotations

import struct

import numpy as np


def varint(value: int) -> bytes:
    value &= (1 << 64) - 1
    out = bytearray()
    while value >= 128:
        out.append(value & 127 | 128)
        value >>= 7
    return bytes([*out, value])


def integer(field: int, value: int) -> bytes:
    return varint(field << 3) + varint(value)


def message(field: int, content: bytes | str) -> bytes:
    content = content.encode() if isinstance(content, str) else content
    return varint(field << 3 | 2) + varint(len(content)) + content


def tensor(name: str, values: np.ndarray) -> bytes:
    kind = {"float32": 1, "int64": 7}[values.dtype.name]
    shape = b"".join(integer(1, n) for n in values.shape)
    return shape + integer(2, kind) + message(8, name) + message(9, values.tobytes())


def attribute(name: str, value) -> bytes:
    out = message(1, name)
    if isinstance(value, float):
        return out + varint(2 << 3 | 5) + struct.pack("<f", value) + integer(20, 1)
    if isinstance(value, int):
        return out + integer(3, value) + integer(20, 2)
    if isinstance(value, str):
        return out + message(4, value) + integer(20, 3)
    if isinstance(value, np.ndarray):
        return out + message(5, tensor("", value)) + integer(20, 4)
    return out + b"".join(integer(8, v) for v in value) + integer(20, 7)


def value_info(name: str, shape: list[int | str]) -> bytes:
    axes = b"".join(message(1, message(2, n) if isinstance(n, str) else integer(1, n)) for n in shape)
    return message(1, name) + message(2, message(1, integer(1, 1) + message(2, axes)))


class Network:
    """Builds a graph: `n.add("Conv", x, weights, strides=[2, 2])` adds a node and returns the name of its output."""

    def __init__(self, shape: list[int | str], opset: int, seed: int = 1) -> None:
        self.shape, self.opset, self.random = shape, opset, np.random.default_rng(seed)
        self.nodes: list[bytes] = []
        self.constants: list[bytes] = []
        self.count = 0

    def name(self) -> str:
        self.count += 1
        return f"v{self.count}"

    def constant(self, values) -> str:
        values = np.asarray(values)
        values = values.astype(np.int64 if values.dtype.kind in "iu" else np.float32)
        self.constants.append(tensor(name := self.name(), values))
        return name

    def noise(self, *shape: int, scale: float = 1.0) -> str:
        """Random weights, scaled so that the output of the layer has about the magnitude of its input."""
        inputs = int(np.prod(shape[1:])) if len(shape) != 2 else shape[0]
        return self.constant((scale * self.random.normal(size=shape) / np.sqrt(max(inputs, 1))).astype(np.float32))

    def add(self, kind: str, *inputs: str, outputs: int = 1, **attributes):
        names = [self.name() for _ in range(outputs)]
        node = b"".join(message(1, name) for name in inputs) + b"".join(message(2, name) for name in names)
        node += message(3, f"{kind}_{self.count}") + message(4, kind)
        self.nodes.append(node + b"".join(message(5, attribute(k, v)) for k, v in attributes.items()))
        return names[0] if outputs == 1 else names

    def file(self, output: str, rank: int = 3) -> bytes:
        graph = b"".join(message(1, node) for node in self.nodes) + message(2, "test")
        graph += b"".join(message(5, constant) for constant in self.constants)
        graph += message(11, value_info("input", self.shape))
        graph += message(12, value_info(output, [f"d{k}" for k in range(rank)]))
        return integer(1, 8) + message(7, graph) + message(8, integer(2, self.opset))
