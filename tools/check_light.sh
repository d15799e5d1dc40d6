#!/usr/bin/env bash
# Checks that a wheel without extras works in an empty environment without torch:
#
#     tools/check_light.sh WHEEL
#
# PYTHON names the interpreter.
set -euo pipefail
wheel=$(realpath "${1:?usage: tools/check_light.sh WHEEL}")
python=${PYTHON:-python3}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
unset PYTHONPATH
drawing=$(realpath "$(dirname "$0")/../examples/sketches/fox.png")

"$python" -m venv "$work/env"
SECONDS=0
"$work/env/bin/python" -m pip install --quiet "$wheel"
echo "installed in $SECONDS s, $(du -sm "$work/env" | cut -f1) MB"
mkdir "$work/empty"
cd "$work/empty"
normalgan=$work/env/bin/normalgan
"$normalgan" --version
"$normalgan" models
"$normalgan" generate "$drawing" -o map.png
"$work/env/bin/python" - "$drawing" <<'CHECK'
import sys
from importlib.util import find_spec
import normalgan
assert find_spec("torch") is None, "torch was installed without the extra"
normalgan.load("shipped")(sys.argv[1]).save("python.png")
CHECK
cmp map.png python.png
# On a terminal, several drawings have a progress bar.
mkdir two
cp "$drawing" two/a.png
cp "$drawing" two/b.png
script --quiet --return --command "$normalgan generate two -o maps" /dev/null >/dev/null
cmp map.png maps/b_normal.png
# A command that needs the extra says so.
"$normalgan" fit --config quickstart 2>said.txt && exit 1
grep -q "normalgan\\[train\\]" said.txt
"$normalgan" studio --no-browser --port 0 >address.txt &
studio=$!
trap 'kill $studio 2>/dev/null; rm -rf "$work"' EXIT
for _ in $(seq 100); do
    grep -q http address.txt && break
    sleep 0.3
done
"$work/env/bin/python" -c "
import re, urllib.request
address = re.search(r'http://\S+', open('address.txt').read())[0]
assert b'<canvas' in urllib.request.urlopen(address, timeout=30).read()
"
kill "$studio"
echo "the wheel works without torch."
