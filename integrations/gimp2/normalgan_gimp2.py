#!/usr/bin/env python3
"""Plug-in for GIMP 2.10: puts the normal map of a layer on a new layer above it.

Debian's GIMP 2.10 no longer includes Python, and Script-Fu cannot start commands. But any program that talks
to GIMP through its library is a plug-in, so this one calls libgimp from an ordinary Python with ctypes.
"""

import ctypes
import ctypes.util
import sys
import tempfile
from pathlib import Path

from normalgan_command import CommandError, predict

NAME = b"plug-in-normalgan-layer"
# Values of libgimp's enumerations GimpPDBArgType, GimpPDBStatusType, GimpPDBProcType and GimpRunMode.
INT32, FLOAT, STRING, IMAGE, LAYER, DRAWABLE, STATUS = 0, 3, 4, 13, 14, 16, 21
EXECUTION_ERROR, SUCCESS = 0, 3
PLUGIN = 1
NONINTERACTIVE = 1

if sys.platform.startswith("linux"):
    LIBRARY = "libgimp-2.0.so.0"
else:
    LIBRARY = ctypes.util.find_library("gimp-2.0") or "libgimp-2.0"


class Colour(ctypes.Structure):
    """GimpRGB, the largest member of the union below."""

    _fields_ = (
        ("r", ctypes.c_double),
        ("g", ctypes.c_double),
        ("b", ctypes.c_double),
        ("a", ctypes.c_double),
    )


class Data(ctypes.Union):
    """GimpParamData."""

    _fields_ = (
        ("int32", ctypes.c_int32),
        ("number", ctypes.c_double),
        ("string", ctypes.c_char_p),
        ("colour", Colour),
    )


class Parameter(ctypes.Structure):
    """GimpParam: an argument or a returned value."""

    _fields_ = (("type", ctypes.c_int), ("data", Data))


class Declared(ctypes.Structure):
    """GimpParamDef: declares an argument or a returned value of a procedure."""

    _fields_ = (("type", ctypes.c_int), ("name", ctypes.c_char_p), ("description", ctypes.c_char_p))


Bare = ctypes.CFUNCTYPE(None)
Run = ctypes.CFUNCTYPE(
    None,
    ctypes.c_char_p,
    ctypes.c_int,
    ctypes.POINTER(Parameter),
    ctypes.POINTER(ctypes.c_int),
    ctypes.POINTER(ctypes.POINTER(Parameter)),
)


class PlugIn(ctypes.Structure):
    """GimpPlugInInfo: the functions that GIMP calls."""

    _fields_ = (("init", Bare), ("quit", Bare), ("query", Bare), ("run", Run))


gimp = ctypes.CDLL(LIBRARY)
gimp.gimp_get_pdb_error.restype = ctypes.c_char_p
returned = (Parameter * 2)()  # GIMP reads it after `run` has ended


def query() -> None:
    """Register the procedure with GIMP."""
    taken = (Declared * 4)(
        Declared(INT32, b"run-mode", b"The run mode { RUN-INTERACTIVE (0), RUN-NONINTERACTIVE (1) }"),
        Declared(IMAGE, b"image", b"The image"),
        Declared(DRAWABLE, b"drawable", b"The layer that holds the drawing"),
        Declared(FLOAT, b"strength", b"What slopes are multiplied by; 1 as predicted"),
    )
    given = (Declared * 1)(Declared(LAYER, b"layer", b"The new layer"))
    gimp.gimp_install_procedure(
        NAME,
        b"Predict the normal map of a drawing",
        b"Predicts the normal map of the layer with normalgan, as a new layer above it.",
        b"The normalgan authors",
        b"MIT",
        b"2026",
        b"_Normal map of the drawing (normalgan)",
        b"RGB*",
        PLUGIN,
        len(taken),
        len(given),
        taken,
        given,
    )
    gimp.gimp_plugin_menu_register(NAME, b"<Image>/Filters/Map")


def checked(answer: int) -> int:
    """Return the value that a GIMP procedure returned, or raise an error for its error."""
    if answer in (0, -1):
        raise CommandError(f"GIMP: {gimp.gimp_get_pdb_error().decode(errors='replace')}")
    return answer


def normal_layer(image: int, drawable: int, strength: float) -> int:
    """Predict the normal map of a layer, and return the new layer above it.

    Args:
        image: the image that contains the layer.
        drawable: the layer.
        strength: factor of the slopes.

    Raises:
        CommandError: with a sentence for the user.
    """
    with tempfile.TemporaryDirectory() as folder:
        drawn, predicted = (str(Path(folder) / name) for name in ("layer.png", "normals.png"))
        copy = gimp.gimp_image_new(gimp.gimp_drawable_width(drawable), gimp.gimp_drawable_height(drawable), 0)
        try:
            alone = checked(gimp.gimp_layer_new_from_drawable(drawable, copy))
            gimp.gimp_image_insert_layer(copy, alone, 0, 0)
            gimp.gimp_layer_set_offsets(alone, 0, 0)
            gimp.gimp_layer_set_opacity(alone, ctypes.c_double(100))
            gimp.gimp_item_set_visible(alone, 1)
            path = drawn.encode()
            checked(gimp.gimp_file_save(NONINTERACTIVE, copy, alone, path, path))
        finally:
            gimp.gimp_image_delete(copy)
        warned = predict(drawn, predicted, "--alpha", "--strength", f"{strength:g}")
        if warned:
            gimp.gimp_message(warned.encode())
        layer = checked(gimp.gimp_file_load_layer(NONINTERACTIVE, image, predicted.encode()))
    x, y = ctypes.c_int(), ctypes.c_int()
    gimp.gimp_drawable_offsets(drawable, ctypes.byref(x), ctypes.byref(y))
    gimp.gimp_image_undo_group_start(image)
    gimp.gimp_item_set_name(layer, b"Normal map")
    parent = max(gimp.gimp_item_get_parent(drawable), 0)
    gimp.gimp_image_insert_layer(image, layer, parent, gimp.gimp_image_get_item_position(image, drawable))
    gimp.gimp_layer_set_offsets(layer, x, y)
    gimp.gimp_image_undo_group_end(image)
    gimp.gimp_displays_flush()
    return layer


def run(_name: bytes, count: int, given: object, returned_count: object, returned_values: object) -> None:
    """Run the procedure, and return the new layer, or an error that GIMP shows."""
    values = ctypes.cast(given, ctypes.POINTER(Parameter))  # type: ignore[arg-type]
    strength = values[3].data.number if count > 3 else 1.0
    returned[0].type = STATUS
    try:
        layer = normal_layer(values[1].data.int32, values[2].data.int32, strength or 1.0)
    except (CommandError, OSError) as error:
        returned[0].data.int32 = EXECUTION_ERROR
        returned[1].type = STRING
        returned[1].data.string = str(error).encode()
    else:
        returned[0].data.int32 = SUCCESS
        returned[1].type = LAYER
        returned[1].data.int32 = layer
    returned_count[0] = 2  # type: ignore[index]
    returned_values[0] = ctypes.cast(returned, ctypes.POINTER(Parameter))  # type: ignore[index]


def main() -> int:
    """Serve GIMP's requests."""
    plug_in = PlugIn(Bare(), Bare(), Bare(query), Run(run))
    words = [word.encode() for word in sys.argv]
    return int(
        gimp.gimp_main(ctypes.byref(plug_in), len(words), (ctypes.c_char_p * (len(words) + 1))(*words))
    )


if __name__ == "__main__":
    sys.exit(main())
