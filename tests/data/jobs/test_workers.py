import subprocess
import sys
from pathlib import Path

import pytest

WORK = """
import os
from normalgan.data.jobs.workers import Workers
from normalgan.errors import InputError

def work():
    try:
        with Workers(1) as pool:
            print([result for _, result in pool.run(os.path.basename, ["a/b"])])
    except InputError as error:
        print(error)
"""


@pytest.mark.parametrize(
    ("end", "said"),
    [
        ("work()\n", 'put the lines that do something under `if __name__ == "__main__":`.'),
        ("if True:\n    work()\n", "line 14 of"),
        ('if __name__ == "__main__":\n    work()\n', "['b']"),
        ("def main():\n    work()\n\nif '__main__' == __name__:\n    main()\n", "['b']"),
    ],
)
def test_a_script_without_the_guard_is_told_of_it(tmp_path: Path, end: str, said: str) -> None:
    script = tmp_path / "script.py"
    script.write_text(WORK + "\n" + end)
    done = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, check=True)
    assert said in done.stdout
    assert len(done.stdout.splitlines()) == 1
    if "['b']" not in said:
        assert str(script) in done.stdout
        assert "memory" not in done.stdout + done.stderr
