"""Files made from the grammar of their format by chance: every part well formed, the whole never seen before.

Byte mutations seldom get past a checksum or a parser; these do, and try what lies behind.
"""

import base64
import struct
import zlib
from collections.abc import Callable

import numpy as np

from hostile_pictures import SPACES, chunk

NUMBERS = ("0", "1", "-1", "0.5", "3", "7.25", "40", "64", "100%", "1e3", "-1e-9")
ABSURD = ("1e308", "-1e38", "nan", "inf", "99999999999999999999", "1e-320", "0x10", "", "1 2 3", "9" * 400)
_FILTERS = (
    *("feGaussianBlur", "feOffset", "feFlood", "feColorMatrix", "feMorphology", "feComposite", "feBlend"),
    *("feTurbulence", "feTile", "feMerge", "feDropShadow", "feDisplacementMap", "feConvolveMatrix"),
    *("feDiffuseLighting", "feSpecularLighting", "feComponentTransfer", "feImage"),
)
_HOLDERS = ("g", "svg", "symbol", "pattern", "mask", "clipPath", "marker", "switch", "a", "defs")
_SHAPES = (
    "path",
    "rect",
    "circle",
    "ellipse",
    "line",
    "polyline",
    "polygon",
    "text",
    "use",
    "image",
    "style",
)
_SIZES = ("x", "y", "width", "height", "r", "rx", "cx", "cy", "x1", "y2", "stdDeviation", "dx", "radius")
_MORE = ("stroke-width", "opacity", "stroke-dasharray", "stroke-miterlimit", "font-size", "numOctaves")
_UNITS = ("patternUnits", "maskUnits", "clipPathUnits", "filterUnits", "primitiveUnits", "markerUnits")


class Chance:
    """Choices drawn from a seed."""

    def __init__(self, seed: list[int]) -> None:
        self.rng = np.random.default_rng(seed)

    def of(self, choices: "tuple[str, ...] | list[str]") -> str:
        """Return one of some texts."""
        return choices[int(self.rng.integers(len(choices)))]

    def below(self, most: int) -> int:
        """Return a whole number from 0."""
        return int(self.rng.integers(most))

    def often(self, share: float) -> bool:
        """Return whether something happens that does in this share of all cases."""
        return bool(self.rng.random() < share)

    def number(self) -> str:
        """Return a number as a text, seldom an absurd one."""
        return self.of(ABSURD) if self.often(0.05) else self.of(NUMBERS)

    def bytes(self, most: int) -> bytes:
        """Return some bytes."""
        return self.rng.integers(0, 256, self.below(most + 1), np.uint8).tobytes()


def svg(chance: Chance) -> bytes:
    """Return an SVG of any elements in one another that refer to one another, in circles too."""

    def reference() -> str:
        return f"url(#i{chance.below(12)})"

    def attributes(name: str) -> str:
        found = {"id": f"i{chance.below(12)}"} if chance.often(0.5) else {}
        for _ in range(chance.below(6)):
            key = chance.of((*_SIZES, *_MORE))
            found[key] = chance.number() if key != "numOctaves" else str(chance.below(6))
        for key in ("fill", "stroke", "mask", "clip-path", "filter", "marker-mid"):
            if chance.often(0.2):
                found[key] = (
                    reference() if chance.often(0.6) else chance.of(("#000", "red", "none", "rgb(9,9"))
                )
        if chance.often(0.2):
            found["transform"] = f"{chance.of(('scale', 'rotate', 'skewX', 'matrix'))}({chance.number()})"
        if chance.often(0.2):
            found["viewBox"] = " ".join(chance.number() for _ in range(4))
        if chance.often(0.2):
            found[chance.of(_UNITS)] = chance.of(("userSpaceOnUse", "objectBoundingBox", "x"))
        if name == "path":
            found["d"] = " ".join(f"{chance.of(tuple('MLCQAZHVSTmlc'))}{chance.number()}" for _ in range(12))
        if name in {"polyline", "polygon"}:
            found["points"] = " ".join(chance.number() for _ in range(9))
        if name in {"use", "feImage", "image"}:
            found["xlink:href"] = chance.of((f"#i{chance.below(12)}", "#", f"data:image/png;base64,{PIXEL}"))
        return "".join(f' {key}="{value}"' for key, value in found.items())

    def element(depth: int) -> str:
        if depth and chance.often(0.6):
            name = chance.of((*_HOLDERS, "filter"))
            inside = element if name != "filter" else primitive
            held = "".join(inside(depth - 1) for _ in range(chance.below(4)))
            return f"<{name}{attributes(name)}>{held}</{name}>"
        name = chance.of(_SHAPES)
        inner = {"text": "abc &#233;", "style": "* { stroke: url(#i1) } @import url(x);"}.get(name, "")
        return f"<{name}{attributes(name)}>{inner}</{name}>"

    def primitive(depth: int) -> str:
        name = chance.of(_FILTERS)
        values = (
            f' in="{chance.of(("SourceGraphic", "a", "BackgroundImage"))}" result="a" baseFrequency="0.1"'
        )
        return f"<{name}{values}{attributes(name)}/>"

    inside = "".join(element(6) for _ in range(1 + chance.below(6)))
    return f'<svg {SPACES} viewBox="0 0 64 64">{inside}</svg>'.encode()


def png(chance: Chance) -> bytes:
    """Return a PNG of sound chunks in any number and order, with pixels that fit its head or do not."""
    width, height = 8 + chance.below(40), 8 + chance.below(40)
    colour = (0, 2, 3, 4, 6)[chance.below(5)]
    depth = 8 if chance.often(0.7) else (1, 2, 4, 16)[chance.below(4)]
    channels = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}[colour]
    head = struct.pack(">IIBBBBB", width, height, depth, colour, 0, 0, chance.often(0.1))
    row = 1 + (width * channels * depth + 7) // 8
    rows = b"".join(bytes([chance.below(5)]) + bytes(row - 1) for _ in range(height + (chance.below(9) == 0)))
    data = zlib.compress(rows + chance.bytes(20))
    packed = zlib.compress(chance.bytes(40) * (1 + chance.below(2000)))
    known: tuple[tuple[bytes, bytes], ...] = (
        (b"PLTE", chance.bytes(800)),
        (b"tRNS", chance.bytes(300)),
        (b"gAMA", chance.bytes(5)),
        (b"iCCP", b"a\0\0" + packed),
        (b"zTXt", b"a\0\0" + packed),
        (b"iTXt", b"a\0\1\0\0\0" + packed),
        (b"tEXt", b"Comment\0<svg"),
        (b"eXIf", b"II*\0\x08\0\0\0" + chance.bytes(60)),
        (b"acTL", struct.pack(">II", chance.below(5), chance.below(3))),
        (b"fcTL", struct.pack(">IIIIIHHBB", 0, width, height, chance.below(9), 0, 1, 1, chance.below(4), 1)),
        (b"fdAT", b"\0\0\0\1" + data),
        (b"pHYs", struct.pack(">IIB", 0, 2**31, 1)),
        (b"IHDR", head),
    )
    parts = [chunk(*known[chance.below(len(known))]) for _ in range(chance.below(3))]
    cut = chance.below(len(data) + 1)
    pixels = [
        chunk(b"IDAT", data[:cut]),
        *(parts[:1] if chance.often(0.1) else []),
        chunk(b"IDAT", data[cut:]),
    ]
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + b"".join([*parts, *pixels, chunk(b"IEND", b"")])


def tiff(chance: Chance) -> bytes:
    """Return a TIFF whose directories say anything that a directory may say."""
    order = chance.of(("<", ">"))
    data = (zlib.compress(bytes(4096)) if chance.often(0.3) else chance.bytes(4096)).ljust(4096, b"\0")
    values = (0, 1, 2, 3, 4, 5, 7, 8, 16, 32, 64, 255, 4096, 65535, 2**31, 2**32 - 1)
    sound = {256: 64, 257: 64, 258: 8, 259: 1, 262: 1, 273: 8, 277: 1, 278: 64, 279: 4096, 284: 1}
    others: dict[int, tuple[int, ...]] = {
        256: (16, 64), 257: (16, 64), 258: (1, 8, 16, 32), 259: (1, 2, 3, 4, 5, 6, 7, 8, 32773, 34712, 50000),
        262: (0, 1, 2, 3, 5, 6, 8), 266: (2,), 274: (1, 3, 6, 8), 277: (1, 3, 4), 278: (16, 64), 317: (2, 3),
        279: (64, 4096), 284: (1, 2), 322: (16, 64), 323: (16,), 324: (8,), 325: (4096,), 338: (0, 1, 2),
        339: (1, 2, 3), 347: (8,), 530: (2,), 320: (8,), 330: (8,), 34665: (8,), 700: (8,), 33432: (8,),
    }  # fmt: skip
    blob, offset = b"", 8 + len(data)
    for _ in range(1 + chance.below(2)):
        held = {tag: (4, 1, value) for tag, value in sound.items()}
        for _ in range(chance.below(4)):
            tag = list(others)[chance.below(len(others))]
            kind = 4 if chance.often(0.8) else chance.below(19)
            count = 1 if chance.often(0.8) else values[chance.below(len(values))]
            likely = others[tag] if chance.often(0.8) else values
            held[tag] = (kind, count, likely[chance.below(len(likely))])
        directory = struct.pack(f"{order}H", len(held)) + b"".join(
            struct.pack(f"{order}HHII", tag, *entry) for tag, entry in sorted(held.items())
        )
        following = offset if chance.often(0.1) else offset + len(blob) + len(directory) + 4
        blob += directory + struct.pack(f"{order}I", following if chance.often(0.5) else 0)
    mark = b"II*\0" if order == "<" else b"MM\0*"
    return mark + struct.pack(f"{order}I", offset) + data + blob


def gif(chance: Chance) -> bytes:
    """Return a GIF of any number of sound blocks."""

    def blocks() -> bytes:
        held = (chance.bytes(60) for _ in range(chance.below(4)))
        return b"".join(bytes([len(each)]) + each for each in held if each) + b"\0"

    width, height = 8 + chance.below(50), 8 + chance.below(50)
    parts = [b"GIF89a" if chance.often(0.8) else b"GIF87a"]
    flags = chance.below(256)
    parts.append(struct.pack("<HHBBB", width, height, flags, chance.below(256), 0))
    parts.append(bytes(3 * 2 ** ((flags & 7) + 1)) if flags & 128 else b"")
    for _ in range(1 + chance.below(4)):
        if chance.often(0.5):
            parts.append(b"!" + bytes([(0xF9, 0xFE, 0xFF, 0x01)[chance.below(4)]]) + blocks())
        colours = chance.below(256)
        size = (width, height) if chance.often(0.7) else (chance.below(65536), chance.below(3000))
        parts.append(b"," + struct.pack("<HHHHB", chance.below(9), chance.below(9), *size, colours))
        parts.append(bytes(3 * 2 ** ((colours & 7) + 1)) if colours & 128 else b"")
        if chance.often(0.7) and max(size) < 100:  # pixels of seven bits, the table emptied before it grows
            pixels = bytes(chance.below(128) for _ in range(size[0] * size[1]))
            rows = [b"\x80" + pixels[i : i + 100] for i in range(0, len(pixels), 100)]
            parts.append(b"\x07" + b"".join(bytes([len(row)]) + row for row in [*rows, b"\x81"]) + b"\0")
        else:
            parts.append(bytes([chance.below(13)]) + blocks())
    return b"".join(parts) + b";"


def onnx(chance: Chance) -> bytes:
    """Return a model of any operators, one after the other, with what a generator takes and gives."""
    from onnx import NodeProto, TensorProto, helper, numpy_helper

    operators: dict[str, int] = {
        "Identity": 1, "Neg": 1, "Relu": 1, "Sqrt": 1, "Log": 1, "Exp": 1, "Sigmoid": 1, "Add": 2, "Sub": 2,
        "Mul": 2, "Div": 2, "Pow": 2, "MatMul": 2, "Concat": 3, "Transpose": 1, "Reshape": 2, "Expand": 2,
        "Tile": 2, "ConstantOfShape": 1, "Conv": 2, "ConvTranspose": 2, "MaxPool": 1, "Softmax": 1, "Pad": 2,
        "Slice": 3, "Gather": 2, "Resize": 4, "ReduceSum": 2, "Shape": 1, "Cast": 1, "Range": 3, "Loop": 2,
        "InstanceNormalization": 3, "GlobalAveragePool": 1, "Flatten": 1, "Squeeze": 1, "OneHot": 3,
    }  # fmt: skip
    names = ["sketch", "hints", "", "w0", "w1", "w2", "w3"]
    kinds = (np.float32, np.int64, np.float32, np.bool_)
    weights = []
    for i, kind in enumerate(kinds):
        shape = [chance.below(5) for _ in range(chance.below(5))]
        numbers = chance.rng.integers(-3, 9, shape) * (10 ** chance.below(12) if chance.often(0.2) else 1)
        weights.append(numpy_helper.from_array(numbers.astype(kind), f"w{i}"))
    nodes: list[NodeProto] = []
    for i in range(1 + chance.below(8)):
        operator = chance.of(tuple(operators))
        more: dict[str, object] = {}
        for key, value in (("axis", chance.below(5)), ("group", chance.below(4)), ("to", chance.below(20))):
            if chance.often(0.3):
                more[key] = value - 1
        for key in ("pads", "strides", "kernel_shape", "dilations", "perm"):
            if chance.often(0.2):
                more[key] = [chance.below(4) if chance.often(0.9) else 2**40 for _ in range(4)]
        taken = [chance.of(names) for _ in range(operators[operator])]
        nodes.append(helper.make_node(operator, taken, [f"n{i}"], **more))  # type: ignore[arg-type]
        names += [f"n{i}"] * 3
    nodes.append(helper.make_node("Concat", [chance.of(names[-3:])] * 3, ["normal"], axis=chance.below(2)))
    taken_in = [
        helper.make_tensor_value_info(name, TensorProto.FLOAT, ["N", channels, 16, 16])
        for name, channels in (("sketch", 1), ("hints", 4))
    ]
    given = [helper.make_tensor_value_info("normal", TensorProto.FLOAT, None)]
    model = helper.make_model(
        helper.make_graph(nodes, "g", taken_in, given, weights),
        opset_imports=[helper.make_opsetid("", 17)],
        ir_version=8,
    )
    return bytes(model.SerializeToString())


PIXEL = base64.b64encode(
    b"\x89PNG\r\n\x1a\n"
    + chunk(b"IHDR", struct.pack(">IIBBBBB", 1, 1, 8, 0, 0, 0, 0))
    + chunk(b"IDAT", zlib.compress(bytes(2)))
    + chunk(b"IEND", b"")
).decode()
"""A picture of one pixel."""
KINDS: dict[str, Callable[[Chance], bytes]] = {make.__name__: make for make in (svg, png, tiff, gif, onnx)}
