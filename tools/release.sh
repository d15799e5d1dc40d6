#!/usr/bin/env bash
# Builds everything that is published, and tests each part: tools/release.sh [FOLDER] [PYTHON]
#
# FOLDER is dist by default, and PYTHON has the tests' packages. The site must lie in site/, where `make release` builds it.
set -euo pipefail
cd "$(dirname "$0")/.."
folder=${1:-dist}
python=${2:-.venv/bin/python}
test -s site/index.html || { echo "there is no site/index.html; run make release." >&2; exit 2; }

bash tools/check_packages.sh "$folder"
# The wheel alone, without torch, for the studio, the add-ons and Python.
bash tools/check_light.sh "$folder"/*.whl
"$python" - "$folder" <<'SITE'
import sys, tomllib
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo
version = tomllib.loads(Path("pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
with ZipFile(f"{sys.argv[1]}/normalgan-site-{version}.zip", "w") as archive:
    for path in sorted(Path("site").rglob("*")):
        if path.is_file():
            archive.writestr(ZipInfo(path.as_posix()), path.read_bytes(), ZIP_DEFLATED)
SITE
if [ -d build/baselines ]; then
    cp -r build/baselines "$folder/"
else
    echo "there are no trained baselines in build/baselines (make baselines trains them): the release has no baselines." >&2
fi
"$python" tools/release_files.py "$folder"
"$python" -m pytest -q tests/test_release_files.py
if docker info >/dev/null 2>&1; then
    docker build --quiet --tag normalgan .
    docker run --rm normalgan models
    docker run --rm --volume "$PWD/examples/sketches:/work:ro" normalgan generate fox.png -o - --bits 8 >/dev/null
else
    echo "Docker does not run here, so the image was not built."
fi
(cd "$folder" && sha256sum --check --quiet SHA256SUMS)
echo "the whole release is in $folder."
