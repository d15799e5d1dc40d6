"""Configurations made to do harm, by the places where the parser builds or reads what is named."""

import json

from attacked_checkpoints import EVIL, SYMPY

CALLBACK = {
    "class_path": "lightning.pytorch.callbacks.LambdaCallback",
    "init_args": {"on_fit_start": SYMPY},
}
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
    "a path in a setting": {
        "model": {"generator": {"class_path": "UNetGenerator", "init_args": {"norm": f"{EVIL}.x"}}}
    },
    "further arguments": {
        "trainer": {
            "logger": {"class_path": "CSVLogger", "init_args": {"save_dir": "."}, "dict_kwargs": {"a": 1}}
        }
    },
    "a cluster": {"cluster": "cluster.yaml"},
    "another file": {"trainer": "unsafe_trainer.yaml"},
    "a file for a class": {"model": {"generator": "unsafe_class.json"}},
    "a list of files": {"trainer": {"callbacks": ["unsafe_class.yaml"]}},
}
"""What `--safe-config` refuses."""
NESTED = {
    "unsafe_trainer.yaml": f"callbacks: {{class_path: {EVIL}.Foo}}\n",
    "unsafe_class.yaml": f"class_path: {EVIL}.Foo\n",
    "unsafe_class.json": f'{{"class_path": "{EVIL}.Foo"}}\n',
    "cluster.yaml": "class_path: subprocess.Popen\n",
}
"""Files that they name."""
