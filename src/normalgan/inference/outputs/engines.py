"""Engines: the conventions of game engines for normal maps, and their import files."""

import hashlib
import json
import os
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from normalgan.normals import Bits, Green

Engine = Literal["unity", "unreal", "godot", "godot3", "blender"]


@dataclass(frozen=True)
class Convention:
    """How an engine names and stores a normal map.

    Args:
        y: direction of green.
        bits: bits per channel.
        suffix: suffix of the map's name.
        sidecar: ending of the import file, which tells the engine how to import the map.
    """

    y: Green
    bits: Bits
    suffix: str
    sidecar: str


CONVENTIONS: dict[Engine, Convention] = {
    # Unity, "Importing a texture": Normal map. _NormalMap is the name for secondary textures of sprites.
    "unity": Convention("up", 8, "_NormalMap", ".meta"),
    # Unreal Engine, recommended asset naming: T_Name_N. Green is flipped relative to OpenGL.
    "unreal": Convention("down", 8, "_N", ".import.py"),
    "godot": Convention("up", 8, "_n", ".import"),
    "godot3": Convention("down", 8, "_n", ".import"),  # its 2D lights take green as down
    "blender": Convention("up", 16, "_normal", ".import.py"),
}


def sidecar(engine: Engine, target: Path) -> tuple[Path, bytes]:
    """Return the path and the content of the import file of a map, which marks it as data instead of colours.

    Args:
        engine: the engine. Unity and Godot (``godot`` is Godot 4) read the file automatically. For Unreal and
            Blender it is a Python script that imports the map next to it.
        target: path of the map.
    """
    path = target.with_name(target.name + CONVENTIONS[engine].sidecar)
    if engine == "unity":
        literal = hashlib.md5(os.fsencode(target.as_posix()), usedforsecurity=False).hexdigest()
    elif engine in {"godot", "godot3"}:
        literal = json.dumps(f"res://{target.name}", ensure_ascii=False)
    else:
        literal = ascii(target.name)  # JSON would escape a character beyond U+FFFF as two
    text = _TEXTS[engine].replace(_LITERAL, literal)
    return path, text.encode("utf-8", sys.getfilesystemencodeerrors())  # a file name may not be UTF-8


_LITERAL = "<LITERAL>"
"""Placeholder for the only text that depends on the map; names are inserted as literals, never as code."""
_TEXTS: dict[Engine, str] = {
    "unity": (
        "fileFormatVersion: 2\nguid: <LITERAL>\nTextureImporter:\n  serializedVersion: 12\n"
        "  mipmaps:\n    sRGBTexture: 0\n    enableMipMap: 1\n  bumpmap:\n    convertToNormalMap: 0\n"
        "  textureType: 1\n"  # Normal map
        "  textureShape: 1\n"
    ),
    # Godot adds the missing entries on its first scan.
    "godot": (
        '[remap]\n\nimporter="texture"\ntype="CompressedTexture2D"\n\n[deps]\n\n'
        "source_file=<LITERAL>\n\n[params]\n\n"
        "compress/mode=0\ncompress/normal_map=1\nroughness/mode=0\n"
        "process/normal_map_invert_y=false\ndetect_3d/compress_to=0\n"
    ),
    "godot3": (
        '[remap]\n\nimporter="texture"\ntype="StreamTexture"\n\n[deps]\n\n'
        "source_file=<LITERAL>\n\n[params]\n\n"
        "compress/mode=0\ncompress/normal_map=1\nflags/filter=true\nflags/srgb=0\ndetect_3d=false\n"
    ),
    "unreal": '''"""Imports the normal map next to this file: Tools > Execute Python Script."""

import os

import unreal

name = <LITERAL>
task = unreal.AssetImportTask()
task.filename = os.path.join(os.path.dirname(os.path.abspath(__file__)), name)
task.destination_path = "/Game/NormalMaps"
task.automated = task.save = True
unreal.AssetToolsHelpers.get_asset_tools().import_asset_tasks([task])
for path in task.imported_object_paths:
    texture = unreal.load_asset(path)
    texture.set_editor_property("compression_settings", unreal.TextureCompressionSettings.TC_NORMALMAP)
    texture.set_editor_property("srgb", False)
    texture.set_editor_property("flip_green_channel", False)
    unreal.EditorAssetLibrary.save_loaded_asset(texture)
''',
    "blender": '''"""Makes a material with the normal map next to this file.

Run it in Blender's text editor, or by blender --python.
"""

import os

import bpy

name = <LITERAL>
here = os.path.dirname(os.path.abspath(__file__))
image = bpy.data.images.load(os.path.join(here, name), check_existing=True)
space, usual = image.colorspace_settings, image.colorspace_settings.name
space.is_data = True  # the space that has the role "data" in the OCIO configuration
if space.name == usual:  # none has
    spaces = space.bl_rna.properties["name"].enum_items.keys()
    space.name = next((raw for raw in ("Non-Color", "Raw", "Utility - Raw") if raw in spaces), usual)
material = bpy.data.materials.new(os.path.splitext(name)[0])
material.use_nodes = True
nodes, links = material.node_tree.nodes, material.node_tree.links
texture, turn = nodes.new("ShaderNodeTexImage"), nodes.new("ShaderNodeNormalMap")
texture.image = image
shader = next(node for node in nodes if node.type == "BSDF_PRINCIPLED")
links.new(texture.outputs["Color"], turn.inputs["Color"])
links.new(turn.outputs["Normal"], shader.inputs["Normal"])
''',
}
