#!/usr/bin/env bash
# Repeats the training and measuring for a section of docs/benchmark_tables.md, and stores its figures in docs/results:
# tools/benchmark_runs.sh NAME…      NAME: benchmark_64, critic_64 and so on, as the sections say
#
# meshes/ holds the FourLeg meshes. The runs stay in runs; run the command again to continue. PYTHON names the
# interpreter, and ROWS the rows to train (pix2pix,ours) instead of those that already have figures.
set -euo pipefail
cd "$(dirname "$0")/.."
python=${PYTHON:-.venv/bin/python}

measure() { # NAME PLAN IMAGES [SETTING…]
    local rows=${ROWS:-$("$python" - "$1" <<'ROWS'
import json, sys
runs = json.load(open(f"docs/results/{sys.argv[1]}.json"))["runs"]
print(",".join(dict.fromkeys(run["row"] for run in runs)))
ROWS
)}
    "$python" -m normalgan benchmark --config "configs/benchmark/$2.yaml" --config configs/cpu.yaml --images "$3" \
        --rows "$rows" --set data.meshes='meshes/*.off' data.workers=0 "${@:4}" -o "runs/${RUN:-$1}"
}

keep() { # NAME [OPTION…]
    "$python" tools/keep_results.py "runs/$1/results.json" "${@:2}" -o "docs/results/$1.json"
}

same_networks() { # OF NAME: they are measured again, not trained again
    [ -d "runs/$2" ] || cp -r "runs/$1" "runs/$2"
}

for name in "$@"; do
    case $name in
        benchmark_64 | deepnormals_64) measure "$name" fourlegs 21000 data.size=64 ;;
        benchmark_128) measure "$name" fourlegs 10500 ;;
        fourlegs_*_128)
            same_networks benchmark_128 "$name"
            measure "$name" "${name%_128}" 10500
            ;;
        folds_64)
            for k in 0 1 2 3 4; do
                RUN=fold$k measure "$name" fourlegs 10500 data.size=64 data.split.file=configs/fourleg/folds/$k.json
            done
            ;;
        lines_64 | hand_*_64)
            same_networks ablation_64 "$name"
            measure "$name" "${name%_64}" 10500 data.size=64
            ;;
        users_64)
            same_networks benchmark_64 "$name"
            measure "$name" users_fourlegs 21000 data.size=64
            ;;
        placement_64) measure "$name" placement 21000 data.size=64 ;;
        shipped_*) "$python" -m normalgan benchmark --config "configs/benchmark/${name#shipped_}.yaml" --evaluate shipped -o "runs/$name" ;;
        *_64) measure "$name" "${name%_64}" 10500 data.size=64 ;; # thresholds, critic, ablation
        *)
            echo "there is no section '$name'." >&2
            exit 2
            ;;
    esac
    case $name in
        benchmark_* | deepnormals_64) keep "$name" --by-mesh angular_mean below_11_25 ;;
        fourlegs_*) keep "$name" --by-mesh angular_mean --without distance curve ;;
        placement_64 | thresholds_64 | users_64) keep "$name" --by-mesh angular_mean --without distance ;;
        folds_64) "$python" tools/join_folds.py configs/benchmark/fourlegs.yaml runs/fold?/results.json -o "docs/results/$name.json" ;;
        shipped_*) "$python" tools/keep_results.py "runs/$name/evaluation.json" -o "docs/results/$name.json" ;;
        *) keep "$name" ;;
    esac
done
