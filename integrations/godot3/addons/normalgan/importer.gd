tool
extends EditorImportPlugin
# Imports a drawing as a scene of one Sprite, with the drawing as its texture and the predicted map as its normal map.
# Godot 3 has no texture that holds both. Unlike those of Godot 4, its 2D lights expect green down.


func get_importer_name():
	return "normalgan"


func get_visible_name():
	return "Drawing with normal map (normalgan)"


func get_recognized_extensions():
	return ["png", "jpg", "jpeg", "webp"]


func get_save_extension():
	return "scn"


func get_resource_type():
	return "PackedScene"


func get_preset_count():
	return 1


func get_preset_name(_preset):
	return "Default"


func get_import_options(_preset):
	return [
		{"name": "strength", "default_value": 1.0, "property_hint": PROPERTY_HINT_RANGE, "hint_string": "0.1,4,0.1"},
		{"name": "cut_out", "default_value": true},
	]


func get_option_visibility(_option, _options):
	return true


func import(source_file, save_path, options, _platform_variants, _gen_files):
	var command = find_command()
	if command == "":
		push_error(
			"normalgan was not found; install it and run integrations/install.py again, or set the environment "
			+ "variable NORMALGAN to the path of its command."
		)
		return ERR_FILE_NOT_FOUND
	var map_path = ProjectSettings.globalize_path(save_path + ".normal.png")
	var arguments = ["generate", "--y", "down", "--alpha", "--strength", str(options.strength)]
	arguments += ["-o", map_path, "--", ProjectSettings.globalize_path(source_file)]
	var said = []
	var code = OS.execute(command, arguments, true, said, true)
	var words = PoolStringArray(said).join("").strip_edges()
	if code != 0:
		push_error(words if words != "" else "normalgan failed with exit code %d." % code)
		return ERR_SCRIPT_FAILED
	var warning = words.find("warning:")
	if warning >= 0:
		push_warning(words)
	var drawing = Image.new()
	var map = Image.new()
	var error = drawing.load(ProjectSettings.globalize_path(source_file))
	if error == OK:
		error = map.load(map_path)
	var folder = Directory.new()
	for left in [map_path, map_path + ".import"]:
		if folder.file_exists(left):
			folder.remove(left)
	if error != OK:
		return error
	drawing.convert(Image.FORMAT_RGBA8)
	map.convert(Image.FORMAT_RGBA8)
	if options.cut_out:
		var cut = Image.new()
		var size = drawing.get_size()
		cut.create(int(size.x), int(size.y), false, Image.FORMAT_RGBA8)
		cut.blit_rect_mask(drawing, map, Rect2(Vector2(), size), Vector2())
		drawing = cut
	var sprite = Sprite.new()
	sprite.name = source_file.get_file().get_basename()
	sprite.texture = texture_of(drawing)
	sprite.normal_map = texture_of(map)
	var scene = PackedScene.new()
	error = scene.pack(sprite)
	sprite.free()
	if error != OK:
		return error
	return ResourceSaver.save("%s.%s" % [save_path, get_save_extension()], scene)


func texture_of(image):
	var texture = ImageTexture.new()
	texture.storage = ImageTexture.STORAGE_COMPRESS_LOSSLESS
	texture.create_from_image(image, Texture.FLAG_FILTER)
	return texture


# Returns the command from NORMALGAN, the installer's note or the search path, or an empty text if there is none.
func find_command():
	var file = File.new()
	var given = OS.get_environment("NORMALGAN")
	var note = get_script().resource_path.get_base_dir() + "/normalgan_path.txt"
	if given == "" and file.open(note, File.READ) == OK:
		given = file.get_as_text().strip_edges()
		file.close()
	if given != "":
		return given if file.file_exists(given) else ""
	var windows = OS.get_name() == "Windows"
	for folder in OS.get_environment("PATH").split(";" if windows else ":"):
		var path = folder + ("/normalgan.exe" if windows else "/normalgan")
		if file.file_exists(path):
			return path
	return ""
