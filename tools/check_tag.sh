#!/usr/bin/env bash
# Rejects a tag that differs from the version in pyproject.toml or lacks a changelog section: tools/check_tag.sh v1.2.0
set -euo pipefail
cd "$(dirname "$0")/.."

tag=${1:?usage: tools/check_tag.sh TAG}
version=$(sed -n 's/^version = "\(.*\)"$/\1/p' pyproject.toml)
if [ "$tag" != "v$version" ]; then
    echo "the tag is $tag, but the version in pyproject.toml is $version; they must agree: tag v$version." >&2
    exit 1
fi
if ! grep -q "^## \[$version\] - [0-9-]*$" CHANGELOG.md; then
    echo "CHANGELOG.md has no section '## [$version] - YYYY-MM-DD'; add it with the date." >&2
    exit 1
fi
