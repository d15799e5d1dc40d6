"""The five worst attacks of the second round, tried by hand: the real command line, in a clean clone.

    python tools/trust/worst_five.py [--work FOLDER]

It clones the repository that it lies in as it was committed, makes the files, runs the commands one after
the other, and prints for each its exit code, processor time, largest memory, and what it said. It ends with
1 if a command ran what a file asked for, drew a file that it was not given, or took more than is said below.
"""

import argparse
import http.client
import os
import re
import subprocess
import sys
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).parents[2]
HARMLESS = 2**30
"""Bytes of memory that no refusal takes; torch alone takes a third of it."""
MOST_SECONDS = 120.0
"""Of processor time: starting a training command takes twenty."""
SAID = 200
"""Characters of what a command said that are printed."""


@dataclass
class Trial:
    """Commands in a clean clone, and what went wrong.

    Args:
        clone: of the repository.
        folder: where they are run.
    """

    clone: Path
    folder: Path
    findings: list[str] = field(default_factory=list)

    @property
    def environment(self) -> dict[str, str]:
        """What the commands see: the source of the clone before any that is installed."""
        return os.environ | {"PYTHONPATH": str(self.clone / "src"), "OMP_NUM_THREADS": "1"}

    def run(self, *arguments: str, code: int) -> None:
        """Run a command, print what came of it, and note what should not have."""
        log = self.folder / "said"
        with log.open("w") as said:
            process = subprocess.Popen(
                [sys.executable, "-m", "normalgan", *arguments],
                stdout=subprocess.DEVNULL,
                stderr=said,
                cwd=self.folder,
                env=self.environment,
            )
            _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        seconds, memory = used.ru_utime + used.ru_stime, used.ru_maxrss * 1024
        print(f"$ normalgan {' '.join(arguments).replace(str(self.clone), 'clone')}")
        print(
            f"  exit code {process.returncode}, {seconds:.0f} s of processor time, {memory >> 20} MiB at most"
        )
        words = re.sub(r"\s+", " ", log.read_text().replace(f"{self.folder}/", "")).strip()
        print(f"  {words[:SAID] or 'no words'}{'…' if len(words) > SAID else ''}", flush=True)
        if process.returncode != code:
            self.findings.append(f"{arguments[:2]} ended with {process.returncode}, not {code}")
        if memory > HARMLESS or seconds > MOST_SECONDS:
            self.findings.append(f"{arguments[:2]} took {seconds:.0f} s and {memory >> 20} MiB")
        self.look_for_harm(" ".join(arguments[:2]))

    def look_for_harm(self, after: str) -> None:
        """Note it if a file of ours was run."""
        if harm := list(self.folder.rglob("touched*")):
            self.findings.append(f"{after} ran what a file asked for: {harm}")
        print(f"  {'it ran what the file asked for' if harm else 'nothing of the file was run'}", flush=True)


def checkpoints(trial: Trial) -> None:
    """1: a checkpoint whose settings run a command, by way of its schedule and of its generator."""
    from attacked_checkpoints import EVIL, LAMBDA, SYMPY, part, put, save

    (trial.folder / f"{EVIL}.py").write_text("from pathlib import Path\nPath('touched').touch()\n")
    schedule = {"class_path": LAMBDA, "init_args": {"lr_lambda": SYMPY}}
    save(trial.folder / "schedule.ckpt", put("hyper_parameters", "lr_scheduler", value=schedule))
    save(trial.folder / "class.ckpt", part("generator", class_path=f"{EVIL}.Foo"))
    conf = [
        *("--config", str(trial.clone / "tests/conf/tiny.yaml"), "--data.meshes", "meshes"),
        *("--data.cache", "cache", "--trainer.default_root_dir", "run"),
    ]
    trial.run("export", "schedule.ckpt", "-o", "sound.safetensors", "--format", "safetensors", code=0)
    trial.run(
        "export", "class.ckpt", "-o", "never.safetensors", "--format", "safetensors", "--size", "32", code=2
    )
    trial.run("fit", *conf, "--ckpt_path", "schedule.ckpt", code=2)


def cluster(trial: Trial) -> None:
    """2: a cluster file that starts a program."""
    text = "class_path: subprocess.Popen\ninit_args: {args: [touch, touched_by_cluster]}\n"
    (trial.folder / "cluster.yaml").write_text(text)
    trial.run(
        *("render", "--config", str(trial.clone / "tests/conf/tiny.yaml"), "--data.meshes", "meshes"),
        *("--data.cache", "cache", "--cluster", "cluster.yaml"),
        code=2,
    )


def groups(trial: Trial) -> None:
    """3: an SVG of 900 groups in one another, by the command and in the studio, which goes on."""
    from hostile_pictures import nested, svg

    content = svg(nested("g", 900))
    (trial.folder / "groups.svg").write_bytes(content)
    trial.run("generate", "groups.svg", "-o", "maps", code=2)
    with Studio(trial) as port:
        for path, body in (("/api/import", content), ("/api/about", None)):
            connection = http.client.HTTPConnection("127.0.0.1", port, timeout=300)
            method, headers = ("POST", {"Content-Type": "image/svg+xml"}) if body else ("GET", {})
            connection.request(method, path, body, headers)
            answer = connection.getresponse()
            words = answer.read().decode()
            print(f"  {method} {path}: {answer.status} {words[:100]}", flush=True)
            connection.close()
            if answer.status != (400 if body else 200):
                trial.findings.append(f"the studio answered {answer.status} to {path}")


def links(trial: Trial) -> None:
    """4: an SVG that draws a file of the user's into the picture."""
    from hostile_pictures import secret_picture, svg

    secret = secret_picture(trial.folder / "secret.png")
    link = f'<image width="64" height="64" href="{secret}"/>'
    (trial.folder / "link.svg").write_bytes(svg(link))
    trial.run("generate", "link.svg", "-o", "maps", "--show-input", code=2)
    if maps := list((trial.folder / "maps").glob("*")):
        trial.findings.append(f"there are maps of what was to be refused: {maps}")


def memory(trial: Trial) -> None:
    """5: a TIFF of 146 bytes with tiles of 2³⁰ pixels a side, and a checkpoint that claims a width of 400."""
    from attacked_checkpoints import part, save

    from hostile_pictures import hostile

    (trial.folder / "tile.tiff").write_bytes(hostile(Path("secret"))["tile.tiff"][0])
    wide = {"class_path": "normalgan.models.UNetGenerator", "init_args": {"size": 32, "width": 400}}
    save(trial.folder / "wide.ckpt", part("generator", **wide))
    trial.run("generate", "tile.tiff", "-o", "maps", code=2)
    trial.run("export", "wide.ckpt", "-o", "never.safetensors", "--format", "safetensors", code=2)


class Studio:
    """A studio of the clone at a free port, ended at the end."""

    def __init__(self, trial: Trial) -> None:
        self.trial = trial

    def __enter__(self) -> int:
        """Return the port."""
        command = [sys.executable, "-m", "normalgan", "studio", "--port", "0", "--no-browser"]
        print("$ normalgan studio --port 0 --no-browser --projects projects")
        self.process = subprocess.Popen(
            [*command, "--projects", "projects"],
            stdout=subprocess.PIPE,
            cwd=self.trial.folder,
            env=self.trial.environment,
            text=True,
        )
        found = re.search(r"127\.0\.0\.1:(\d+)", _first_line(self.process))
        assert found, "the studio did not start"
        return int(found[1])

    def __exit__(self, *_: object) -> None:
        """End it; note it if it has ended by itself."""
        if self.process.poll() is not None:
            self.trial.findings.append(f"the studio ended with {self.process.returncode}")
        self.process.terminate()
        self.process.wait(60)


def _first_line(process: "subprocess.Popen[str]") -> str:
    assert process.stdout is not None
    return process.stdout.readline()


ATTACKS = (checkpoints, cluster, groups, links, memory)


def main() -> int:
    """Try them all; exit code 1 if any did harm."""
    parser = argparse.ArgumentParser(prog="tools/trust/worst_five.py", description=__doc__.splitlines()[0])
    parser.add_argument(
        "--work", type=Path, help="an empty folder to work in, and to keep; else it is removed"
    )
    options = parser.parse_args()
    sys.path[:0] = [str(ROOT / "tests" / part) for part in ("", "trust")]
    with tempfile.TemporaryDirectory(prefix="worst-") as temporary:
        work = (options.work or Path(temporary)).resolve()
        clone, folder = work / "clone", work / "here"
        subprocess.run(["git", "clone", "--quiet", str(ROOT), str(clone)], check=True)
        told = ["git", "-C", str(clone), "log", "-1", "--format=%h of %cs"]
        print("commit", subprocess.run(told, check=True, capture_output=True, text=True).stdout.strip())
        folder.mkdir()
        trial = Trial(clone, folder)
        from five_meshes import write_meshes

        (folder / "meshes").mkdir()
        write_meshes(folder / "meshes")
        for attack in ATTACKS:
            print(f"\n{attack.__doc__}")
            attack(trial)
    for finding in trial.findings:
        print(finding)
    print(f"\n{len(trial.findings)} findings")
    return int(bool(trial.findings))


if __name__ == "__main__":
    sys.exit(main())
