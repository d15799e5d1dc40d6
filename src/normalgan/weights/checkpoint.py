"""The model in a checkpoint, read with checks of all settings and without importing anything."""

import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path, PurePath
from typing import Any

import yaml
from packaging.version import InvalidVersion, Version
from torch import Tensor
from torch.optim import Optimizer
from torch.optim.lr_scheduler import LRScheduler

from normalgan.errors import InputError
from normalgan.files.limits import MOST_SETTINGS, load_yaml, read_bounded, yaml_limit_error
from normalgan.files.torch_files import load_torch_file
from normalgan.hints import HINT_SAMPLERS
from normalgan.line_widths import USUAL_WIDTHS, check_line_widths
from normalgan.losses import ADVERSARIAL_OBJECTIVES, RECONSTRUCTIONS
from normalgan.models import DISCRIMINATORS, GENERATORS
from normalgan.registry import Registry, class_path, find_imported
from normalgan.weights.class_spec import ANY_NUMBER, LARGEST_SETTING, ClassSpec, is_plain
from normalgan.weights.file import SUFFIXES, Weights, read_weights
from normalgan.weights.metadata import ModelMetadata
from normalgan.weights.network import check_fit, naming_model

REGISTRIES: dict[str, tuple[Registry[Any], int]] = {
    "generator": (GENERATORS, LARGEST_SETTING),
    "discriminator": (DISCRIMINATORS, LARGEST_SETTING),
    "hint_sampler": (HINT_SAMPLERS, LARGEST_SETTING),
    "objective": (ADVERSARIAL_OBJECTIVES, ANY_NUMBER),  # loss weights, which do not affect memory
    "reconstruction": (RECONSTRUCTIONS, ANY_NUMBER),
}
"""Registry of each argument that takes a plug-in, and the largest number accepted in its settings."""
OF_TORCH: dict[str, type[Any]] = {
    "generator_optimizer": Optimizer,
    "discriminator_optimizer": Optimizer,
    "lr_scheduler": LRScheduler,
}
"""Base class of each argument that takes a torch class."""
DEFAULT_OPTIMIZER = "normalgan.gan._rmsprop"
MADE_IN_PYTHON = "made_in_python"
"""Key that marks an argument whose object cannot be described by plain values."""
_COMPILED = "_orig_mod."
PICTURE_SIZE = "picture_size"
"""Key of a checkpoint's entry with the side of its pictures in pixels."""
_RENAMED_SETTINGS = {"steadiness": "distractor_consistency"}
"""New names of settings in checkpoints from before version 0.1.0, by old name. Class paths need no such
table, because `Registry.find` finds a class of a package by its short name."""
_VERSION = "pytorch-lightning_version"
_PROGRESS = ("epoch", "global_step", _VERSION, "loops", "optimizer_states", "lr_schedulers")
_PATHS = ("best_model_path", "kth_best_model_path", "last_model_path")


@dataclass(frozen=True)
class Checkpoint:
    """A checkpoint of `normalgan fit`, read without importing or running its code.

    Args:
        path: path of the file.
        settings: settings of the model, as in the file.
        tensors: memory-mapped weights and statistics of the model's networks by name.
        callbacks: states of the callbacks by name.
        progress: the run's progress and the state of its optimisers; `check_progress` says whether it can be
            resumed.
        size: side in pixels of its training images, if the file records it.
    """

    path: Path
    settings: Mapping[str, Any]
    tensors: Mapping[str, Tensor]
    callbacks: Mapping[Any, Any]
    progress: Mapping[str, Any]
    size: int | None = None

    def weights(self, size: int | None = None) -> Weights:
        """Return the generator with its metadata, as in a weights file.

        Args:
            size: side of the pictures in pixels; None for the training size, if the model or its run
                records it.

        Raises:
            InputError: if the size is unknown, the generator cannot be built here, or the tensors do not
                fit it.
        """
        size = size or self.trained_size()
        if size is None:
            raise InputError(
                f"{self.path} does not say the size of its pictures; give the --data.size of its training, "
                "as --size to export or as size=… to normalgan.load."
            )
        with naming_model(self.path):
            generator = _part("generator", self.settings["generator"])
            tensors = self.tensors_of("generator")
            check_fit(generator, tensors, GENERATORS)
            notes = ModelMetadata(
                generator=generator,
                hint_sampler=_unchecked_part("hint_sampler", self.settings["hint_sampler"]),
                size=size,
                noise_at_test=bool(self.settings.get("noise_at_test", False)),
                seed=int(_number("seed", self.settings.get("seed", 0))),
                refined=bool(self.settings.get("refined", False)),
                line_widths=check_line_widths(self.settings.get("line_widths", USUAL_WIDTHS)),
            )
            return Weights(notes, tensors)

    def trained_size(self) -> int | None:
        """Return the generator's fixed size or, if it accepts any size, the size of the run's data.

        The size of the data is in the run's ``config.yaml``, in the parent folder.
        """
        size = self.generator_size()
        size = self.size if size is None else size
        return _size_of_run(self.path.absolute().parent.parent / "config.yaml") if size is None else size

    def generator_size(self) -> int | None:
        """Return the size that the generator was built for, or None if it accepts any size."""
        arguments = self.settings["generator"].get("init_args") or {}
        size = arguments.get("size") if isinstance(arguments, Mapping) else None
        return size if type(size) is int else None

    def training_settings(self) -> dict[str, Any]:
        """Return all settings of the model for training, as in a configuration.

        Raises:
            InputError: if the settings contain anything but plain values, registered classes, and already
                imported optimisers and schedules, or if networks and tensors do not match.
        """
        with naming_model(self.path):
            self._check_callbacks()
            settings = {name: _configuration(name, value) for name, value in self.settings.items()}
            for name in ("generator", "discriminator"):
                if self.settings.get(name) is not None:
                    part, tensors = _part(name, self.settings[name]), self.tensors_of(name)
                    # Non-finite values are accepted, because a user may want to examine them.
                    check_fit(part, tensors, REGISTRIES[name][0], finite=False)
        return settings

    def check_progress(self, loops: Mapping[str, Any]) -> None:
        """Check everything that a run restores besides the model.

        Args:
            loops: loop state of a new run, as the expected structure.

        Raises:
            InputError: if a run cannot be resumed from this checkpoint.
        """
        networks = [name for name in ("generator", "discriminator") if self.settings.get(name) is not None]
        schedules = networks if self.settings.get("lr_scheduler") is not None else []
        found = self.progress
        sound = {
            "epoch": _has_form(found["epoch"], 0),
            "global_step": _has_form(found["global_step"], 0),
            _VERSION: _is_recent(found[_VERSION]),
            "loops": _has_loops(found["loops"], loops),
            "lr_schedulers": _are_dicts(found["lr_schedulers"], len(schedules)),
            "optimizer_states": _are_dicts(found["optimizer_states"], len(networks))
            and all(map(self._fits, networks, found["optimizer_states"])),
        }
        if wrong := next((name for name, is_sound in sound.items() if not is_sound), None):
            raise InputError(
                f"no run can be resumed from {self.path}: its {wrong} is not what `normalgan fit` saves."
            )

    def _fits(self, network: str, state: Mapping[str, Any]) -> bool:
        """Return whether an optimiser's state fits a network."""
        shapes = {tensor.shape for tensor in self.tensors_of(network).values()}
        match state:
            case {"state": dict(kept), "param_groups": [{"params": [*_]}, *_]}:
                values = [
                    value for each in kept.values() if isinstance(each, dict) for value in each.values()
                ]
                tensors = [value for value in values if isinstance(value, Tensor)]
                return all(tensor.numel() == 1 or tensor.shape in shapes for tensor in tensors)
            case _:
                return False

    def tensors_of(self, network: str) -> dict[str, Tensor]:
        """Return the weights and statistics of a network by name, empty if there are none."""
        prefix = f"{network}."
        return {k.removeprefix(prefix): v for k, v in self.tensors.items() if k.startswith(prefix)}

    def _check_callbacks(self) -> None:
        """Check that all files that a resumed run may delete are checkpoints in its folder."""
        for state in self.callbacks.values():
            if not isinstance(state, Mapping) or "best_model_path" not in state:
                continue
            best = state.get("best_k_models")
            for path in [*(state.get(name) for name in _PATHS), *(best if isinstance(best, Mapping) else ())]:
                text = path if isinstance(path, str) else ""
                if path and (not text.endswith(".ckpt") or "://" in text or ".." in PurePath(text).parts):
                    raise InputError(f"it names {ascii(path)[:60]} as a checkpoint of its run.")


def read_checkpoint(path: Path) -> Checkpoint:
    """Read a checkpoint; the methods of `Checkpoint` check whether its model can be used.

    Raises:
        InputError: if the file is missing, damaged or not a checkpoint of this package.
    """
    content = load_torch_file(path)
    if not isinstance(content, dict):
        content = {}
    settings, tensors = content.get("hyper_parameters"), content.get("state_dict")
    callbacks = content.get("callbacks", {})
    if (
        not isinstance(settings, dict)
        or not {"generator", "hint_sampler", "objective"} <= settings.keys()
        or not isinstance(settings["generator"], dict)
        or not isinstance(tensors, dict)
        or not all(isinstance(k, str) and isinstance(v, Tensor) for k, v in tensors.items())
        or not isinstance(callbacks, dict)
    ):
        raise InputError(f"{path} holds no normalgan model; give one that `normalgan fit` saved.")
    # torch.compile prefixes the names of a network's weights.
    tensors = {uncompiled(name): tensor for name, tensor in tensors.items()}
    size = content.get(PICTURE_SIZE)
    size = size if type(size) is int and 1 <= size <= LARGEST_SETTING else None
    # Lightning's note on how to build the model, which is not needed.
    settings = {
        _RENAMED_SETTINGS.get(name, name): value
        for name, value in ((str(name), value) for name, value in settings.items())
        if name != "_instantiator"
    }
    progress = {name: content.get(name) for name in _PROGRESS}
    return Checkpoint(path, settings, tensors, callbacks, progress, size)


def read_model(path: Path, size: int | None = None) -> Weights:
    """Return the weights in a safetensors, ONNX or checkpoint file.

    Args:
        path: path of the file.
        size: side of the training pictures of a checkpoint in pixels; None if the file records it.

    Raises:
        InputError: if the file is missing, damaged or of another kind, or if the size is unknown.
    """
    return read_weights(path) if path.suffix.lower() in SUFFIXES else read_checkpoint(path).weights(size)


def uncompiled(name: str) -> str:
    """Return the name of a weight without the prefix of ``torch.compile``.

    >>> uncompiled("generator._orig_mod.stem.weight")
    'generator.stem.weight'
    """
    return name.replace(_COMPILED, "")


def _part(name: str, value: Any) -> ClassSpec:
    registry, largest = REGISTRIES[name]
    _check_named(name, value)
    part = ClassSpec.of(value, largest)
    cls = part.find(registry)
    own = registry.find(cls.__name__) is cls
    return ClassSpec(cls.__name__ if own else class_path(cls), part.settings)


def _unchecked_part(name: str, value: Any) -> ClassSpec | None:
    """Return a component that inference does not use, and whose class may be unknown here.

    It returns None if the object was made in Python from values that are not plain.
    """
    registry, largest = REGISTRIES[name]
    if isinstance(value, dict) and value.keys() == {MADE_IN_PYTHON}:
        return None
    part = ClassSpec.of(value, largest)
    return _part(name, value) if registry.find(part.name) else part


def _configuration(name: str, value: Any) -> Any:
    """Return a setting of the model as written in a configuration."""
    if name in REGISTRIES:
        optional = name == "discriminator" and value is None
        return None if optional else _as_named(value, _part(name, value).configuration(REGISTRIES[name][0]))
    if name == "line_widths":
        return list(check_line_widths(value))
    if name not in OF_TORCH:
        if name.startswith("_"):  # from Lightning, for a model of another class
            raise InputError(f"it has the setting {ascii(name)[:60]}, which no model of ours has.")
        return _number(name, value)
    if value is None or value == DEFAULT_OPTIMIZER:
        return value
    _check_named(name, value)
    part = ClassSpec.of(value, ANY_NUMBER)
    base = OF_TORCH[name]
    cls = find_imported(part.name, base)
    if cls is None:
        raise InputError(
            f"its {name} is {part.name[:60]}; a checkpoint may name a class of torch.optim, or "
            f"another {base.__name__} that the configuration names too."
        )
    return _as_named(value, {**part.to_dict(), "class_path": class_path(cls)})


def _as_named(value: Mapping[str, Any], found: dict[str, Any]) -> dict[str, Any]:
    """Return a configuration with the class path from the file, if it still resolves to the same class."""

    def leads_to(path: str) -> object:
        module, _, name = path.rpartition(".")
        return getattr(sys.modules.get(module), name, None)

    same = leads_to(value["class_path"]) is leads_to(found["class_path"]) is not None
    return {**found, "class_path": value["class_path"]} if same else found


def _check_named(name: str, value: Any) -> None:
    if isinstance(value, dict) and value.keys() == {MADE_IN_PYTHON}:
        raise InputError(
            f"its {name}, {ascii(value[MADE_IN_PYTHON])[:80]}, was made in Python of more than plain values; "
            "use the checkpoint from there."
        )


def _has_form(found: Any, form: Any) -> bool:
    """Return whether a value has the same structure as another, with non-negative numbers.

    >>> [_has_form(found, {"ready": 0}) for found in ({"ready": 3}, {"ready": -1}, {})]
    [True, False, False]
    """
    if type(found) is not type(form):
        return False
    if isinstance(form, dict):
        same = found.keys() == form.keys() or not form  # an empty template accepts any content
        return same and all(_has_form(found[name], form[name]) for name in form)
    return bool(found >= 0)


def _has_loops(found: Any, form: Mapping[str, Any]) -> bool:
    """Return whether the training loops' states are valid; others vary between versions of Lightning."""
    saved = found.get("fit_loop") if isinstance(found, dict) else None
    return (
        isinstance(saved, dict)
        and "epoch_progress" in saved
        and all(_has_form(saved[name], form[name]) for name in form if name in saved)
    )


def _are_dicts(found: Any, count: int) -> bool:
    return isinstance(found, list) and len(found) == count and all(isinstance(each, dict) for each in found)


def _is_recent(version: Any) -> bool:
    """Return whether the package supports a version of Lightning."""
    try:
        return Version(version) >= Version("2.6")
    except (InvalidVersion, TypeError):
        return False


def _number(name: str, value: Any) -> Any:
    if isinstance(value, str) or not is_plain(value, ANY_NUMBER) or isinstance(value, list):
        raise InputError(f"its {name} is {ascii(value)[:40]}, not a number.")
    return value


def _size_of_run(config: Path) -> int | None:
    try:
        text = read_bounded(config, MOST_SETTINGS).decode("utf-8")
        size = None if yaml_limit_error(text) else load_yaml(text)["data"]["size"]
        return size if type(size) is int and 1 <= size <= LARGEST_SETTING else None
    except (OSError, InputError, yaml.YAMLError, KeyError, TypeError, UnicodeDecodeError):
        return None
