@tool
extends EditorImportPlugin
## Imports a drawing as a CanvasTexture with the predicted map as its normal texture.


func _get_importer_name() -> String:
	return "normalgan"


func _get_visible_name() -> String:
	return "Drawing with normal map (normalgan)"


func _get_recognized_extensions() -> PackedStringArray:
	return PackedStringArray(["png", "jpg", "jpeg", "webp"])


func _get_save_extension() -> String:
	return "res"


func _get_resource_type() -> String:
	return "CanvasTexture"


func _get_priority() -> float:
	return 0.5  # low: pictures stay textures unless the user chooses this importer


func _get_import_order() -> int:
	return 0


func _get_preset_count() -> int:
	return 1


func _get_preset_name(_preset: int) -> String:
	return "Default"


## Since Godot 4.3 the editor shows its progress meanwhile, and imports several drawings at once.
func _can_import_threaded() -> bool:
	return true


func _get_import_options(_path: String, _preset: int) -> Array[Dictionary]:
	return [
		{"name": "strength", "default_value": 1.0, "property_hint": PROPERTY_HINT_RANGE, "hint_string": "0.1,4,0.1"},
		{"name": "cut_out", "default_value": true},
	]


func _get_option_visibility(_path: String, _option: StringName, _options: Dictionary) -> bool:
	return true


func _import(
	source_file: String,
	save_path: String,
	options: Dictionary,
	_platform_variants: Array[String],
	_gen_files: Array[String]
) -> Error:
	var command := find_command()
	if command == "":
		push_error(
			"normalgan was not found; install it and run integrations/install.py again, or set the environment "
			+ "variable NORMALGAN to the path of its command."
		)
		return ERR_FILE_NOT_FOUND
	var drawing_path := ProjectSettings.globalize_path(source_file)
	var map_path := ProjectSettings.globalize_path(save_path + ".normal.png")
	var arguments := ["generate", "--alpha", "--strength", str(options["strength"])]
	arguments += ["-o", map_path, "--", drawing_path]
	var said := []
	var code := OS.execute(command, arguments, said, true)
	var words := "".join(PackedStringArray(said)).strip_edges()
	if code != 0:
		push_error(words if words != "" else "normalgan failed with exit code %d." % code)
		return ERR_SCRIPT_FAILED
	if words.contains("warning:"):
		push_warning(words)
	var drawing := Image.load_from_file(drawing_path)
	var map := Image.load_from_file(map_path)
	if FileAccess.file_exists(map_path):
		DirAccess.remove_absolute(map_path)
	if drawing == null or map == null:
		return ERR_FILE_CANT_READ
	drawing.convert(Image.FORMAT_RGBA8)
	map.convert(Image.FORMAT_RGBA8)
	if options["cut_out"]:
		var size := drawing.get_size()
		var cut := Image.create(size.x, size.y, false, Image.FORMAT_RGBA8)
		cut.blit_rect_mask(drawing, map, Rect2i(Vector2i.ZERO, size), Vector2i.ZERO)
		drawing = cut
	var texture := CanvasTexture.new()
	texture.diffuse_texture = ImageTexture.create_from_image(drawing)
	texture.normal_texture = ImageTexture.create_from_image(map)
	return ResourceSaver.save(texture, "%s.%s" % [save_path, _get_save_extension()])


## Returns the command from NORMALGAN, the installer's note or the search path, or an empty text if there is none.
func find_command() -> String:
	var given := OS.get_environment("NORMALGAN")
	var note: String = (get_script() as Script).resource_path.get_base_dir() + "/normalgan_path.txt"
	if given == "" and FileAccess.file_exists(note):
		given = FileAccess.get_file_as_string(note).strip_edges()
	if given != "":
		return given if FileAccess.file_exists(given) else ""
	var windows := OS.get_name() == "Windows"
	for folder in OS.get_environment("PATH").split(";" if windows else ":"):
		var path := folder + ("/normalgan.exe" if windows else "/normalgan")
		if FileAccess.file_exists(path):
			return path
	return ""
