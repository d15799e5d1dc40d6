"""Add-ons while the command runs: their program goes on working, and the user can cancel."""

import importlib.util
import sys
import time
from collections.abc import Callable
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any
from unittest.mock import MagicMock

import pytest
from add_ons import ROOT

SLOW = "#!/bin/sh\nexec sleep 60\n"
QUICK = "#!/bin/sh\necho 'normalgan: warning: fox.png: it is a test.' >&2\n"


def loaded(monkeypatch: pytest.MonkeyPatch, folder: str, **others: ModuleType) -> Any:
    """An add-on, with stand-ins for the modules of its program."""
    for name, module in others.items():
        monkeypatch.setitem(sys.modules, name.replace("__", "."), module)
    path = ROOT / "integrations" / folder
    name = path.name
    spec = importlib.util.spec_from_file_location(
        name, path / "__init__.py", submodule_search_locations=[str(path)]
    )
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, name, module)
    monkeypatch.delitem(sys.modules, f"{name}.normalgan_command", raising=False)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[str], None]:
    """Writes the command that add-ons find."""
    path = tmp_path / "normalgan"
    monkeypatch.setenv("NORMALGAN", str(path))

    def write(script: str) -> None:
        path.write_text(script, encoding="utf-8")
        path.chmod(0o755)

    return write


def module(**members: Any) -> Any:
    found: Any = ModuleType("stand_in")
    vars(found).update(members)
    return found


@pytest.fixture(params=[5, 6])
def krita(monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest) -> Any:
    """The plug-in of Krita 5 and 6, whose progress window is ``plugin.QProgressDialog.return_value``."""
    # None: Krita refuses the Qt of another version.
    monkeypatch.setitem(sys.modules, f"PyQt{11 - request.param}", None)
    qt = f"PyQt{request.param}"
    widgets = module(QApplication=MagicMock(), QMessageBox=MagicMock(), QProgressDialog=MagicMock())
    plugin = loaded(
        monkeypatch,
        "krita/normalgan_krita",
        krita=module(
            Extension=type("Extension", (), {"__init__": lambda self, parent: None}), Krita=MagicMock()
        ),
        **{
            qt: module(),
            f"{qt}__QtCore": module(Qt=MagicMock()),
            f"{qt}__QtGui": module(QImage=MagicMock()),
            f"{qt}__QtWidgets": widgets,
        },
    )
    plugin.Krita.instance.return_value.activeDocument.return_value.colorModel.return_value = "RGBA"
    monkeypatch.setattr(plugin, "layer_picture", MagicMock())
    return plugin


def test_krita_works_on_and_cancels(krita: Any, command: Callable[[str], None]) -> None:
    command(SLOW)
    window = krita.QProgressDialog.return_value
    window.wasCanceled.side_effect = [False, False, True]
    begun = time.monotonic()
    krita.NormalMapOfLayer(None).predict()
    assert time.monotonic() - begun < 30
    assert krita.QApplication.processEvents.call_count == 3
    window.close.assert_called_once()
    krita.QMessageBox.warning.assert_not_called()
    document = krita.Krita.instance.return_value.activeDocument.return_value
    document.createNode.assert_not_called()


def test_krita_shows_what_the_command_warned_of(krita: Any, command: Callable[[str], None]) -> None:
    command(QUICK)
    krita.QImage.return_value.convertToFormat.return_value.isNull.return_value = False
    krita.QImage.return_value.convertToFormat.return_value.constBits.return_value = MagicMock(
        __bytes__=lambda _: b""
    )
    krita.QProgressDialog.return_value.wasCanceled.return_value = False
    krita.NormalMapOfLayer(None).predict()
    assert "it is a test" in krita.QMessageBox.warning.call_args.args[-1]


@pytest.fixture
def operator(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Any:
    """The operator of Blender on a drawing, in a Blender with windows."""
    kinds = {name: type(name, (), {}) for name in ("AddonPreferences", "Operator")}
    bpy = module(
        types=SimpleNamespace(**kinds),
        app=SimpleNamespace(background=False),
        data=MagicMock(),
        path=SimpleNamespace(abspath=str, extensions_image=set()),
    )
    props = dict.fromkeys(("BoolProperty", "EnumProperty", "FloatProperty", "StringProperty"), MagicMock())
    add_on = loaded(
        monkeypatch,
        "blender/normalgan_blender",
        bpy=bpy,
        bpy__props=module(**props),
        bpy_extras=module(),
        bpy_extras__io_utils=module(ImportHelper=type("ImportHelper", (), {})),
    )
    bpy.data.images.load.return_value.size = (8, 8)
    bpy.data.objects.get.return_value = None
    found = add_on.NormalganDrawing()
    vars(found).update(filepath=str(tmp_path / "fox.png"), replace=False, surface="CLAY", strength=1)
    found.report = MagicMock()
    for name in ("material_of", "plane"):
        monkeypatch.setattr(add_on, name, MagicMock())
    found.made = add_on.plane
    return found


def test_blender_works_on_and_cancels(operator: Any, command: Callable[[str], None]) -> None:
    command(SLOW)
    context = MagicMock()
    context.preferences.addons.get.return_value = None
    assert operator.execute(context) == {"RUNNING_MODAL"}
    assert operator.modal(context, SimpleNamespace(type="MOUSEMOVE")) == {"PASS_THROUGH"}
    assert operator.modal(context, SimpleNamespace(type="TIMER")) == {"PASS_THROUGH"}
    assert operator.modal(context, SimpleNamespace(type="ESC")) == {"CANCELLED"}
    assert operator._running.ended
    assert not operator._predicted.parent.exists()
    context.window_manager.event_timer_remove.assert_called_once()
    operator.made.assert_not_called()


def test_blender_builds_the_material_when_the_command_has_ended(
    operator: Any, command: Callable[[str], None]
) -> None:
    command(QUICK)
    context = MagicMock()
    context.preferences.addons.get.return_value = None
    assert operator.execute(context) == {"RUNNING_MODAL"}
    operator._running._process.wait()
    assert operator.modal(context, SimpleNamespace(type="TIMER")) == {"FINISHED"}
    operator.made.assert_called_once()
    assert operator.report.call_args.args[0] == {"WARNING"}
