-- Script for Aseprite: puts the normal maps of all frames of the sprite on a layer above the others.
-- `normalgan generate` (green up, 8 bits) predicts the visible part of every frame. One call handles
-- all frames, so that they share one crop and do not flicker.

local LAYER = "Normal map"
local windows = app.fs.pathSeparator == "\\"

local function quoted(text)
  if windows then
    return '"' .. text .. '"'
  end
  return "'" .. text:gsub("'", "'\\''") .. "'"
end

local function content(path)
  local file = io.open(path, "r")
  if not file then
    return ""
  end
  local text = file:read("a")
  file:close()
  return (text:gsub("^%s+", ""):gsub("%s+$", ""))
end

-- The command: from NORMALGAN, the installer's note or the search path.
local function command()
  local given = os.getenv("NORMALGAN") or ""
  if given == "" then
    given = content(app.fs.joinPath(app.fs.userConfigPath, "scripts", "normalgan_path.txt"))
  end
  if given == "" then
    return "normalgan", nil
  end
  if not app.fs.isFile(given) then
    return nil,
      "normalgan was not found: "
        .. given
        .. " is not a command; install it and run integrations/install.py again, or set the environment variable "
        .. "NORMALGAN to the path of its command."
  end
  return given, nil
end

local function paint(sprite)
  local program, missing = command()
  if missing then
    return missing
  end
  local base = app.fs.joinPath(app.fs.tempPath, "normalgan_" .. os.time() .. "_" .. math.random(100000))
  local said = base .. ".txt"
  local drawn, painted, left = {}, {}, { said }
  local arguments = { quoted(program), "generate", "--alpha", "-o", quoted(app.fs.tempPath) }
  if #sprite.frames > 1 then
    table.insert(arguments, "--frame")
    table.insert(arguments, "shared")
  end
  table.insert(arguments, "--")
  for number, frame in ipairs(sprite.frames) do
    local image = Image(sprite.width, sprite.height, ColorMode.RGB)
    image:drawSprite(sprite, frame)
    drawn[number] = string.format("%s_%04d.png", base, number)
    painted[number] = string.format("%s_%04d_normal.png", base, number)
    image:saveAs(drawn[number])
    table.insert(arguments, quoted(drawn[number]))
    table.insert(left, drawn[number])
    table.insert(left, painted[number])
  end
  local line = table.concat(arguments, " ") .. " 2> " .. quoted(said)
  if windows then
    line = '"' .. line .. '"' -- cmd removes the outer quotes
  end
  local done = os.execute(line)
  local words = content(said)
  local problem = nil
  if not done then
    problem = words
    if words == "" then
      problem = "normalgan failed without a word."
    elseif not ("\n" .. words):find("\nnormalgan: ", 1, true) then
      -- The message is the shell's own: there is no such command.
      problem = "normalgan was not found; install it and run integrations/install.py again, or set the environment "
        .. "variable NORMALGAN to the path of its command."
    end
  else
    app.transaction(function()
      local layer = sprite:newLayer()
      layer.name = LAYER
      for number, frame in ipairs(sprite.frames) do
        sprite:newCel(layer, frame, Image({ fromFile = painted[number] }), Point(0, 0))
      end
    end)
    if words:find("warning:", 1, true) then
      problem = words
    end
  end
  for _, path in ipairs(left) do
    os.remove(path)
  end
  return problem
end

local sprite = app.activeSprite
local problem
if not sprite then
  problem = "Open a sprite first."
elseif sprite.colorMode ~= ColorMode.RGB then
  problem = "A layer of normals needs the colour mode RGB: Sprite > Color Mode > RGB Color."
else
  for _, layer in ipairs(sprite.layers) do
    if layer.name == LAYER then
      layer.isVisible = false -- an earlier map is not part of the drawing
    end
  end
  problem = paint(sprite)
end
if problem then
  app.alert({ title = "normalgan", text = problem })
end
app.refresh()
