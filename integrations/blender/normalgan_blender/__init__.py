"""Add-on for Blender: turns a drawing into a plane with a lit material that uses the drawing's normal map."""

import tempfile
from pathlib import Path
from typing import Any

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, StringProperty
from bpy_extras.io_utils import ImportHelper

from .normalgan_command import CommandError, Running

bl_info = {
    "name": "normalgan: drawing to lit material",
    "author": "The normalgan authors",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "3D Viewport > Add > Image > Drawing with Normal Map",
    "description": "Paints the normal map of a drawing and makes a material of it",
    "category": "Material",
}


class NormalganPreferences(bpy.types.AddonPreferences):
    """The path of the command, if it is not found automatically."""

    bl_idname = __name__

    command: StringProperty(  # type: ignore[valid-type]
        name="normalgan", subtype="FILE_PATH", description="The command, if it is not found automatically"
    )

    def draw(self, _context: Any) -> None:
        """Show the only setting."""
        self.layout.prop(self, "command")


class NormalganDrawing(bpy.types.Operator, ImportHelper):
    """Predict the normal map of a drawing, and make a material with it.

    Blender stays usable meanwhile: a timer checks whether the command has ended, and Esc cancels it.
    """

    bl_idname = "normalgan.drawing"
    bl_label = "Drawing with Normal Map"
    bl_options = {"REGISTER", "UNDO"}  # noqa: RUF012 - Blender reads it so

    filter_glob: StringProperty(  # type: ignore[valid-type]
        default="*.png;*.apng;*.jpg;*.jpeg;*.webp;*.bmp;*.tif;*.tiff;*.gif;*.svg;*.avif;*.heic;*.heif;"
        "*.psd;*.kra;*.ora;*.ase;*.aseprite",
        options={"HIDDEN"},
    )
    surface: EnumProperty(  # type: ignore[valid-type]
        name="Surface",
        items=[
            ("CLAY", "Clay", "One colour, under the lines' relief alone"),
            ("DRAWING", "Drawing", "The drawing's own colours"),
        ],
    )
    strength: FloatProperty(name="Strength", default=1, min=0, soft_max=2)  # type: ignore[valid-type]
    replace: BoolProperty(  # type: ignore[valid-type]
        name="Onto the active object", description="Rather than onto a new plane", default=False
    )

    def execute(self, context: Any) -> set[str]:
        """Start the command; without a window, also wait for it and build the material."""
        active = context.active_object
        if self.replace and (active is None or not hasattr(active.data, "materials")):
            self.report({"ERROR"}, "normalgan: no object that takes a material is active; select one.")
            return {"CANCELLED"}
        self._active = active.name if self.replace else ""
        self._drawing = Path(bpy.path.abspath(self.filepath))
        self._folder = tempfile.TemporaryDirectory()
        self._predicted = Path(self._folder.name) / f"{self._drawing.stem}_normal.png"
        add_on = context.preferences.addons.get(__name__)
        chosen = bpy.path.abspath(add_on.preferences.command) if add_on else ""
        try:
            self._running = Running(self._drawing, self._predicted, "--bits", "16", "--alpha", chosen=chosen)
        except CommandError as error:
            self._folder.cleanup()
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        if bpy.app.background:
            return self._built(context)
        self._timer = context.window_manager.event_timer_add(0.1, window=context.window)
        context.window_manager.modal_handler_add(self)
        context.workspace.status_text_set("normalgan: predicting the normal map. Esc: cancel")
        return {"RUNNING_MODAL"}

    def modal(self, context: Any, event: Any) -> set[str]:
        """Build the material once the command has ended; end the command on Esc."""
        if event.type == "ESC":
            self.cancel(context)
            self.report({"INFO"}, "normalgan: cancelled.")
            return {"CANCELLED"}
        if event.type != "TIMER" or not self._running.ended:
            return {"PASS_THROUGH"}
        self._stop_timer(context)
        return self._built(context)

    def cancel(self, context: Any) -> None:
        """End the command; Blender also calls this on exit."""
        self._stop_timer(context)
        self._running.cancel()
        self._folder.cleanup()

    def _stop_timer(self, context: Any) -> None:
        context.window_manager.event_timer_remove(self._timer)
        context.workspace.status_text_set(None)

    def _built(self, context: Any) -> set[str]:
        """Build the material from the files that the command has written."""
        drawing = self._drawing
        try:
            with self._folder:
                warned = self._running.result()
                normals = bpy.data.images.load(str(self._predicted))
                set_non_color(normals)  # before it is packed, which reads it
                normals.pack()
        except CommandError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        active = bpy.data.objects.get(self._active)
        if warned:
            self.report({"WARNING"}, warned)
        colours = None
        if self.surface == "DRAWING" and drawing.suffix.lower() in bpy.path.extensions_image:
            colours = bpy.data.images.load(str(drawing), check_existing=True)
        material = material_of(drawing.stem, normals, colours, self.strength)
        target = active or plane(context, drawing.stem, *normals.size)
        target.data.materials.clear()
        target.data.materials.append(material)
        return {"FINISHED"}


def set_non_color(image: Any) -> None:
    """Mark an image as data instead of colours, under any OCIO configuration."""
    space, usual = image.colorspace_settings, image.colorspace_settings.name
    space.is_data = True  # the space with the role "data" in the OCIO configuration
    if space.name == usual:  # no space has that role
        spaces = space.bl_rna.properties["name"].enum_items.keys()
        space.name = next((raw for raw in ("Non-Color", "Raw", "Utility - Raw") if raw in spaces), usual)


def material_of(name: str, normals: Any, colours: Any | None, strength: float) -> Any:
    """Return a material with a normal map, transparent where the map has no object."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    material.blend_method = "HASHED"
    nodes, links = material.node_tree.nodes, material.node_tree.links
    shader = next(node for node in nodes if node.type == "BSDF_PRINCIPLED")
    shader.inputs["Base Color"].default_value = (0.7, 0.45, 0.25, 1)
    shader.inputs["Roughness"].default_value = 0.7
    texture = nodes.new("ShaderNodeTexImage")
    texture.image, texture.location = normals, (-620, -200)
    bend = nodes.new("ShaderNodeNormalMap")
    bend.inputs["Strength"].default_value, bend.location = strength, (-280, -250)
    links.new(texture.outputs["Color"], bend.inputs["Color"])
    links.new(bend.outputs["Normal"], shader.inputs["Normal"])
    links.new(texture.outputs["Alpha"], shader.inputs["Alpha"])
    if colours is not None:
        picture = nodes.new("ShaderNodeTexImage")
        picture.image, picture.location = colours, (-620, 150)
        links.new(picture.outputs["Color"], shader.inputs["Base Color"])
    return material


def plane(context: Any, name: str, width: int, height: int) -> Any:
    """Return a new plane with a picture's proportions, 2 units on its longer side, facing up."""
    x, y = width / max(width, height), height / max(width, height)
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([(-x, -y, 0), (x, -y, 0), (x, y, 0), (-x, y, 0)], [], [(0, 1, 2, 3)])
    layer = mesh.uv_layers.new()
    for corner, uv in zip(layer.data, [(0, 0), (1, 0), (1, 1), (0, 1)], strict=True):
        corner.uv = uv
    made = bpy.data.objects.new(name, mesh)
    context.collection.objects.link(made)
    context.view_layer.objects.active = made
    made.select_set(True)
    return made


CLASSES = (NormalganPreferences, NormalganDrawing)


def entry(self: Any, _context: Any) -> None:
    """Draw the menu entry."""
    self.layout.operator(NormalganDrawing.bl_idname, icon="IMAGE_DATA")


def register() -> None:
    """Add the operator and its menu entry."""
    for known in CLASSES:
        bpy.utils.register_class(known)
    bpy.types.VIEW3D_MT_image_add.append(entry)


def unregister() -> None:
    """Remove the operator and its menu entry."""
    bpy.types.VIEW3D_MT_image_add.remove(entry)
    for known in reversed(CLASSES):
        bpy.utils.unregister_class(known)
