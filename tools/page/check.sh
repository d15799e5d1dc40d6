#!/usr/bin/env bash
# Checks the JavaScript of the studio's page with a type checker, by its JSDoc types, and with a linter. Both come from
# npm, in the versions that package.json names; if npm is missing or cannot be reached, one line says so.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
cd "$here/../.."

skip() { echo "$1: the studio's page is not checked." >&2; exit 0; }
command -v npm >/dev/null || skip "npm is missing"
installed=$here/node_modules/.installed
if [ ! -e "$installed" ] || [ "$here/package.json" -nt "$installed" ]; then
    said=$(cd "$here" && npm install --no-package-lock --ignore-scripts --no-audit --no-fund --fetch-retries=1 --loglevel=error 2>&1) || {
        case $said in
        *ENOTFOUND* | *EAI_AGAIN* | *ECONNREFUSED* | *ENETUNREACH* | *ETIMEDOUT*) skip "npm is out of reach" ;;
        esac
        echo "$said" >&2
        exit 1
    }
    touch "$installed"
fi
"$here/node_modules/.bin/tsc" --project "$here"
"$here/node_modules/.bin/oxlint" --deny-warnings src/normalgan/studio/page tools/static_studio
