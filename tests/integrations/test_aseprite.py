"""The script for Aseprite, in Lua with a stand-in for Aseprite, which is not free to get."""

from pathlib import Path

import numpy as np
import pytest
from add_ons import DOG, install, own_command, painted_by_hand, program, start
from PIL import Image

from needs import LUA

HOST = """
-- What the script uses of Aseprite's interface: pictures are files that are copied.
local function copy(from, to)
  local file = assert(io.open(from, "rb"))
  local bytes = file:read("a")
  file:close()
  file = assert(io.open(to, "wb"))
  file:write(bytes)
  file:close()
end
ColorMode = { RGB = 0, GRAY = 1 }
Point = function(x, y) return { x = x, y = y } end
local pictures = {}
Image = function(given, height, mode)
  local picture = { file = type(given) == "table" and given.fromFile or nil }
  if picture.file then
    local kept = HOME .. "/kept" .. #pictures + 1 .. ".png"
    copy(picture.file, kept)
    picture.file = kept
    pictures[#pictures + 1] = kept
  end
  function picture:drawSprite(sprite, frame) self.file = sprite.drawing end
  function picture:saveAs(path) copy(self.file, path) end
  return picture
end
local sprite = {
  width = 256, height = 256, drawing = DRAWING, colorMode = MODE,
  frames = FRAMES,
  layers = { { name = "Lines", isVisible = true }, { name = "Normal map", isVisible = true } },
}
function sprite:newLayer()
  local layer = { isVisible = true }
  self.layers[#self.layers + 1] = layer
  return layer
end
function sprite:newCel(layer, frame, image, point)
  assert(point.x == 0 and point.y == 0)
  print("CEL", layer.name or "", frame, image.file)
end
app = {
  activeSprite = OPEN and sprite or nil,
  fs = {
    pathSeparator = "/", tempPath = HOME .. "/temporary", userConfigPath = HOME,
    joinPath = function(...) return table.concat({ ... }, "/") end,
    isFile = function(path)
      local file = io.open(path, "rb")
      return file ~= nil and file:close()
    end,
  },
  transaction = function(work) work() end,
  alert = function(shown) print("ALERT", shown.text) end,
  refresh = function() print("HIDDEN", not sprite.layers[2].isVisible) end,
}
dofile(SCRIPT)
"""


def run(home: Path, frames: int = 1, drawing: Path = DOG, state: str = "", **environment: str) -> list[str]:
    """Run the script in the stand-in, and return what it did, a line each."""
    lua = program(LUA, "lua5.4", "lua")
    if not (home / "normalgan").exists():
        install("aseprite", home, "--to", str(home / "scripts"), "--normalgan", str(own_command(home)))
        (home / "temporary").mkdir()
    numbers = ",".join(str(number) for number in range(1, frames + 1))
    given = f"HOME, DRAWING, SCRIPT = '{home}', '{drawing}', '{home}/scripts/normalgan.lua'\n"
    settings = f"FRAMES, MODE, OPEN = {{ {numbers} }}, 0, true\n{state}\n"
    (home / "host.lua").write_text(given + settings + HOST, encoding="utf-8")
    done = start([lua, "host.lua"], home, environment)
    assert done.returncode == 0, done.stderr
    told = ("CEL", "ALERT", "HIDDEN")  # the command prints the maps' paths
    return [line for line in done.stdout.splitlines() if line.startswith(told)]


@pytest.mark.slow
def test_each_frame_gets_a_cel_of_normals(tmp_path: Path) -> None:
    *cels, hidden = run(tmp_path, frames=2)
    assert hidden.split() == ["HIDDEN", "true"]  # an earlier map is no part of the drawing
    assert [cel.split("\t")[:3] for cel in cels] == [["CEL", "Normal map", "1"], ["CEL", "Normal map", "2"]]
    script, settings = tmp_path / "normalgan", ("--alpha", "--frame", "shared")
    by_hand = painted_by_hand(script, DOG, tmp_path / "hand.png", *settings)
    for cel in cels:
        with Image.open(cel.split("\t")[3]) as image:
            assert np.abs(np.asarray(image).astype(int) - by_hand).max() <= 1
    assert not list((tmp_path / "temporary").iterdir())


def test_what_goes_wrong_is_one_sentence(tmp_path: Path) -> None:
    (said,) = [line for line in run(tmp_path, NORMALGAN="/nowhere/normalgan") if line.startswith("ALERT")]
    assert "normalgan was not found: /nowhere/normalgan is not a command; install it and run" in said
    (tmp_path / "scripts" / "normalgan_path.txt").unlink()
    said = "\n".join(run(tmp_path, PATH="/bin-of-nobody"))
    assert "ALERT\tnormalgan was not found; install it" in said
    assert "ALERT\tOpen a sprite first." in run(tmp_path, state="OPEN = false")
    assert any("Sprite > Color Mode > RGB Color" in line for line in run(tmp_path, state="MODE = 1"))


def test_what_the_command_says_is_shown(tmp_path: Path) -> None:
    broken = tmp_path / "broken.png"
    broken.write_bytes(b"no picture")
    (said,) = [line for line in run(tmp_path, drawing=broken) if line.startswith("ALERT")]
    assert "normalgan: " in said
    assert "is not an image that can be read" in said
