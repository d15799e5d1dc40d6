"""Configurations made to do harm, by the places where the parser builds or reads what is named."""

import json
from base64 import b64encode

from attacked_checkpoints import EVIL, SYMPY

CALLBACK = {"class_path": "lightning.pytorch.callbacks.LambdaCallback", "init_args": {"on_fit_start": SYMPY}}
UNSAFE: dict[str, dict[str, object]] = {
    "a callback that runs a text": {"trainer": {"callbacks": [CALLBACK]}},
    "one that is imported": {"trainer": {"callbacks": {"class_path": f"{EVIL}.Foo"}}},
    "one by its short name": {"trainer": {"callbacks": ["LambdaCallback"]}},
    "one in a text": {"trainer": {"callbacks": json.dumps([CALLBACK])}},
    "one in a text in a text": {"trainer": {"callbacks": json.dumps(json.dumps([CALLBACK]))}},
    "one under a key with dots": {"trainer.callbacks.class_path": f"{EVIL}.Foo"},
    "one that is added": {"trainer": {"callbacks+": CALLBACK}},
    "a schedule that calls": {
        "model": {
            "lr_scheduler": {
                "class_path": "torch.optim.lr_scheduler.StepLR",
                "init_args": {"step_size": SYMPY},
            }
        }
    },
    "a function as a schedule": {"model": {"lr_scheduler": f"{EVIL}.run"}},
    "a function as an optimiser": {"model": {"generator_optimizer": "os.system"}},
    "a network": {"model": {"generator": f"{EVIL}.Foo"}},
    "a strategy": {"trainer": {"strategy": {"class_path": f"{EVIL}.Foo"}}},
    "one in further arguments": {
        "data": {
            "lines": {"class_path": "Mixture", "dict_kwargs": {"styles": [{"class_path": f"{EVIL}.Foo"}]}}
        }
    },
    "another file": {"trainer": "unsafe_trainer.yaml"},
    "a file as a URL": {"trainer": "file://{folder}/unsafe_trainer.yaml"},
    "a file in the home folder": {"trainer": "~/unsafe_trainer.yaml"},
    "a list of files in the home folder": {"trainer": {"callbacks": ["~/unsafe_class.yaml"]}},
    "a file for a class": {"model": {"generator": "unsafe_class.json"}},
    "a list of files": {"trainer": {"callbacks": ["unsafe_class.yaml"]}},
}
"""What `--safe-config` refuses."""
FIRST = {
    *("a callback that runs a text", "one in a text", "one under a key with dots", "a schedule that calls"),
    *("a function as an optimiser", "a network", "one in further arguments", "another file"),
    "a file as a URL",
}
"""One of each way in."""
URLS = (
    f"data://text/yaml;base64,{b64encode(f'callbacks: {{class_path: {EVIL}.Foo}}'.encode()).decode()}",
    "local://{folder}/unsafe_trainer.yaml",
    "simplecache::file://{folder}/unsafe_trainer.yaml",
    "http://127.0.0.1:{port}/unsafe_trainer.yaml",
    "simplecache::http://127.0.0.1:{port}/unsafe_trainer.yaml",
)
"""Where no configuration is read from, safe or not."""
NESTED = {
    "unsafe_trainer.yaml": f"callbacks: {{class_path: {EVIL}.Foo}}\n",
    "unsafe_class.yaml": f"class_path: {EVIL}.Foo\n",
    "unsafe_class.json": f'{{"class_path": "{EVIL}.Foo"}}\n',
}
"""Files that they name."""
FOREIGN: dict[str, dict[str, object]] = {
    "trainer.default_root_dir": {"trainer": {"default_root_dir": "other"}},
    "trainer.logger": {
        "trainer": {"logger": {"class_path": "CSVLogger", "init_args": {"save_dir": "other"}}}
    },
    "checkpoint.filename": {"checkpoint": {"filename": "../../other/checkpoints/last"}},
    "data.cache": {"data": {"cache": "reference::{folder}/unsafe_class.json"}},
    "output.folder": {"output": {"folder": "other"}},
}
"""Settings that say where is written, by the name of each."""
