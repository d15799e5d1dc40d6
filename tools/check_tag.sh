#!/usr/bin/env bash
# Refuses a tag that is not the version of pyproject.toml, or whose changes are not told: tools/check_tag.sh v1.2.0
set -euo pipefail
cd "$(dirname "$0")/.."

tag=${1:?usage: tools/check_tag.sh TAG}
version=$(sed -n 's/^version = "\(.*\)"$/\1/p' pyproject.toml)
if [ "$tag" != "v$version" ]; then
    echo "the tag is $tag, but the version in pyproject.toml is $version; they must agree, as v$version." >&2
    exit 1
fi
if ! grep -q "^## \[$version\] - [0-9-]*$" CHANGELOG.md; then
    echo "CHANGELOG.md has no section '## [$version] - YYYY-MM-DD'; give it the date." >&2
    exit 1
fi
