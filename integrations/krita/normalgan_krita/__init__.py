"""Plug-in for Krita: puts the normal map of a layer on a new layer above it."""

import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

from krita import Extension, Krita

try:  # PyQt5 comes first: Krita 6 rejects it, whereas an old Krita 5 loads an installed PyQt6 and crashes.
    from PyQt5.QtCore import Qt
    from PyQt5.QtGui import QImage
    from PyQt5.QtWidgets import QApplication, QMessageBox, QProgressDialog
except ImportError:
    from PyQt6.QtCore import Qt
    from PyQt6.QtGui import QImage
    from PyQt6.QtWidgets import QApplication, QMessageBox, QProgressDialog

from .normalgan_command import CancelledError, CommandError, predict

NAME = "Normal map"
SRGB = "sRGB-elle-V2-srgbtrc.icc"


def normal_layer(
    document: Any, node: Any, *settings: str, meanwhile: Callable[[], bool] | None = None
) -> tuple[Any, str]:
    """Predict the normal map of a layer.

    Args:
        document: a document of Krita.
        node: a layer or a group in it.
        settings: further settings of `normalgan generate`.
        meanwhile: as in `predict`.

    Returns:
        The new layer above it, and the command's warnings.

    Raises:
        CancelledError: if ``meanwhile`` says so.
        CommandError: with a sentence for the user.
    """
    if document.colorModel() != "RGBA":
        raise CommandError("A normal map needs an RGB document: Image > Convert Image Color Space.")
    with tempfile.TemporaryDirectory() as folder:
        drawn, predicted = Path(folder) / "layer.png", Path(folder) / "normals.png"
        if not layer_picture(document, node).save(str(drawn)):
            raise CommandError(f"Krita could not write the layer {node.name()} as a picture.")
        warned = predict(drawn, predicted, "--alpha", *settings, meanwhile=meanwhile)
        image = QImage(str(predicted)).convertToFormat(QImage.Format.Format_ARGB32)
    if image.isNull():
        raise CommandError("Krita could not read the normal map.")
    bits = image.constBits()
    bits.setsize(image.sizeInBytes())
    layer = document.createNode(NAME, "paintlayer")
    layer.setColorSpace("RGBA", "U8", SRGB)  # keeps the numbers whatever the document's colour space
    layer.setPixelData(bytes(bits), 0, 0, image.width(), image.height())
    node.parentNode().addChildNode(layer, node)
    document.refreshProjection()
    return layer, warned


def layer_picture(document: Any, node: Any) -> Any:
    """Return a layer's picture of the whole canvas as a Qt image."""
    width, height = document.width(), document.height()
    copy = None
    if (node.colorModel(), node.colorDepth()) != ("RGBA", "U8"):
        copy = document.clone()
        copy.setBatchmode(True)
        copy.setColorSpace("RGBA", "U8", SRGB)
        copy.waitForDone()
        node = copy.nodeByUniqueID(node.uniqueId())
    pixels = bytes(node.projectionPixelData(0, 0, width, height))
    if copy is not None:
        copy.close()
    return QImage(pixels, width, height, 4 * width, QImage.Format.Format_ARGB32).copy()


class NormalMapOfLayer(Extension):
    """The entry under Tools > Scripts."""

    def setup(self) -> None:
        """Do nothing when Krita starts."""

    def createActions(self, window: Any) -> None:  # noqa: N802 - Krita's name
        """Add the entry to a window."""
        action = window.createAction(
            "normalgan_layer", "Normal map of the layer (normalgan)", "tools/scripts"
        )
        action.triggered.connect(self.predict)

    def predict(self) -> None:
        """Predict the map of the active layer behind a dialogue with Cancel, and show any error."""
        document = Krita.instance().activeDocument()
        if document is None:
            return
        window = QProgressDialog("Predicting the normal map…", "Cancel", 0, 0)
        window.setWindowModality(Qt.WindowModality.ApplicationModal)  # the document must not change meanwhile
        window.show()

        def goes_on() -> bool:
            QApplication.processEvents()
            return not window.wasCanceled()

        try:
            _, said = normal_layer(document, document.activeNode(), meanwhile=goes_on)
        except CancelledError:
            said = ""
        except CommandError as error:
            said = str(error)
        finally:
            window.close()
        if said:
            QMessageBox.warning(None, "normalgan", said)


Krita.instance().addExtension(NormalMapOfLayer(Krita.instance()))
