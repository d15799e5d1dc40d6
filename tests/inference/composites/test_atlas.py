"""Atlases: each format says the same of the same sheet; all else is named by what it looks like."""

import json
import plistlib
from pathlib import Path

import pytest

from normalgan.errors import InputError
from normalgan.inference.composites.atlas import AtlasCells, read_atlas

SHAPE = (100, 200)
CLOCKWISE = {("a", 0, 0, 40, 60, 0), ("b", 50, 10, 30, 20, 1)}
"""Two sprites of a sheet; the second is 20 wide and 30 high upright and lies turned clockwise."""
UPRIGHT = {("a", 0, 0, 40, 60, 0), ("b", 50, 10, 30, 20, 0)}
COUNTER = {("a", 0, 0, 40, 60, 0), ("b", 50, 10, 30, 20, 3)}

A, B = {"x": 0, "y": 0, "w": 40, "h": 60}, {"x": 50, "y": 10, "w": 20, "h": 30}
ARRAY = [{"filename": "a", "frame": A, "rotated": False}, {"filename": "b", "frame": B, "rotated": True}]
SIZE = {"w": 200, "h": 100}
FLAT = {"x": 50, "y": 10, "w": 30, "h": 20}


def plist(version: int) -> bytes:
    frames: dict[str, dict[str, object]]
    if version == 0:
        frames = {
            "a": {"x": 0, "y": 0, "width": 40, "height": 60},
            "b": {"x": 50, "y": 10, "width": 30, "height": 20},
        }
        return plistlib.dumps({"frames": frames})
    box, turned = ("textureRect", "textureRotated") if version == 3 else ("frame", "rotated")
    frames = {"a": {box: "{{0,0},{40,60}}", turned: False}, "b": {box: "{{50,10},{20,30}}", turned: True}}
    about = {"size": "{200,100}", "textureFileName": "sheet.png", "format": version}
    form = plistlib.FMT_BINARY if version == 3 else plistlib.FMT_XML
    return plistlib.dumps({"frames": frames, "metadata": about}, fmt=form)


OLD_GDX = """
other.png
size: 64,64
format: RGBA8888
c
  rotate: false
  xy: 0, 0
  size: 64, 64

sheet.png
size: 200,100
filter: Nearest,Nearest
a
  rotate: false
  xy: 0, 0
  size: 40, 60
  index: -1
b
  rotate: true
  xy: 50, 10
  size: 20, 30
  index: -1
"""
SPINE = "sheet.png\n\tsize: 200, 100\na\n\tbounds: 0, 0, 40, 60\nb\n\tbounds: 50,10,20,30\n\trotate:90\n"
STARLING = (
    '<?xml version="1.0"?><!-- packed --><TextureAtlas imagePath="in/sheet.png" width="200" height="100">'
    '<SubTexture name="a" x="0" y="0" width="40" height="60"/>'
    '<SubTexture name="b" x="50" y="10" width="30" height="20" rotated="true" frameX="-1"/></TextureAtlas>'
)
GENERIC = (
    '<TextureAtlas imagePath="sheet.png"><sprite n="a" x="0" y="0" w="40" h="60"/>'
    '<sprite n="b" x="50" y="10" w="30" h="20" r="y"/></TextureAtlas>'
)
UNITY = """#
:format=40300
:texture=sheet.png
:size=200x100
:pivotpoints=enabled

a;0;40;40;60; 0.5;0.5; 0;0;0;0
b;50;70;30;20; 0.5;0.5
"""
UNITY_SLICES = """fileFormatVersion: 2
TextureImporter:
  spriteMode: 2
  spriteSheet:
    serializedVersion: 2
    sprites:
    - serializedVersion: 2
      name: a
      rect:
        serializedVersion: 2
        x: 0
        y: 40
        width: 40
        height: 60
      alignment: 0
    - serializedVersion: 2
      name: "b"
      rect:
        serializedVersion: 2
        x: 50
        y: 70
        width: 30
        height: 20
  nameFileIdTable:
    a: 21300000
"""
EASEL = {
    "images": ["other.png", "sheet.png"],
    "frames": [[0, 0, 9, 9, 0], [0, 0, 40, 60, 1], [50, 10, 30, 20, 1]],
}
DRAGON = {
    "imagePath": "sheet.png",
    "SubTexture": [
        {"name": "a", "x": 0, "y": 0, "width": 40, "height": 60},
        {"name": "b", "x": 50, "y": 10, "width": 30, "height": 20},
    ],
}


def phaser(*names: str) -> str:
    others = [{"image": each, "size": {"w": 9, "h": 9}, "frames": []} for each in names]
    return json.dumps({"textures": [*others, {"image": "sheet.png", "size": SIZE, "frames": ARRAY}]})


FILES: dict[str, tuple[str | bytes, set[tuple[str, int, int, int, int, int]]]] = {
    "hash": (json.dumps({"frames": {each["filename"]: each for each in ARRAY}}), CLOCKWISE),
    "array": (json.dumps({"frames": ARRAY, "meta": {"image": "x.png", "size": SIZE}}), CLOCKWISE),
    "bare array": (json.dumps(ARRAY), CLOCKWISE),
    "degrees": (json.dumps({"frames": [ARRAY[0], {**ARRAY[1], "rotated": 90}]}), CLOCKWISE),
    "other way": (json.dumps({"frames": [ARRAY[0], {**ARRAY[1], "rotated": -90}]}), COUNTER),
    "floats": (json.dumps({"frames": ARRAY}).replace("40", "40.0").replace("10", "10.0"), CLOCKWISE),
    "phaser": (phaser("other.png"), CLOCKWISE),
    "godot": (
        json.dumps(
            {
                "textures": [
                    {
                        "image": "sheet.png",
                        "size": SIZE,
                        "sprites": [{"filename": "a", "region": A}, {"filename": "b", "region": FLAT}],
                    }
                ]
            }
        ),
        UPRIGHT,
    ),
    "slices of Unity": (UNITY_SLICES, UPRIGHT),
    "egret": (json.dumps({"file": "sheet.png", "frames": {"a": {**A, "offX": 0}, "b": FLAT}}), UPRIGHT),
    "dragon": (json.dumps(DRAGON), UPRIGHT),
    "easel": (
        json.dumps(EASEL),
        {("2", *each[1:]) if each[0] == "a" else ("3", *each[1:]) for each in UPRIGHT},
    ),
    "starling": (STARLING, CLOCKWISE),
    "generic": (GENERIC, CLOCKWISE),
    "cocos 0": (plist(0), UPRIGHT),
    "cocos 2": (plist(2), CLOCKWISE),
    "cocos 3": (plist(3), CLOCKWISE),
    "libgdx": (OLD_GDX, COUNTER),
    "spine": (SPINE, COUNTER),
    "unity": (UNITY, UPRIGHT),
    "text": ("a = 0 0 40 60\nb = 50 10 30 20\n", UPRIGHT),
    "csv": ("name,x,y,width,height\na,0,0,40,60\nb,50,10,30,20,0.5\n", UPRIGHT),
}


def read(folder: Path, content: str | bytes, **options: tuple[float, float]) -> AtlasCells:
    path = folder / "any.atlas"
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return read_atlas(path, SHAPE, Path("sheet.png"), **options)


@pytest.mark.parametrize("name", FILES)
def test_formats_say_the_same_of_the_same_sheet(tmp_path: Path, name: str) -> None:
    content, expected = FILES[name]
    found = read(tmp_path, content)
    assert {(c.name, c.left, c.top, c.width, c.height, c.turned) for c in found.cells} == expected
    assert not found.warnings


def test_sprites_without_pixels_or_outside_the_sheet_do_not_cost_the_others(tmp_path: Path) -> None:
    empty = {"filename": "empty", "frame": {"x": 0, "y": 0, "w": 0, "h": 0}}
    outside = {"filename": "far", "frame": {"x": 190, "y": 0, "w": 40, "h": 9}}
    found = read(tmp_path, json.dumps({"frames": [*ARRAY, empty, outside, {"filename": "none"}]}))
    assert [each.name for each in found.cells] == ["a", "b"]
    assert found.warnings == [
        "the sprite 'far' at x 190, y 0 with 40 × 9 pixels lies outside of sheet.png",
        "the sprite 'none' has no position; it needs x, y, width and height",
    ]


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        ("", "is empty"),
        ("{", "is broken JSON: line 1, column 2"),
        ('[gd_resource type="AtlasTexture"]', "is a Godot resource"),
        ('{"a": 1}', "looks like JSON without a list of sprites"),
        ('{"tilewidth": 16, "layers": []}', "is a Tiled map or tileset"),
        ('{"skeleton": {"hash": ""}, "bones": []}', "is a Spine skeleton; name its .atlas"),
        ('{"images": ["a.png"], "frames": {"width": 9}}', "divides its sheet evenly; use --sheet"),
        ("<TextureAtlas><SubTexture", "is broken XML"),
        ('<!DOCTYPE a [<!ENTITY b "c">]><TextureAtlas/>', "declares entities"),
        ("<plist><dict>", "is a broken property list"),
        ("<svg xmlns='a'/>", "is an SVG picture"),
        ("<html><body/></html>", "is a web page"),
        ('<data version="1.0"><struct type="Settings">', "is a TexturePacker project; publish it"),
        (".fox {\n background: url(a.png);\n}", "looks like a CSS style sheet"),
        ("local sheet = {}", "looks like Lua"),
        ("fileFormatVersion: 2\nTextureImporter:\n", "is a Unity .meta file"),
        ("version https://git-lfs.github.com/spec/v1\n", "is a Git LFS pointer"),
        (b"\x89PNG\r\n\x1a\n\0\0", "is a PNG picture"),
        (b"\0\1\2\3", "is not text"),
        ("hello", "is text of an unknown kind"),
        (
            phaser("other.png").replace("sheet.png", "b.png"),
            "has the sprites of other.png, b.png; none of these",
        ),
        (SPINE.replace("200", "300"), "is for a sheet of 300 × 100 pixels, but sheet.png has 200 × 100"),
    ],
)
def test_other_files_are_named_by_what_they_look_like(
    tmp_path: Path, content: str | bytes, sentence: str
) -> None:
    with pytest.raises(InputError) as caught:
        read(tmp_path, content)
    assert sentence in str(caught.value)
    assert "Expecting" not in str(caught.value)


def test_the_atlas_of_an_svg_is_in_its_own_units(tmp_path: Path) -> None:
    frames = json.dumps({"frames": {"a": {"frame": {"x": 50, "y": 0, "w": 49.6, "h": 50}}}})
    found = read(tmp_path, frames, units=(100, 50)).cells[0]
    assert (found.left, found.top, found.width, found.height) == (100, 0, 99, 100)
    with pytest.raises(InputError, match="is for a sheet of 100 × 90 pixels"):
        read(tmp_path, frames, units=(100, 90))
