#!/usr/bin/env python3
"""Plug-in for GIMP 3: puts the normal map of a layer on a new layer above it."""

import sys
import tempfile
from pathlib import Path
from typing import Any

import gi

gi.require_version("Gimp", "3.0")
from gi.repository import Gimp, Gio, GLib, GObject  # noqa: E402 - only once the version is chosen
from normalgan_command import CommandError, predict  # noqa: E402

NAME = "plug-in-normalgan-layer"
ALONE = Gimp.RunMode.NONINTERACTIVE
PREDICTED = "predicted"
FORMS = {
    PREDICTED: "As predicted",
    "round": "Round",
    "flat": "Flat, with a bevelled edge",
    "hollow": "Hollow",
}


def normal_layer(image: Any, drawable: Any, strength: float, form: str) -> Any:
    """Predict the normal map of a layer, and return the new layer above it.

    Args:
        image: the image that contains the layer.
        drawable: the layer.
        strength: factor of the slopes.
        form: one of `FORMS`.

    Raises:
        CommandError: with a sentence for the user.
    """
    with tempfile.TemporaryDirectory() as folder:
        drawn, predicted = (str(Path(folder) / name) for name in ("layer.png", "normals.png"))
        copy = Gimp.Image.new(drawable.get_width(), drawable.get_height(), Gimp.ImageBaseType.RGB)
        try:
            alone = Gimp.Layer.new_from_drawable(drawable, copy)
            copy.insert_layer(alone, None, 0)
            alone.set_offsets(0, 0)
            alone.set_opacity(100)
            alone.set_visible(True)
            if not Gimp.file_save(ALONE, copy, Gio.File.new_for_path(drawn), None):
                raise CommandError("GIMP: the layer cannot be saved as a PNG.")
        finally:
            copy.delete()
        formed = () if form == PREDICTED else ("--form", form)
        warned = predict(drawn, predicted, "--alpha", "--strength", f"{strength:g}", *formed)
        if warned:
            Gimp.message(warned)
        layer = Gimp.file_load_layer(ALONE, image, Gio.File.new_for_path(predicted))
    _, x, y = drawable.get_offsets()
    image.undo_group_start()
    layer.set_name("Normal map")
    image.insert_layer(layer, drawable.get_parent(), image.get_item_position(drawable))
    layer.set_offsets(x, y)
    image.undo_group_end()
    Gimp.displays_flush()
    return layer


class NormalLayer(Gimp.PlugIn):
    """The plug-in as GIMP queries it: its procedures and their arguments."""

    def do_set_i18n(self, _name: str) -> bool:
        """Return False: there are no translations."""
        return False

    def do_query_procedures(self) -> list[str]:
        """Return the names of the procedures."""
        return [NAME]

    def do_create_procedure(self, name: str) -> Any:
        """Return the procedure with a name."""
        procedure = Gimp.ImageProcedure.new(self, name, Gimp.PDBProcType.PLUGIN, run, None)
        procedure.set_image_types("RGB*")
        procedure.set_sensitivity_mask(Gimp.ProcedureSensitivityMask.DRAWABLE)
        procedure.set_menu_label("_Normal map of the drawing (normalgan)…")
        procedure.add_menu_path("<Image>/Filters/Map")
        about = "Predicts the normal map of the layer with normalgan, as a new layer above it."
        procedure.set_documentation("Predict the normal map of a drawing", about, name)
        procedure.set_attribution("The normalgan authors", "MIT", "2026")
        given = GObject.ParamFlags.READWRITE
        slopes = "What slopes are multiplied by; 1 as predicted"
        procedure.add_double_argument("strength", "S_trength", slopes, 0.01, 100, 1, given)
        forms = Gimp.Choice.new()
        for number, (form, label) in enumerate(FORMS.items()):
            forms.add(form, number, label, "")
        whole = "The form of the whole drawing, such as flat for a coin or a card"
        procedure.add_choice_argument("form", "_Form", whole, forms, PREDICTED, given)
        procedure.add_layer_return_value("layer", "Layer", "The new layer", False, given)
        return procedure


def asked(procedure: Any, config: Any) -> bool:
    """Show the settings, and return whether the user confirmed."""
    gi.require_version("GimpUi", "3.0")
    from gi.repository import GimpUi  # it loads GTK, which needs a screen

    GimpUi.init("normalgan")
    dialog = GimpUi.ProcedureDialog.new(procedure, config, "Normal map")
    dialog.fill(None)
    goes_on: bool = dialog.run()
    dialog.destroy()
    return goes_on


def run(procedure: Any, mode: Any, image: Any, drawables: list[Any], config: Any, _data: object) -> Any:
    """Run the procedure, and return the new layer, or an error that GIMP shows."""
    try:
        if len(drawables) != 1 or not isinstance(drawables[0], Gimp.Layer):
            raise CommandError(f"{len(drawables)} layers or masks are chosen; choose one layer.")
        if mode == Gimp.RunMode.INTERACTIVE and not asked(procedure, config):
            return procedure.new_return_values(Gimp.PDBStatusType.CANCEL, None)
        given = (config.get_property(name) for name in ("strength", "form"))
        layer = normal_layer(image, drawables[0], *given)
    except (CommandError, OSError, GLib.Error) as error:
        said = error.message if isinstance(error, GLib.Error) else str(error)
        failed = GLib.Error.new_literal(Gimp.PlugIn.error_quark(), said, 0)
        return procedure.new_return_values(Gimp.PDBStatusType.EXECUTION_ERROR, failed)
    done = GObject.Value(Gimp.PDBStatusType, Gimp.PDBStatusType.SUCCESS)
    return Gimp.ValueArray.new_from_values([done, GObject.Value(Gimp.Layer, layer)])


Gimp.main(NormalLayer.__gtype__, sys.argv)
